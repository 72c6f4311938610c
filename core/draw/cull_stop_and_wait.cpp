#include "core/draw/cull_methods.h"
#include "core/draw/node_queue.h"
#include "core/draw/stateless_method.h"

namespace sightline {

std::unique_ptr<CullMethod> cullStopAndWait(const DrawScene& scene, const Schedule& schedule) {
  return statelessMethod(scene, schedule, [&scene](FrameRecorder& frame, const Camera& camera) {
    NodeQueue queue(scene.tree, camera);
    if (!scene.tree.nodes.empty()) queue.push(0);
    while (!queue.empty()) {
      const uint32_t index = queue.pop();
      ++frame.counts.node_visits;
      const BoxNode& node = scene.tree.nodes[index];
      if (frame.guard().frustum().sideOf(node.box) == FrustumSide::outside) continue;
      if (const auto grown = frame.guard().grown(node.box)) {
        frame.ask(*grown);
        if (!frame.visible(frame.submit())) continue;
      }
      if (node.isLeaf()) {
        frame.draw(node.item);
      } else {
        queue.pushChildren(index);
      }
    }
  });
}

}  // namespace sightline
