#include "core/walk/vulkan_walk_device.h"

#include <algorithm>

#include "core/base/error.h"
#include "core/draw/vulkan/depth_check.h"
#include "core/draw/vulkan/gpu_culling.h"
#include "core/draw/vulkan/vulkan_query_backend.h"

namespace sightline {
namespace {

/// A place in the image: kNoTriangle where a drawable's number says that there is none.
std::vector<uint32_t> drawablesShown(std::vector<uint32_t> ids, size_t drawables) {
  for (uint32_t& id : ids) id = id < drawables ? id : kNoTriangle;
  return ids;
}

/// What players on Vulkan have in common: times by frame, and the check.
class VulkanPlayer : public WalkPlayer {
 public:
  VulkanPlayer(VulkanDrawing& drawing, DepthCheck& check, const WalkClock& clock)
      : drawing_(drawing), check_(check), clock_(clock) {}

  void draw(const Camera& camera, uint64_t number, uint32_t in_flight, FrameTimes& times) override {
    camera_ = camera;
    const double start = clock_();
    drawFrame(camera, number);
    const double drawn = clock_();
    const CpuTimes cpu = drawing_.ring().cpuTimes();
    if (numbers_.empty() || numbers_.back().number + 1 != number) numbers_.clear();
    numbers_.push_back({number, drawing_.frame(), start, drawn, 0});
    if (numbers_.size() >= in_flight) drawing_.ring().gpuTimes(numbers_[numbers_.size() - in_flight].frame);
    if (numbers_.size() > kRemembered) numbers_.erase(numbers_.begin());
    const double wait = cpu.look + cpu.wait;
    const double end = numbers_.back().end = clock_();
    times.cpu = {drawn - start - cpu.record - cpu.submit - wait, cpu.record, cpu.submit, wait, end - drawn};
  }

  void gpuTimes(uint64_t number, FrameTimes& times) override {
    const auto found = std::ranges::find(numbers_, number, &Numbered::number);
    if (found == numbers_.end()) return;
    const GpuTimes gpu = drawing_.ring().gpuTimes(found->frame);
    std::copy(gpu.part.begin(), gpu.part.end(), times.gpu.begin());
    times.gpu[kGpuPartCount - 1] = gpu.rest;
    times.gpu_frame = gpu.frame;
  }

  WalkFrameSpans spans(uint64_t number) override {
    WalkFrameSpans spans;
    const auto found = std::ranges::find(numbers_, number, &Numbered::number);
    if (found == numbers_.end()) return spans;
    const FrameSpans its = drawing_.ring().spans(found->frame);
    double at = 0, submitted = 0;
    const auto add = [&](CpuPart part, double until) {
      if (until > at) spans.cpu.push_back({part, at, until});
      at = std::max(at, until);
    };
    const double length = found->drawn - found->begin;
    for (const auto& span : its.cpu) {
      if (span.begin > found->drawn) break;  // the waiting for other frames
      const bool first = span.part == CpuWork::submit && submitted == 0;
      if (first) submitted = span.begin - found->begin;
      add(CpuPart::traverse, span.begin - found->begin);
      add(span.part == CpuWork::record   ? CpuPart::record
          : span.part == CpuWork::submit ? CpuPart::submit
                                         : CpuPart::wait,
          span.end - found->begin);
    }
    add(CpuPart::traverse, length);
    add(CpuPart::idle, found->end - found->begin);
    for (const auto& span : its.gpu) {
      spans.gpu.push_back({size_t(span.part), submitted + span.begin, submitted + span.end});
    }
    return spans;
  }

  FrameCheck check() override {
    const DepthDifference difference = check_.compare(culling());
    FrameCheck check{difference.false_pixels, difference.too_near_pixels, {}, difference.shown};
    for (const DepthDifference::Missing& m : difference.missing)
      check.missing.push_back({m.drawable, m.pixels});
    return check;
  }
  std::vector<size_t> falsePixels() override {
    const std::vector<float> wanted = check_.referenceDepth(), got = drawing_.readDepth();
    std::vector<size_t> pixels;
    for (size_t i = 0; i < wanted.size(); ++i) {
      if (got[i] < wanted[i]) pixels.push_back(i);
    }
    return pixels;
  }
  std::vector<uint32_t> referenceDrawables() override {
    return drawablesShown(check_.referenceIds(), drawing_.mesh().drawables().list.size());
  }
  std::vector<float> referenceDepth() override { return check_.referenceDepth(); }

 protected:
  virtual void drawFrame(const Camera& camera, uint64_t number) = 0;
  virtual GpuCulling* culling() { return nullptr; }

  VulkanDrawing& drawing_;
  DepthCheck& check_;
  const WalkClock& clock_;

 private:
  static constexpr size_t kRemembered = 8;
  struct Numbered {
    uint64_t number, frame;    ///< of the walk, of the drawing
    double begin, drawn, end;  ///< by the clock: until the processor has drawn it, and waited for others
  };
  std::vector<Numbered> numbers_;  ///< of the last frames
  Camera camera_{};
};

/// A method of the processor, with queries or lists.
class HostPlayer : public VulkanPlayer {
 public:
  HostPlayer(VulkanDrawing& drawing, DepthCheck& check, const WalkClock& clock,
             std::unique_ptr<CullMethod> method)
      : VulkanPlayer(drawing, check, clock), backend_(drawing), method_(std::move(method)) {}

  FrameCounts counts() override { return counts_; }
  std::vector<uint32_t> drawn() override { return drawn_; }
  void forget() override { method_->forget(); }

 private:
  void drawFrame(const Camera& camera, uint64_t number) override {
    drawn_.clear();
    counts_ = method_->drawFrame(camera, number, backend_, drawn_);
  }

  VulkanQueryBackend backend_;
  std::unique_ptr<CullMethod> method_;
  FrameCounts counts_;
  std::vector<uint32_t> drawn_;
};

/// A method of the GPU, perhaps among what a set says is seen.
class GpuPlayer : public VulkanPlayer {
 public:
  GpuPlayer(VulkanDrawing& drawing, DepthCheck& check, const WalkClock& clock, const WalkScene& scene,
            GpuMethod method, bool by_set, const CellChoice& cells)
      : VulkanPlayer(drawing, check, clock), scene_(scene), culling_(drawing, method) {
    if (by_set) cell_.emplace(*scene.units, cells);
  }

  FrameCounts counts() override {
    FrameCounts counts = culling_.counts();
    counts.outside = outside_;
    return counts;
  }
  std::vector<uint32_t> drawn() override {
    const std::vector<uint32_t> seen = culling_.readSeen();
    std::vector<uint32_t> drawn;
    for (size_t unit = 0; unit < seen.size(); ++unit) {
      if (seen[unit] != 0) drawn.push_back(culling_.units().units[unit].run.z);
    }
    std::ranges::sort(drawn);
    drawn.erase(std::unique(drawn.begin(), drawn.end()), drawn.end());
    return drawn;
  }
  void forget() override {
    culling_.forget();
    if (cell_) cell_->forget();
    last_.reset();
  }

 private:
  GpuCulling* culling() override { return &culling_; }
  void drawFrame(const Camera& camera, uint64_t number) override {
    if (!cell_) {
      culling_.drawFrame(camera);
      return;
    }
    FrameCounts counts;
    const std::optional<uint32_t> cell = cell_->find(camera, number, counts);
    outside_ = counts.outside;
    const bool changed = !last_ || *last_ != cell;
    last_ = cell;
    if (cell) {
      culling_.drawFrame(camera, scene_.units->drawables[*cell], changed);
    } else {
      culling_.drawFrame(camera);
    }
  }

  const WalkScene& scene_;
  GpuCulling culling_;
  std::optional<CameraCell> cell_;
  std::optional<std::optional<uint32_t>> last_;
  bool outside_ = false;
};

GpuMethod gpuMethod(const std::string& name) {
  if (name == "hiz-meshlets") return GpuMethod::hizMeshlets;
  return name == "boxes" ? GpuMethod::boxes : GpuMethod::hiz;
}

class VulkanWalkDevice : public WalkDevice {
 public:
  VulkanWalkDevice(const std::string& selector, const WalkScene& scene, WalkClock clock,
                   const WalkDeviceOptions& options)
      : scene_(scene),
        clock_(std::move(clock)),
        drawing_(
            selector, scene.scene, scene.draw.drawables,
            scene.units == nullptr ? no_lists_ : scene.units->triangles,
            {.clock = clock_, .chain = options.semaphores ? SubmitChain::semaphores : SubmitChain::barriers}),
        check_(drawing_) {}

  DeviceInfo info() const override { return drawing_.context().info(); }
  bool timesGpu() const override { return true; }
  std::string whyNot(const std::string& method) const override {
    return walkMethod(method).on_gpu ? whyNotCull(drawing_, gpuMethod(method)) : "";
  }
  std::unique_ptr<WalkPlayer> play(const std::string& method, const WalkMethodOptions& options) override {
    const WalkMethodInfo& info = walkMethod(method);
    if (info.on_gpu) {
      return std::make_unique<GpuPlayer>(drawing_, check_, clock_, scene_, gpuMethod(method), info.needs_pvs,
                                         options.cells);
    }
    return std::make_unique<HostPlayer>(drawing_, check_, clock_,
                                        makeCullMethod(method, scene_.draw, scene_.units, options));
  }

 private:
  WalkScene scene_;
  WalkClock clock_;
  TriangleLists no_lists_;
  VulkanDrawing drawing_;
  DepthCheck check_;
};

}  // namespace

void requireVulkanWalkDevice(const std::string& selector) {
  selectVulkanDevice(selector, drawingNeeds());
}

std::unique_ptr<WalkDevice> makeVulkanWalkDevice(const std::string& selector, const WalkScene& scene,
                                                 WalkClock clock, const WalkDeviceOptions& options) {
  return std::make_unique<VulkanWalkDevice>(selector, scene, std::move(clock), options);
}

}  // namespace sightline
