#pragma once
#include <span>

#include "core/judge/judge.h"
#include "core/shared/types.h"

namespace sightline {

/// How the judge finds a device's answer for a ray.
enum class Verdict : uint8_t {
  kRight,    ///< exact: the triangle is met at the smallest distance, or nothing is met
  kRounded,  ///< exact once corners are moved by some float steps: the ray passes close to an edge
  kMissed,   ///< nothing, or something behind the first triangle, which rounding cannot move out of the way
  kWrong,    ///< a triangle that the ray does not come near, or at a distance that is off
};
inline constexpr uint32_t kVerdicts = 4;
inline constexpr Verdict kAllVerdicts[kVerdicts] = {Verdict::kRight, Verdict::kRounded, Verdict::kMissed,
                                                    Verdict::kWrong};

struct Ruling {
  Verdict verdict = Verdict::kRight;
  double steps_beside = 0;  ///< from the ray to the answer's triangle, in float steps; 0: it meets it
};

/// What counts as rounding.
struct RoundingLimit {
  /// Float steps by which corners may be moved. Our own test (core/shared/triangle.h) moves them by at most 5
  /// steps sideways; hardware is not told to do better than that.
  double steps = 16;
};

/// A float step at a ray and a triangle, world units: 2^-24 of the largest component of a corner minus the
/// origin. It is what rounding that difference moves a corner by; it does not depend on where the whole scene
/// lies.
double floatStep(const Judge& judge, const JudgeRay& ray, uint32_t triangle);

/// Rules on a device's answer; `exact` is judge.nearest of the ray.
///
/// Rounding moves corners, but a corner that several triangles share moves for all of them alike: that is
/// what watertight means. So an answer that is not right is explained by rounding if the ray passes within
/// limit.steps of its triangle, and if whatever lies in front can be moved out of the way by as much: each
/// piece of surface, joined at the corners and edges that the ray passes, as a whole. What is so near to the
/// answer or to the origin that rounding may put it behind them is not in the way. A ray aimed at a corner
/// inside a surface must hit it; one aimed at a silhouette, or at a gap between two surfaces that touch
/// without sharing corners (a T-junction), may pass. judge_distance: false for an answer that names a
/// triangle alone.
Ruling rule(const Judge& judge, const Ray& ray, const Hit& answer, const ExactHit& exact,
            const RoundingLimit& limit = {}, bool judge_distance = true);

/// Rules on the glass that a device says a ray sees, ascending; `answer` is what it says ends the ray,
/// `exact` judge.nearest of the ray. Right: it is judge.glassBefore. Else each triangle that is listed must
/// be glass that the ray passes within limit.steps, no farther than the answer up to rounding, or the list is
/// wrong; and what glass is left out, surely nearer than the answer, must be such that the ray can pass it as
/// in rule(), or glass is missed. Of an answer that is missed or wrong itself nothing more is said: right.
Ruling ruleGlass(const Judge& judge, const Ray& ray, const Hit& answer, std::span<const uint32_t> glass,
                 const ExactHit& exact, const RoundingLimit& limit = {});

/// The worse of rule and ruleGlass.
Ruling ruleSight(const Judge& judge, const Ray& ray, const Hit& answer, std::span<const uint32_t> glass,
                 const ExactHit& exact, const RoundingLimit& limit = {});

}  // namespace sightline
