#pragma once
#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "core/device/device.h"
#include "core/formats/load_scene.h"
#include "core/pvs/bake_params.h"
#include "core/scene/in_solid.h"

namespace sightline {

/// What `sightline bake` was asked for.
struct BakeOptions {
  std::filesystem::path scene, cells, out;
  std::filesystem::path report, html, csv;  ///< empty: none
  std::filesystem::path pictures;           ///< folder; empty: none
  std::string device = "opencl";
  std::string set = "auto";  ///< as device_options.set, for the report
  DeviceOptions device_options;
  BakeParams params;
  SceneLoadOptions load;
  std::filesystem::path bound;              ///< empty: none
  std::vector<std::string> doors, see_through;  ///< patterns of names
  bool witnesses = false, spatial_splits = false, overwrite = false;
  bool strict_cells = false;              ///< a warning about a cell is an error
  FreeSide free_side = FreeSide::kFront;  ///< of the scene's faces, for the warning of cells in solids
};

/// Names of the methods that work, for --method.
std::vector<std::string> bakeMethods();

/// Declares how a bake samples: all of its parameters but method, limits and validation. params must live as
/// long as `command`, here and below.
void declareSampling(CLI::App& command, BakeParams& params);

/// Declares when a cell's bake ends, and how many rays measure it.
void declareLimits(CLI::App& command, BakeParams& params);

/// Declares where the work is done: --device, --threads, --set, --memory-budget, --spatial-splits.
void declareMachine(CLI::App& command, std::string& device, DeviceOptions& options, bool& spatial_splits);

/// Declares the options of bake; they write into `options`, which must live as long as `command`.
void declareOptions(CLI::App& command, BakeOptions& options);

}  // namespace sightline
