#include "core/crosscheck/difference.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/judge/seen_triangle.h"

namespace sightline {
namespace {

/// Two floats of the same number, rounded in different ways.
constexpr float kTieShare = 0x1p-21f;

/// Corners that both triangles have: none, one, or an edge's two (all three for copies).
std::vector<glm::dvec3> sharedCorners(const JudgeTriangle& s, const JudgeTriangle& t) {
  std::vector<glm::dvec3> shared;
  for (const glm::dvec3& p : {s.a, s.b, s.c}) {
    if (p == t.a || p == t.b || p == t.c) shared.push_back(p);
  }
  return shared;
}

/// Distance of the ray's line to the segment p q.
double distanceToSegment(const JudgeRay& ray, const glm::dvec3& p, const glm::dvec3& q) {
  const RayFrame frame(ray.direction);
  const auto seen = [&](const glm::dvec3& x) {
    return glm::dvec2(glm::dot(x - ray.origin, frame.right), glm::dot(x - ray.origin, frame.up));
  };
  return glm::length(nearestOfSegment(seen(p), seen(q)));
}

/// Whether the two are neighbours by something that the ray meets.
bool meetsWhatIsShared(const Judge& judge, const JudgeRay& ray, uint32_t a, uint32_t b,
                       const RoundingLimit& limit) {
  const auto shared = sharedCorners(judge.corners(a), judge.corners(b));
  if (shared.empty() || shared.size() > 2) return false;
  const double step = std::max(floatStep(judge, ray, a), floatStep(judge, ray, b));
  return distanceToSegment(ray, shared.front(), shared.back()) <= limit.steps * step;
}

}  // namespace

std::string differenceName(Difference difference) {
  constexpr const char* kNames[] = {"same", "tie", "edge", "missed", "wrong", "glass"};
  return kNames[size_t(difference)];
}

std::string verdictName(Verdict verdict) {
  constexpr const char* kNames[] = {"right", "rounded", "missed", "wrong"};
  return kNames[size_t(verdict)];
}

Difference differenceOf(const Judge& judge, const Ray& ray, const Hit& a, const Hit& b,
                        const RoundingLimit& limit) {
  if (a.triangle == b.triangle) return Difference::kSame;
  if (a.triangle == kNoTriangle || b.triangle == kNoTriangle) return Difference::kMissed;
  if (std::max(a.triangle, b.triangle) >= judge.triangleCount()) return Difference::kWrong;
  if (meetsWhatIsShared(judge, judgeRay(ray), a.triangle, b.triangle, limit)) return Difference::kEdge;
  if (std::fabs(a.t - b.t) <= kTieShare * std::max(a.t, b.t)) return Difference::kTie;
  return Difference::kWrong;
}

}  // namespace sightline
