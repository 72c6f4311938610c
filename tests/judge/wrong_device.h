#pragma once
// A device that answers wrongly in a chosen way: what a cross-check must find.
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "core/device/cpu_device.h"

namespace sightline::judge_test {

/// The cpu device, but for the answers of traceRays that `change` changes, and its sets, which lack the
/// triangles that loseFromSet names, or are otherwise what spoilSet makes of them.
class WrongDevice final : public Device {
 public:
  /// Changes the answer to a ray; returns whether it did. Called by one thread.
  using Change = std::function<bool(const Ray& ray, Hit& hit)>;

  WrongDevice(const Scene& scene, const Bvh& bvh, Change change)
      : device_(makeCpuDevice(scene, bvh, {})), change_(std::move(change)) {}

  DeviceInfo info() const override {
    DeviceInfo info = device_->info();
    info.id = "wrong";
    return info;
  }
  void beginCell(std::span<const Face> faces, const StageParams& params) override {
    device_->beginCell(faces, params);
  }
  void traceRandom(const RandomSegment& segment) override { device_->traceRandom(segment); }
  BorderBatch traceBorder(uint32_t first, uint32_t most_rays, bool listing) override {
    return device_->traceBorder(first, most_rays, listing);
  }
  void dropDiscontinuities() override { device_->dropDiscontinuities(); }
  void traceReverse(uint32_t first, uint32_t count) override { device_->traceReverse(first, count); }
  uint32_t collect(uint32_t stage) override { return device_->collect(stage); }
  void insertContained(std::span<const uint32_t> triangles) override { device_->insertContained(triangles); }
  uint64_t countMissing(const RandomSegment& segment, uvec4 shifts) override {
    return device_->countMissing(segment, shifts);
  }
  DeviceCounters counters() override { return device_->counters(); }
  std::vector<PvsEntry> readPvs() override {
    std::vector<PvsEntry> entries = device_->readPvs();
    std::erase_if(entries, [&](const PvsEntry& entry) { return lost_ && lost_(entry.origin_triangle.w); });
    if (spoil_) spoil_(entries);
    return entries;
  }
  void traceRays(std::span<const Ray> rays, std::span<Hit> hits) override {
    device_->traceRays(rays, hits);
    for (size_t i = 0; i < rays.size(); ++i) changed_ += change_(rays[i], hits[i]);
  }
  void traceViews(std::span<const ViewFrame> views, uint32_t resolution,
                  std::span<uint32_t> triangles) override {
    device_->traceViews(views, resolution, triangles);
  }

  void loseFromSet(std::function<bool(uint32_t)> lost) { lost_ = std::move(lost); }

  void spoilSet(std::function<void(std::vector<PvsEntry>&)> spoil) { spoil_ = std::move(spoil); }

  /// Answers changed so far.
  uint64_t changed() const { return changed_; }

 private:
  std::unique_ptr<Device> device_;
  Change change_;
  std::function<bool(uint32_t)> lost_;
  std::function<void(std::vector<PvsEntry>&)> spoil_;
  uint64_t changed_ = 0;
};

}  // namespace sightline::judge_test
