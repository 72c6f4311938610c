#pragma once
#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/cell/view_cell.h"
#include "core/place/floor_cells.h"
#include "core/scene/scene.h"
#include "core/voxel/voxel_space.h"

namespace sightline {

/// Options of cells that go by the scene's voxels.
struct FreeCellsArguments {
  std::vector<std::string> reach;
  std::optional<double> voxel;
  std::optional<double> floor;  ///< largest size
  FloorCellOptions floor_options;
  std::filesystem::path picture;  ///< of the floor
};

/// --reach, --voxel, --floor and what belongs to it. They write into `arguments`, which must live as long as
/// the command.
void declareFreeCells(CLI::App& command, FreeCellsArguments& arguments);

/// A scene's voxels, and what of space is free.
struct FreeSpace {
  VoxelGrid grid;
  std::optional<VoxelSpace> space;
};

/// What is reached from the places of --reach, which it says in a line. largest_voxel: without --voxel,
/// voxels are the largest that are not larger. Throws ExitCode if it was stopped.
std::unique_ptr<FreeSpace> findReached(const Scene& scene, const FreeCellsArguments& arguments,
                                       double largest_voxel);

/// Of cells --floor, with a line about the floor and what they cover, and its picture.
std::vector<ViewCell> placeOnFloor(const Scene& scene, const FreeCellsArguments& arguments,
                                   const std::optional<double>& margin, FreeSide free_side);

}  // namespace sightline
