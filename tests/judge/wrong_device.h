#pragma once
// A device that answers wrongly in a chosen way: what a cross-check must find.
#include <functional>
#include <utility>
#include <vector>

#include "core/device/cpu/cpu_device.h"
#include "tests/support/forwarding_device.h"

namespace sightline::judge_test {

/// The cpu device, but for the answers of traceRays that `change` changes, and its sets, which lack the
/// triangles that loseFromSet names, or are otherwise what spoilSet makes of them.
class WrongDevice final : public testing_support::ForwardingDevice {
 public:
  /// Changes the answer to a ray; returns whether it did. Called by one thread.
  using Change = std::function<bool(const Ray& ray, Hit& hit)>;

  WrongDevice(const Scene& scene, const Bvh& bvh, Change change)
      : ForwardingDevice(makeCpuDevice(scene, bvh, {})), change_(std::move(change)) {}

  DeviceInfo info() const override {
    DeviceInfo info = ForwardingDevice::info();
    info.id = "wrong";
    return info;
  }
  std::vector<PvsEntry> readPvs() override {
    std::vector<PvsEntry> entries = ForwardingDevice::readPvs();
    std::erase_if(entries, [&](const PvsEntry& entry) { return lost_ && lost_(entry.origin_triangle.w); });
    if (spoil_) spoil_(entries);
    return entries;
  }
  void traceRays(std::span<const Ray> rays, std::span<Hit> hits) override {
    ForwardingDevice::traceRays(rays, hits);
    for (size_t i = 0; i < rays.size(); ++i) changed_ += change_(rays[i], hits[i]);
  }

  void loseFromSet(std::function<bool(uint32_t)> lost) { lost_ = std::move(lost); }
  void spoilSet(std::function<void(std::vector<PvsEntry>&)> spoil) { spoil_ = std::move(spoil); }

  /// Answers changed so far.
  uint64_t changed() const { return changed_; }

 private:
  Change change_;
  std::function<bool(uint32_t)> lost_;
  std::function<void(std::vector<PvsEntry>&)> spoil_;
  uint64_t changed_ = 0;
};

}  // namespace sightline::judge_test
