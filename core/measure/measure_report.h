#pragma once
#include <span>
#include <string>
#include <vector>

#include "core/bake/cell_json.h"
#include "core/bake/report.h"
#include "core/device/device.h"
#include "core/measure/pixel_error.h"

namespace sightline {

/// A file's error in one cell.
struct MeasuredCell {
  std::string cell;
  uint64_t pvs_size = 0;
  PixelError error;
  std::vector<uint32_t> worst_views;
  std::vector<std::string> pictures;  ///< of them, in the same order; or none
};

/// All of a file.
struct MeasuredSet {
  std::string file;
  std::string baked_on;  ///< device
  BakeParams params;     ///< of its bake
  std::vector<MeasuredCell> cells;

  SceneError scene() const;
};

/// What `sightline measure` found.
struct MeasureReport {
  std::string version;
  SceneSummary scene;
  DeviceInfo device;  ///< that traced the views
  MeasureOptions options;
  bool complete = true;  ///< all cells were measured
  uint64_t rays = 0;     ///< traced, for all sets together
  double seconds = 0;    ///< tracing and counting
  std::vector<MeasuredSet> sets;
};

/// For people, as table 7.2 of the thesis: a line a cell and file, and one for the scene.
std::string measureTable(const MeasureReport& report);

/// docs/report.md.
Json measureJson(const MeasureReport& report);

/// A line a cell and file.
std::string measureCsv(const MeasureReport& report);

/// Cells past the limits, a line each. max_average: wrong pixels a view, max_wrong: in any one view.
std::vector<std::string> pastLimits(const MeasureReport& report, double max_average, double max_wrong);

}  // namespace sightline
