#pragma once
#include <chrono>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "core/device/device.h"

namespace sightline {

/// A device that books the seconds of every call: each stage returns when the device is done with it.
class TimedDevice final : public Device {
  // First: its type is deduced.
  template <typename Call>
  auto timed(const char* what, Call&& call) {
    struct Clock {
      double& sum;
      std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
      ~Clock() { sum += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); }
    } clock{seconds_[what]};
    return call();
  }

 public:
  explicit TimedDevice(Device& inner) : inner_(inner) {}

  /// What took the seconds since the last beginCell.
  const std::map<std::string, double>& seconds() const { return seconds_; }

  DeviceInfo info() const override { return inner_.info(); }
  void beginCell(std::span<const Face> faces, const StageParams& params) override {
    seconds_.clear();
    timed("begin", [&] { inner_.beginCell(faces, params); });
  }
  void traceRandom(const RandomSegment& segment) override {
    timed("trace random", [&] { inner_.traceRandom(segment); });
  }
  void dropDiscontinuities() override { inner_.dropDiscontinuities(); }
  BorderBatch traceBorder(uint32_t first, uint32_t most_rays, bool listing) override {
    return timed("trace border", [&] { return inner_.traceBorder(first, most_rays, listing); });
  }
  void traceReverse(uint32_t first, uint32_t count) override {
    timed("trace reverse", [&] { inner_.traceReverse(first, count); });
  }
  uint32_t collect(uint32_t stage) override {
    return timed("collect", [&] { return inner_.collect(stage); });
  }
  void insertContained(std::span<const uint32_t> triangles) override {
    timed("contained", [&] { inner_.insertContained(triangles); });
  }
  uint64_t countMissing(const RandomSegment& segment, uvec4 shifts) override {
    return timed("trace validation", [&] { return inner_.countMissing(segment, shifts); });
  }
  DeviceCounters counters() override { return inner_.counters(); }
  std::vector<PvsEntry> readPvs() override {
    return timed("read", [&] { return inner_.readPvs(); });
  }
  void traceRays(std::span<const Ray> rays, std::span<Hit> hits) override { inner_.traceRays(rays, hits); }
  bool hasGlass() const override { return inner_.hasGlass(); }
  std::vector<SeenThrough> traceGlass(std::span<const Ray> rays, std::span<const Hit> hits) override {
    return inner_.traceGlass(rays, hits);
  }
  void traceViews(std::span<const ViewFrame> views, uint32_t resolution,
                  std::span<uint32_t> triangles) override {
    inner_.traceViews(views, resolution, triangles);
  }

 private:
  Device& inner_;
  std::map<std::string, double> seconds_;
};

}  // namespace sightline
