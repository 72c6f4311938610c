#pragma once
#include <memory>
#include <utility>

#include "core/draw/cull_method.h"
#include "core/draw/draw_scene.h"
#include "core/draw/frame_recorder.h"

namespace sightline {

/// A method that remembers nothing of the frames before: `draw(frame, camera)` draws one, but for its end.
template <typename Draw>
class StatelessMethod : public CullMethod {
 public:
  StatelessMethod(const DrawScene& scene, const Schedule& schedule, Draw draw)
      : scene_(scene), schedule_(schedule), draw_(std::move(draw)) {}

  FrameCounts drawFrame(const Camera& camera, uint64_t, QueryBackend& backend,
                        std::vector<uint32_t>& drawn) override {
    FrameRecorder frame(scene_.drawables, camera, backend, drawn, schedule_);
    draw_(frame, camera);
    frame.finish();
    return frame.counts;
  }
  void forget() override {}

 private:
  const DrawScene& scene_;
  Schedule schedule_;
  Draw draw_;
};

template <typename Draw>
std::unique_ptr<CullMethod> statelessMethod(const DrawScene& scene, const Schedule& schedule, Draw draw) {
  return std::make_unique<StatelessMethod<Draw>>(scene, schedule, std::move(draw));
}

}  // namespace sightline
