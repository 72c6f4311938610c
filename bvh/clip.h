#pragma once
// The box of the part of a triangle that lies in a slab, rounded outwards.
//
//            b
//           /|\            section(p): bounds of the points where the edges cross plane p.
//          / | \           A slab's part has the sections at both of its planes and the corners
//     ----/--|--\---- p1   between them, so the parts of neighbouring slabs meet without a gap.
//        /   |   \         .
//     --/----|----\-- p0
//      a-----+-----c
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <span>

#include "bvh/reference.h"

namespace sightline {

/// What clipping needs to know of the scene.
struct Triangles {
  std::span<const glm::vec3> positions;
  std::span<const glm::uvec3> ids;
  Measure measure;
};

/// Share of the largest coordinate by which a computed point may be off: twelve roundings of 2^-24 each at
/// most, rounded up.
inline constexpr float kClipError = 0x1p-20f;
/// The same where products round to multiples of the least positive float.
inline constexpr float kLeastPad = 4 * std::numeric_limits<float>::denorm_min();

/// A triangle, ready to be cut by planes across one axis.
class Clipper {
 public:
  Clipper(const Triangles& t, uint32_t id) : scale_(lane(t.measure.scale, 0)) {
    const glm::uvec3 corners = t.ids[id];
    Float4 most = splat4(0);
    for (int i = 0; i < 3; ++i) {
      const glm::vec3 v = t.positions[corners[i]];
      const float f[4] = {v.x + 0.0f, v.y + 0.0f, v.z + 0.0f, 0};  // + 0: without negative zero
      corner_[i] = load4(f);
      most = max4(most, max4(corner_[i], splat4(0) - corner_[i]));
    }
    pad_ = most * splat4(kClipError) + splat4(kLeastPad);
  }

  void turnTo(int axis) {
    axis_ = axis;
    for (int i = 0; i < 3; ++i) along_[i] = lane(corner_[i], axis);
    for (int i = 0; i < 3; ++i) {
      const float length = along_[next(i)] * scale_ - along_[i] * scale_;
      inverse_[i] = std::fabs(length) > kNoExtent ? 1 / length : 0;
    }
  }

  Box section(float plane) const {
    Box box;
    for (int i = 0; i < 3; ++i) {
      const float a = along_[i], b = along_[next(i)];
      if (!((a < plane && b > plane) || (a > plane && b < plane))) continue;
      const Float4 p = corner_[i], q = corner_[next(i)];
      if (inverse_[i] == 0) {
        box.grow(min4(p, q), max4(p, q));
        continue;
      }
      const float t = (plane * scale_ - a * scale_) * inverse_[i];
      const Float4 s = p * splat4(1 - t) + q * splat4(t);
      box.grow(s - pad_, s + pad_);
    }
    return box;
  }

  /// The part with low <= coordinate <= high, within the reference's box. `sections`: bounds of the
  /// sections at those of the two planes that cut the triangle. The result may be empty.
  Box part(const Box& sections, const Reference& r, float low, float high) const {
    Box box = sections;
    for (int i = 0; i < 3; ++i) {
      if (along_[i] >= low && along_[i] <= high) box.grow(corner_[i], corner_[i]);
    }
    const float infinity = std::numeric_limits<float>::infinity();
    Float4 slab_low = splat4(-infinity), slab_high = splat4(infinity);
    setLane(slab_low, axis_, low);
    setLane(slab_high, axis_, high);
    box.low = max4(max4(box.low, slab_low), r.lowLanes());
    box.high = min4(min4(box.high, slab_high), r.highLanes());
    return {box.low + splat4(0), box.high + splat4(0)};
  }

 private:
  static int next(int i) { return i == 2 ? 0 : i + 1; }

  float scale_;
  int axis_ = 0;
  Float4 corner_[3], pad_;
  float along_[3] = {};    ///< the corners' coordinates on the axis
  float inverse_[3] = {};  ///< 1 / (scaled length of the edge on the axis); 0: too short
};

}  // namespace sightline
