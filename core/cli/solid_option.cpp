#include "core/cli/solid_option.h"

#include <fmt/format.h>

#include "core/base/error.h"
#include "core/cli/name_checks.h"
#include "core/cli/points.h"
#include "core/cli/share_line.h"
#include "core/voxel/reach.h"
#include "core/voxel/solid.h"

namespace sightline {

void SolidOption::declare(CLI::App& command) {
  CLI::Option* solid =
      command
          .add_option(
              "--solid", rule_,
              "Voxels inside of what is solid, too: of closed parts by how often (parity) or which way "
              "(winding) surfaces lie around them, or all that is not reached (reach)")
          ->check(oneOf({"parity", "winding", "reach"}))
          ->type_name("RULE");
  command.add_flag("--closed", must_close_, "Refuse a scene with a part that is not closed")->needs(solid);
  command
      .add_option("--reach", reach_,
                  "Of --solid reach: the places to start from, x,y,z x,y,z ... or a file (default: outside)")
      ->needs(solid);
}

void SolidOption::check() const {
  if (reach_.empty()) return;
  if (rule_ != "reach") throw Error("--reach: is of --solid reach only", kExitUsage);
  readPoints(reach_, "--reach");
}

void SolidOption::fill(const Scene& scene, VoxelGrid& grid, const std::atomic<bool>* stop) const {
  const InsideRule rule = rule_ == "parity" ? InsideRule::kParity : InsideRule::kWinding;
  const ClosedParts parts = closedParts(scene, rule);
  if (must_close_) requireClosed(scene, parts);
  ShareLine status(rule_ == "reach" ? "reached" : "filled");
  const auto show = [&](double done) { status.show(done, [&] { return closedText(parts); }); };
  VoxelGrid filled;
  SpaceCounts counts;
  const auto fillFrom = [&](const VoxelSpace& space) {
    counts = space.counts();
    filled = filledGrid(space);
  };
  if (rule_ == "reach") {
    ReachOptions options{.from_outside = reach_.empty(), .progress = show, .stop = stop};
    if (!reach_.empty()) options.seeds = readPoints(reach_, "--reach");
    for (glm::dvec3& seed : options.seeds) seed -= scene.offset;
    fillFrom(reach(grid, options));
  } else {
    fillFrom(solidParts(scene, grid, parts, rule, {show, stop}));
  }
  status.end();
  grid = std::move(filled);
  fmt::print("{}; {}{}\n", rule_ == "reach" ? reachedText(counts) : insideText(counts), closedText(parts),
             counts.inner == 0 ? "; nothing is hidden in solids" : "");
}

}  // namespace sightline
