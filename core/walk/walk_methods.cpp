#include "core/walk/walk_methods.h"

#include <algorithm>
#include <stdexcept>

#include "core/base/error.h"
#include "core/base/nearest.h"

namespace sightline {

const std::vector<WalkMethodInfo>& walkMethods() {
  static const std::vector<WalkMethodInfo> all = {
      {"none", "draws everything", false, false, true},
      {"vfc", "what the image may show (view frustum), down a tree", false, false, true},
      {"stop-and-wait", "front to back, a query a node, each waited for", false, false, true},
      {"chc", "coherent hierarchical culling (2004)", false, false, true},
      {"chc++", "CHC++ (2008) as it is, in Vulkan", false, false, true},
      {"opti-chc++", "CHC++ with batches, c-queue and second condition", false, false, true},
      {"late", "by the last frame's answers: things pop up", false, false, false},
      {"hiz", "on the GPU by a pyramid of depth, in two passes", false, true, true},
      {"hiz-meshlets", "the same for meshlets", false, true, true},
      {"boxes", "on the GPU by drawn boxes, in two passes", false, true, true},
      {"pvs", "the list of the camera's cell by one draw a kind", true, false, false},
      {"pvs+vfc", "objects of the cell's set that the image may show", true, false, false},
      {"pvs+hiz", "objects of the cell's set by a pyramid of depth", true, true, false},
  };
  return all;
}

const WalkMethodInfo& walkMethod(const std::string& name) {
  std::vector<std::string> names;
  std::string list;
  for (const WalkMethodInfo& info : walkMethods()) {
    if (info.name == name) return info;
    names.push_back(info.name);
    list += (list.empty() ? "" : ", ") + info.name;
  }
  throw Error("no culling method is called '" + name + "': there are " + list + didYouMean(name, names),
              kExitUsage);
}

std::unique_ptr<CullMethod> makeCullMethod(const std::string& name, const DrawScene& scene,
                                           const PvsUnits* units, const WalkMethodOptions& options) {
  ChcOptions plain = plainChc();
  plain.batch_size = options.chc.batch_size;
  plain.assumed_frames = options.chc.assumed_frames;
  plain.multi_queries = options.chc.multi_queries;
  plain.tight_bounds = options.chc.tight_bounds;
  if (name == "none") return cullNothing(scene);
  if (name == "vfc") return cullFrustum(scene);
  if (name == "stop-and-wait") return cullStopAndWait(scene, options.schedule);
  if (name == "chc") return cullChc(scene, options.schedule);
  if (name == "chc++") return cullChcPlus(scene, plain, options.schedule);
  if (name == "opti-chc++") return cullChcPlus(scene, options.chc, options.schedule);
  if (name == "late") return cullLate(scene);
  if (units != nullptr && name == "pvs") return cullPvsList(scene, *units, options.cells);
  if (units != nullptr && name == "pvs+vfc") return cullPvsFrustum(scene, *units, options.cells);
  throw std::invalid_argument("makeCullMethod: " + name);
}

}  // namespace sightline
