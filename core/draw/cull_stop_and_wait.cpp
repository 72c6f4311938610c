#include "core/draw/cull_methods.h"
#include "core/draw/frame_recorder.h"
#include "core/draw/node_queue.h"

namespace sightline {

namespace {

class StopAndWaitCulled : public CullMethod {
 public:
  StopAndWaitCulled(const DrawScene& scene, const Schedule& schedule) : scene_(scene), schedule_(schedule) {}

  FrameCounts drawFrame(const Camera& camera, uint64_t, QueryBackend& backend,
                        std::vector<uint32_t>& drawn) override {
    FrameRecorder frame(scene_.drawables, camera, backend, drawn, schedule_);
    NodeQueue queue(scene_.tree, camera);
    if (!scene_.tree.nodes.empty()) queue.push(0);
    while (!queue.empty()) {
      const uint32_t index = queue.pop();
      ++frame.counts.node_visits;
      const BoxNode& node = scene_.tree.nodes[index];
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
    frame.finish();
    return frame.counts;
  }
  void forget() override {}

 private:
  const DrawScene& scene_;
  Schedule schedule_;
};

}  // namespace

std::unique_ptr<CullMethod> cullStopAndWait(const DrawScene& scene, const Schedule& schedule) {
  return std::make_unique<StopAndWaitCulled>(scene, schedule);
}

}  // namespace sightline
