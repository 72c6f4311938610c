#pragma once
#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>

#include "core/device/device.h"
#include "core/pvs/pvs.h"

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
  bool repair = false, witnesses = false, spatial_splits = false, overwrite = false;
};

/// Declares the options; they write into `options`, which must live as long as `command`.
void declareOptions(CLI::App& command, BakeOptions& options);

}  // namespace sightline
