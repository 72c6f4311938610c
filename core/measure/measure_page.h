#pragma once
#include <span>
#include <string>

#include "core/measure/measure_report.h"
#include "core/page/html_report.h"

namespace sightline {

/// The page of `sightline measure`: a table as the thesis's 7.2, one of the cells, pictures of the worst
/// views. command: that repeats it.
HtmlReport measurePage(const MeasureReport& report, std::span<const ReportPicture> pictures,
                       const std::string& command);

/// What the picture of a cell's worst view number `index` (0: the worst) shows.
std::string worstViewCaption(const MeasuredSet& set, const MeasuredCell& cell, size_t index);

}  // namespace sightline
