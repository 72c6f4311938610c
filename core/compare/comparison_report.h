#pragma once
#include <span>
#include <string>

#include "core/bake/report.h"
#include "core/compare/comparison.h"
#include "core/page/html_report.h"

namespace sightline {

/// Everything that the reports of a comparison say.
struct ComparisonReport {
  std::string version, command;
  SceneSummary scene;
  DeviceInfo device;
  bool spatial_splits = false;
  bool complete = true;  ///< false: stopped before all cells were compared
  CompareOptions options;
  std::vector<CellComparison> cells;
};

/// A line a method at the whole budget, as table 7.2 of the thesis; over several seeds their median and,
/// behind it, from the lowest to the highest. Ends with a newline.
std::string comparisonTable(const ComparisonReport& report);

/// The JSON text, keys as docs/report.md says.
std::string comparisonJson(const ComparisonReport& report);

/// A line for each point of the budget of each run: cell, method, seed, rays, seconds, size, shares, errors.
std::string comparisonCsv(const ComparisonReport& report);

/// The page: tables and the charts of figures 7.2 and 7.4 to 7.8 of the thesis.
HtmlReport comparisonPage(const ComparisonReport& report);

}  // namespace sightline
