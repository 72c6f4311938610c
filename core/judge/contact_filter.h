#pragma once
#include "core/judge/judge_ray.h"

namespace sightline {

/// What double arithmetic with error bounds can say for certain about a ray and a triangle.
enum class Certainty { kMiss, kHit, kUnsure };

struct FilteredContact {
  Certainty certainty = Certainty::kUnsure;
  DoubleRange t;  ///< kHit: holds the exact distance
};

/// A hit as of exact_contact.h, decided in double wherever rounding cannot change the answer: in all but some
/// ten thousandths of real cases. t_limit: hits certainly beyond it may count as misses.
///
/// Error analysis, with e = 2^-53, the products of six or fewer differences of the ray's and the triangle's
/// coordinates. x' is a corner minus the origin, off by e |x'|; D, A, B, C are the largest |components| of
/// the direction and of a', b', c'. A component of b' x c' errs by at most 8 e B C: two products, each with
/// two inexact factors and one rounding, and one difference. The dot product with d adds three roundings a
/// term: in all 3 * 8 e D B C + 3 * 3 * 2 e D B C = 42 e D B C. We take 64 e = 2^-47. The plane's normal is
/// made of edges, so its bound is that of the edges. Nothing underflows: floats and their differences are
/// multiples of 2^-149 (moved origins: of 2^-300, say), products of three of them are above 2^-1000.
FilteredContact filterContact(const JudgeRay& ray, const JudgeTriangle& triangle, double t_limit);

/// Range of the distance at which the ray's line crosses the triangle's plane, whether inside or not; false
/// where double cannot tell whether they are parallel.
bool filterPlaneDistance(const JudgeRay& ray, const JudgeTriangle& triangle, DoubleRange& t);

}  // namespace sightline
