#pragma once
#include <string>
#include <vector>

#include "core/bake/report.h"
#include "core/gvs/bake_trace.h"
#include "core/page/html_report.h"

namespace sightline {

/// What the page of a bake shows beside its report.
struct BakePage {
  /// How the sets of report.cells grew, one curve a cell; empty for a cell of an earlier run.
  std::vector<std::vector<CurvePoint>> curves;
  std::vector<ReportPicture> pictures;
  std::string command;  ///< that repeats it
};

/// The parameters of a bake that matter to its method, for a page.
std::vector<ReportFact> parameterFacts(const BakeParams& params);

/// The page of a bake: parameters, a table of the cells, how the sets grew (thesis, figures 7.3 and 7.4),
/// pictures.
HtmlReport bakePage(const BakeReport& report, const BakePage& page);

/// The points of all curves, a line each: cell, iteration, seconds, rays and new triangles by stage, set
/// size. A cell without a curve has one line, for its end.
std::string curvesCsv(const BakeReport& report, const std::vector<std::vector<CurvePoint>>& curves);

}  // namespace sightline
