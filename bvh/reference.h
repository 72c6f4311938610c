#pragma once
// What the builder sorts: a triangle's box (with spatial splits, the box of a part of it) and its id.
#include <cstdint>
#include <cstring>
#include <glm/glm.hpp>
#include <limits>

#include "bvh/float4.h"

namespace sightline {

/// Axis-aligned box; the fourth lanes mean nothing. Empty: low > high.
struct Box {
  Float4 low = splat4(std::numeric_limits<float>::infinity());
  Float4 high = splat4(-std::numeric_limits<float>::infinity());

  void grow(Float4 l, Float4 h) {
    low = min4(low, l);
    high = max4(high, h);
  }
  void grow(const Box& b) { grow(b.low, b.high); }
  bool isEmpty() const { return !lessEqual3(low, high); }
};

/// 32 bytes: low.x low.y low.z id, high.x high.y high.z 0. No coordinate is -0, so that minimum and
/// maximum do not depend on the order of their arguments.
struct Reference {
  float low[3];
  uint32_t id;
  float high[3];
  uint32_t unused;

  Float4 lowLanes() const { return load4(low); }  // the fourth lane is the id's bits
  Float4 highLanes() const { return load4(high); }
};
static_assert(sizeof(Reference) == 32);

/// Everything that is measured (areas, centroids) is measured after scaling by this power of two, which
/// brings the largest coordinate to [0.5, 1): neither 1e30 nor 1e-30 overflows or vanishes.
struct Measure {
  Float4 scale = splat4(1.0f);

  /// Sum of the box's low and high corner, scaled: twice the centroid. The fourth lane is 0.
  Float4 centroid(const Reference& r) const {
    return clearFourth(r.lowLanes()) * scale + clearFourth(r.highLanes()) * scale;
  }
  /// Half the surface area, scaled. The box must not be empty.
  float halfArea(const Box& b) const {
    alignas(16) float d[4];
    store4(d, clearFourth(b.high) * scale - clearFourth(b.low) * scale);
    return d[0] * d[1] + d[1] * d[2] + d[2] * d[0];
  }
};

/// In the scale of Measure: 1 / length would overflow below it, or bins per length.
inline constexpr float kNoExtent = 1e-30f;

}  // namespace sightline
