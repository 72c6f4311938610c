#pragma once
#include <string>

#include "core/page/html_report.h"

namespace sightline {

/// The chart's figure: canvas, legend, and the table that core/page/parts/report.js draws it from.
std::string chartHtml(const ReportChart& chart);

/// The span chart's figure: rows of bars, an axis, and what the colours are.
std::string spansHtml(const ReportSpans& chart);

}  // namespace sightline
