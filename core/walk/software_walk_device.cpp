#include "core/walk/software_walk_device.h"

#include <algorithm>
#include <map>

#include "core/base/error.h"
#include "core/draw/software_backend.h"

namespace sightline {
namespace {

/// Tells what the backend takes from what the method takes.
class TimedBackend : public QueryBackend {
 public:
  TimedBackend(QueryBackend& backend, const WalkClock& clock) : backend_(backend), clock_(clock) {}

  void beginFrame(const Camera& camera) override {
    draw_ = wait_ = 0;
    timed(draw_, [&] { backend_.beginFrame(camera); });
  }
  QueryId submit(std::span<const uint32_t> draws, std::span<const OcclusionQuery> queries) override {
    QueryId id = 0;
    timed(draw_, [&] { id = backend_.submit(draws, queries); });
    return id;
  }
  void submitList(uint32_t list) override {
    timed(draw_, [&] { backend_.submitList(list); });
  }
  bool arrived(QueryId query) override { return backend_.arrived(query); }
  bool visible(QueryId query) override {
    bool answer = false;
    timed(wait_, [&] { answer = backend_.visible(query); });
    return answer;
  }
  void endFrame() override {
    timed(draw_, [&] { backend_.endFrame(); });
  }

  double drawTime() const { return draw_; }
  double waitTime() const { return wait_; }

 private:
  template <typename Work>
  void timed(double& sum, Work&& work) {
    const double start = clock_();
    work();
    sum += clock_() - start;
  }

  QueryBackend& backend_;
  const WalkClock& clock_;
  double draw_ = 0, wait_ = 0;
};

/// A player whose image is the processor's.
class SoftwarePlayer : public WalkPlayer {
 public:
  SoftwarePlayer(const WalkScene& scene, const TriangleLists& lists, const WalkClock& clock,
                 std::unique_ptr<CullMethod> method)
      : scene_(scene),
        owner_(drawableOfTriangles(scene.draw.drawables)),
        clock_(clock),
        backend_(scene.scene, scene.draw.drawables, &lists),
        timed_(backend_, clock),
        method_(std::move(method)),
        reference_(scene.scene) {}

  void draw(const Camera& camera, uint64_t number, uint32_t, FrameTimes& times) override {
    camera_ = camera;
    drawn_.clear();
    const double start = clock_();
    counts_ = method_->drawFrame(camera, number, timed_, drawn_);
    const double all = clock_() - start;
    times.cpu[size_t(CpuPart::submit)] = timed_.drawTime();
    times.cpu[size_t(CpuPart::wait)] = timed_.waitTime();
    times.cpu[size_t(CpuPart::traverse)] = all - timed_.drawTime() - timed_.waitTime();
  }
  void gpuTimes(uint64_t, FrameTimes&) override {}
  FrameCounts counts() override { return counts_; }
  std::vector<uint32_t> drawn() override { return drawn_; }

  FrameCheck check() override {
    const Drawables& drawables = scene_.draw.drawables;
    reference_.begin(camera_);
    for (uint32_t d = 0; d < drawables.list.size(); ++d) {
      if (drawables.list[d].alpha == AlphaKind::blended) continue;
      for (const uint32_t id : drawables.trianglesOf(d)) reference_.draw(id);
    }
    FrameCheck check;
    false_pixels_.clear();
    std::map<uint32_t, uint64_t> missing;
    const std::vector<float>&wanted = reference_.depth(), &got = backend_.image().depth();
    for (size_t pixel = 0; pixel < wanted.size(); ++pixel) {
      check.near_pixels += got[pixel] > wanted[pixel] ? 1 : 0;
      if (reference_.ids()[pixel] != kNoTriangle) check.shown.push_back(owner_[reference_.ids()[pixel]]);
      if (!(got[pixel] < wanted[pixel])) continue;
      false_pixels_.push_back(pixel);
      ++missing[owner_[reference_.ids()[pixel]]];
    }
    std::ranges::sort(check.shown);
    check.shown.erase(std::unique(check.shown.begin(), check.shown.end()), check.shown.end());
    check.false_pixels = false_pixels_.size();
    for (const auto& [drawable, pixels] : missing) check.missing.push_back({drawable, pixels});
    return check;
  }
  std::vector<size_t> falsePixels() override { return false_pixels_; }
  std::vector<uint32_t> referenceDrawables() override {
    std::vector<uint32_t> shown = reference_.ids();
    for (uint32_t& id : shown) id = id == kNoTriangle ? id : owner_[id];
    return shown;
  }
  std::vector<float> referenceDepth() override { return reference_.depth(); }
  void forget() override { method_->forget(); }

 private:
  const WalkScene& scene_;
  std::vector<uint32_t> owner_;
  const WalkClock& clock_;
  SoftwareBackend backend_;
  TimedBackend timed_;
  std::unique_ptr<CullMethod> method_;
  SoftwareImage reference_;
  Camera camera_{};
  FrameCounts counts_;
  std::vector<uint32_t> drawn_;
  std::vector<size_t> false_pixels_;
};

class SoftwareWalkDevice : public WalkDevice {
 public:
  SoftwareWalkDevice(const WalkScene& scene, WalkClock clock) : scene_(scene), clock_(std::move(clock)) {}

  DeviceInfo info() const override {
    DeviceInfo info;
    info.id = "cpu";
    info.name = "drawing on the processor";
    info.driver = "built in";
    info.on_cpu = true;
    return info;
  }
  bool timesGpu() const override { return false; }
  std::string whyNot(const std::string& method) const override {
    return walkMethod(method).on_gpu ? "a GPU must choose what is drawn, and cpu has none" : "";
  }
  std::unique_ptr<WalkPlayer> play(const std::string& method, const WalkMethodOptions& options) override {
    return std::make_unique<SoftwarePlayer>(
        scene_, scene_.units == nullptr ? no_lists_ : scene_.units->triangles, clock_,
        makeCullMethod(method, scene_.draw, scene_.units, options));
  }

 private:
  WalkScene scene_;
  WalkClock clock_;
  TriangleLists no_lists_;
};

}  // namespace

std::unique_ptr<WalkDevice> makeSoftwareWalkDevice(const WalkScene& scene, WalkClock clock) {
  return std::make_unique<SoftwareWalkDevice>(scene, std::move(clock));
}

}  // namespace sightline
