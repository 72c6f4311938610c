#include "core/draw/cull_methods.h"
#include "core/draw/frame_recorder.h"

namespace sightline {

namespace {

class NothingCulled : public CullMethod {
 public:
  explicit NothingCulled(const DrawScene& scene) : scene_(scene) {}

  FrameCounts drawFrame(const Camera& camera, uint64_t, QueryBackend& backend,
                        std::vector<uint32_t>& drawn) override {
    FrameRecorder frame(scene_.drawables, camera, backend, drawn);
    for (uint32_t d = 0; d < scene_.drawables.list.size(); ++d) frame.draw(d);
    frame.finish();
    return frame.counts;
  }
  void forget() override {}

 private:
  const DrawScene& scene_;
};

}  // namespace

std::unique_ptr<CullMethod> cullNothing(const DrawScene& scene) {
  return std::make_unique<NothingCulled>(scene);
}

}  // namespace sightline
