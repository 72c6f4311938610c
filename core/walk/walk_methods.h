#pragma once
#include <string>
#include <vector>

#include "core/draw/cull_methods.h"
#include "core/draw/cull_pvs.h"

namespace sightline {

/// A way to cull, by its name on the command line.
struct WalkMethodInfo {
  std::string name;
  std::string about;  ///< a line
  bool needs_pvs;
  bool on_gpu;  ///< chooses on the GPU what is drawn
  bool exact;   ///< no pixel may differ from drawing everything
};

/// All there are, in the order of reports.
const std::vector<WalkMethodInfo>& walkMethods();
/// Throws Error (exit code 2) that lists the names.
const WalkMethodInfo& walkMethod(const std::string& name);

/// What the methods take, alike for all that take it.
struct WalkMethodOptions {
  ChcOptions chc;  ///< of opti-chc++; chc++ takes its batch size, frames, multiqueries and bounds
  Schedule schedule;
  CellChoice cells = {};
};

/// A method that chooses on the processor, by a name of walkMethods(). units: of the set; must be given where
/// the method needs one. All must outlive it.
std::unique_ptr<CullMethod> makeCullMethod(const std::string& name, const DrawScene& scene,
                                           const PvsUnits* units, const WalkMethodOptions& options);

}  // namespace sightline
