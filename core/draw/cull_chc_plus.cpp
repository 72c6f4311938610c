#include "core/draw/chc_plus_traversal.h"

namespace sightline {

namespace {

class ChcPlusCulled : public CullMethod {
 public:
  ChcPlusCulled(const DrawScene& scene, const ChcOptions& options, const Schedule& schedule)
      : scene_(scene), options_(options), schedule_(schedule), states_(scene.tree) {}

  FrameCounts drawFrame(const Camera& camera, uint64_t number, QueryBackend& backend,
                        std::vector<uint32_t>& drawn) override {
    FrameRecorder frame(scene_.drawables, camera, backend, drawn, schedule_);
    ChcPlusTraversal(scene_, options_, schedule_.seed, states_, frame, camera, number).run();
    return frame.counts;
  }
  void forget() override { states_.forget(); }

 private:
  const DrawScene& scene_;
  ChcOptions options_;
  Schedule schedule_;
  VisitStates states_;
};

}  // namespace

ChcOptions plainChc() {
  ChcOptions options;
  options.c_queue = options.batching = options.late_issue = false;
  return options;
}

std::unique_ptr<CullMethod> cullChcPlus(const DrawScene& scene, const ChcOptions& options,
                                        const Schedule& schedule) {
  return std::make_unique<ChcPlusCulled>(scene, options, schedule);
}

}  // namespace sightline
