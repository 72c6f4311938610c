#pragma once
#include <span>

#include "core/judge/judge.h"
#include "core/shared/types.h"

namespace sightline {

/// How the judge finds a device's answer for a ray.
enum class Verdict : uint8_t {
  kRight,    ///< exact: the triangle is met at the smallest distance, or nothing is met
  kRounded,  ///< right for a ray beside it, at most some float steps away: the ray passes close to an edge
  kMissed,   ///< nothing, or something behind the first triangle, though no ray near by gets past that
  kWrong,    ///< a triangle that no ray near by meets, or at a distance that is off
};
inline constexpr uint32_t kVerdicts = 4;

struct Ruling {
  Verdict verdict = Verdict::kRight;
  double steps_beside = 0;  ///< from the ray to the answer's triangle, in float steps; 0: it meets it
};

/// What counts as rounding.
struct RoundingLimit {
  /// Float steps by which a ray may pass beside what it is said to meet. Our own test
  /// (core/shared/triangle.h) moves corners by at most 5 steps sideways; hardware is not told to do better
  /// than that.
  double steps = 16;
};

/// A float step at a ray and triangles: 2^-24 of the largest component of a corner minus the origin. It is
/// what rounding that difference moves a corner by, and does not depend on where the whole scene lies.
double floatStep(const Judge& judge, const JudgeRay& ray, std::span<const uint32_t> triangles);

/// Rules on a device's answer; `exact` is judge.nearest of the ray.
///
/// Whether rounding explains an answer that is not right is shown, not guessed: the judge looks for a ray
/// parallel to the given one, at most limit.steps away, for which the answer is exact (depths may differ by
/// what so many steps at either triangle make). So a ray aimed at a corner inside a closed surface must hit
/// it, as every ray near by does; one aimed at a silhouette may pass.
Ruling rule(const Judge& judge, const Ray& ray, const Hit& answer, const ExactHit& exact,
            const RoundingLimit& limit = {});

}  // namespace sightline
