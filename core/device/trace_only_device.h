#pragma once
#include "core/base/error.h"
#include "core/device/device.h"

namespace sightline {

/// A device that answers rays and has no stages of a bake: a foreign tracer to compare with. All else that a
/// device does throws Error.
class TraceOnlyDevice : public Device {
 public:
  void beginCell(std::span<const Face>, const StageParams&) final { refuse(); }
  void traceRandom(const RandomSegment&) final { refuse(); }
  BorderBatch traceBorder(uint32_t, uint32_t, bool) final { refuse(); }
  void traceReverse(uint32_t, uint32_t) final { refuse(); }
  void dropDiscontinuities() final { refuse(); }
  uint32_t collect(uint32_t) final { refuse(); }
  void insertContained(std::span<const uint32_t>) final { refuse(); }
  uint64_t countMissing(const RandomSegment&, uvec4) final { refuse(); }
  DeviceCounters counters() final { refuse(); }
  std::vector<PvsEntry> readPvs() final { refuse(); }
  void traceViews(std::span<const ViewFrame>, uint32_t, std::span<uint32_t>) final { refuse(); }

 private:
  [[noreturn]] void refuse() const {
    throw Error(info().id + " traces rays for crosscheck and trace only; take cpu, opencl or vulkan",
                kExitUsage);
  }
};

/// Whether the device has the stages of a bake.
inline bool canBake(const Device& device) {
  return dynamic_cast<const TraceOnlyDevice*>(&device) == nullptr;
}

}  // namespace sightline
