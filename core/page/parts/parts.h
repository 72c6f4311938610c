#pragma once
#include <string_view>

// What every HTML report carries, embedded by core/page/parts/CMakeLists.txt.
namespace sightline {

extern const std::string_view kChartScript;  ///< Chart.js, minified, with its licence notice
extern const std::string_view kPageStyle;    ///< page/report.css
extern const std::string_view kPageScript;   ///< page/report.js: draws each chart from the table behind it
extern const std::string_view
    kReadingScript;                           ///< page/reading.js: tables wider than the page, small pictures
extern const std::string_view kPageLicences;  ///< page/licences.txt: the notice that goes with Chart.js

}  // namespace sightline
