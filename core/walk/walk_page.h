#pragma once
#include <span>
#include <string>

#include "core/page/html_report.h"
#include "core/walk/walk_report.h"

namespace sightline {

/// Pictures of a walk, in the order in which the page shows them.
struct WalkPictures {
  std::vector<ReportPicture> drawn;  ///< what was drawn, from above
  std::vector<ReportPicture> wrong;  ///< the worst false culls
};

/// The page of a walk (docs/walk.md): tables, the figures of the thesis on CHC++ in Vulkan (5.1, 5.2, 5.4
/// to 5.9) and the tables 7.5 and 8.1 of the thesis on GVS++, drawn of this walk. command: as the shell takes
/// it.
HtmlReport walkPage(const WalkReport& report, const WalkPictures& pictures, const std::string& command);

}  // namespace sightline
