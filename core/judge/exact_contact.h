#pragma once
// Exact arithmetic on rays and triangles. Only core/judge/*.cpp includes this: it needs CGAL, of which the
// LGPL parts alone are used (kernels and number types; tests/judge/licence_test.sh).
#include <CGAL/Mpzf.h>
#ifndef CGAL_HAS_MPZF
#include <CGAL/Gmpq.h>
#endif

#include <optional>

#include "core/judge/judge_ray.h"

namespace sightline {

/// Numbers without rounding, closed under +, - and *; every double is one.
#ifdef CGAL_HAS_MPZF
using ExactNumber = CGAL::Mpzf;
#else
using ExactNumber = CGAL::Gmpq;
#endif

/// number / divisor, divisor > 0.
struct ExactQuotient {
  ExactNumber number;
  ExactNumber divisor;
};

/// -1, 0 or 1 as a < b, a == b or a > b.
int compare(const ExactQuotient& a, const ExactQuotient& b);

/// A range of doubles about the quotient, a few units in the last place wide.
DoubleRange rangeOf(const ExactQuotient& quotient);

/// Where the ray's line crosses the triangle's plane; nothing where they are parallel or the triangle has no
/// area.
std::optional<ExactQuotient> exactPlaneDistance(const JudgeRay& ray, const JudgeTriangle& triangle);

/// The distance t > 0, in units of the direction, at which the ray meets the triangle; nothing if it does
/// not. Edges and corners belong to the triangle. A ray in the triangle's plane does not meet it: seen edge
/// on it has no area, and its neighbours' edges are met instead. Nor does one that starts on it (t = 0).
std::optional<ExactQuotient> exactContact(const JudgeRay& ray, const JudgeTriangle& triangle);

}  // namespace sightline
