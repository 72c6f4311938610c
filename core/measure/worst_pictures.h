#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/measure/pixel_error.h"
#include "core/pvs/cell_pvs.h"
#include "core/scene/scene.h"

// Pictures of the worst views of a measurement: FOLDER/NNN-NAME-view-V.png (pictureName), of several files
// that were measured at once FOLDER/NNN-NAME-S-view-V.png, where S is the file's place, from 0.
namespace sightline {

/// Draws views of a cell and its set. set: the file's place; alone: it is the only one. Returns the pictures'
/// names without the folder. Throws Error.
struct WorstPictures {
  std::filesystem::path folder;
  bool alone = true;
  MeasureOptions options;

  std::vector<std::string> draw(const Scene& scene, Tracer& tracer, const CellPvs& pvs, uint32_t cell_index,
                                size_t set, std::span<const uint32_t> views) const;
};

/// Removes the pictures that an earlier measurement drew of a cell, whatever its views and files. All other
/// files stay. Returns how many there were. Throws Error if one cannot be removed.
size_t removeWorstPictures(const std::filesystem::path& folder, const std::string& cell, uint32_t cell_index);

}  // namespace sightline
