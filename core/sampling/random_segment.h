#pragma once
#include <cstdint>

#include "core/shared/stage_params.h"

namespace sightline {

/// The run first .. first + count - 1 of the Halton sequence on a face, with strata of 16 rays or some more
/// (a single stratum for short runs). first_ray_index: of the run's first ray in its batch. count: 1 ..
/// 2^32 - 3.
RandomSegment makeRandomSegment(uint32_t face, uint64_t first, uint32_t count, uint32_t first_ray_index);

/// Work items (slots) that a device launches for the segment; some trace no ray.
inline uint64_t slotCount(const RandomSegment& segment) {
  return uint64_t(segment.batch.y) * segment.batch.z;
}

}  // namespace sightline
