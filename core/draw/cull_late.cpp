#include "core/draw/cull_methods.h"
#include "core/draw/frame_recorder.h"
#include "core/draw/visit_frustum.h"

namespace sightline {

namespace {

class LateCulled : public CullMethod {
 public:
  explicit LateCulled(const DrawScene& scene) : scene_(scene) { forget(); }

  FrameCounts drawFrame(const Camera& camera, uint64_t number, QueryBackend& backend,
                        std::vector<uint32_t>& drawn) override {
    FrameRecorder frame(scene_.drawables, camera, backend, drawn);
    std::vector<uint32_t> asked;
    frame.counts.node_visits =
        visitFrustum(scene_.tree, camera, frame.guard().frustum(), [&](const BoxNode& leaf) {
          const Answer& last = answers_[leaf.item];
          const bool known = last.frame != kNever && last.frame + 1 == number;
          if (!known || backend.visible(last.query)) frame.draw(leaf.item);
          if (const auto grown = frame.guard().grown(leaf.box)) {
            frame.ask(*grown);
            asked.push_back(leaf.item);
          }
        });
    const QueryId first = frame.finish();
    for (size_t i = 0; i < asked.size(); ++i) answers_[asked[i]] = {number, first + i};
    return frame.counts;
  }

  void forget() override { answers_.assign(scene_.drawables.list.size(), {}); }

 private:
  static constexpr uint64_t kNever = ~uint64_t{0};
  struct Answer {
    uint64_t frame = kNever;  ///< that asked
    QueryId query = 0;
  };

  const DrawScene& scene_;
  std::vector<Answer> answers_;
};

}  // namespace

std::unique_ptr<CullMethod> cullLate(const DrawScene& scene) {
  return std::make_unique<LateCulled>(scene);
}

}  // namespace sightline
