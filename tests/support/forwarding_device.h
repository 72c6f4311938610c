#pragma once
#include <memory>
#include <utility>
#include <vector>

#include "core/device/device.h"

namespace sightline::testing_support {

/// Passes every call on to another device: for devices of tests that change one of them.
class ForwardingDevice : public Device {
 public:
  explicit ForwardingDevice(std::unique_ptr<Device> device) : device_(std::move(device)) {}

  DeviceInfo info() const override { return device_->info(); }
  void beginCell(std::span<const Face> faces, const StageParams& params) override {
    device_->beginCell(faces, params);
  }
  void traceRandom(const RandomSegment& segment) override { device_->traceRandom(segment); }
  BorderBatch traceBorder(uint32_t first, uint32_t most_rays, bool listing) override {
    return device_->traceBorder(first, most_rays, listing);
  }
  void traceReverse(uint32_t first, uint32_t count) override { device_->traceReverse(first, count); }
  void dropDiscontinuities() override { device_->dropDiscontinuities(); }
  HemicubeDrawer& drawer() override { return device_->drawer(); }
  uint32_t collect(uint32_t stage) override { return device_->collect(stage); }
  void insertContained(std::span<const uint32_t> triangles) override { device_->insertContained(triangles); }
  uint64_t countMissing(const RandomSegment& segment, uvec4 shifts) override {
    return device_->countMissing(segment, shifts);
  }
  DeviceCounters counters() override { return device_->counters(); }
  std::vector<PvsEntry> readPvs() override { return device_->readPvs(); }
  void traceRays(std::span<const Ray> rays, std::span<Hit> hits) override { device_->traceRays(rays, hits); }
  bool hasGlass() const override { return device_->hasGlass(); }
  std::vector<SeenThrough> traceGlass(std::span<const Ray> rays, std::span<const Hit> hits) override {
    return device_->traceGlass(rays, hits);
  }
  void traceViews(std::span<const ViewFrame> views, uint32_t resolution,
                  std::span<uint32_t> triangles) override {
    device_->traceViews(views, resolution, triangles);
  }

 private:
  std::unique_ptr<Device> device_;
};

}  // namespace sightline::testing_support
