#include "core/draw/cull_methods.h"
#include "core/draw/frame_recorder.h"
#include "core/draw/visit_frustum.h"

namespace sightline {

namespace {

class FrustumCulled : public CullMethod {
 public:
  explicit FrustumCulled(const DrawScene& scene) : scene_(scene) {}

  FrameCounts drawFrame(const Camera& camera, uint64_t, QueryBackend& backend,
                        std::vector<uint32_t>& drawn) override {
    FrameRecorder frame(scene_.drawables, camera, backend, drawn);
    frame.counts.node_visits = visitFrustum(scene_.tree, camera, frame.guard().frustum(),
                                            [&](const BoxNode& leaf) { frame.draw(leaf.item); });
    frame.finish();
    return frame.counts;
  }
  void forget() override {}

 private:
  const DrawScene& scene_;
};

}  // namespace

std::unique_ptr<CullMethod> cullFrustum(const DrawScene& scene) {
  return std::make_unique<FrustumCulled>(scene);
}

}  // namespace sightline
