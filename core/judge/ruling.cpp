#include "core/judge/ruling.h"

#include <algorithm>
#include <cmath>

namespace sightline {
namespace {

/// Half a unit in the last place of float, as a share.
constexpr double kFloatRounding = 0x1p-24;
/// Shares of the limit at which rays beside the given one are tried, in 26 directions.
constexpr double kTriedShares[] = {0.97, 0.11};
/// First triangles whose edges are stepped over at most: a corner may have any number.
constexpr size_t kTriedTriangles = 16;
/// Triangles about the origin that a ray may pass as if they were behind it.
constexpr int kPassedAtOrigin = 8;
/// Some units in the last place of double.
constexpr double kDoubleRounding = 0x1p-46;

/// Axes at right angles to the ray.
struct RayFrame {
  glm::dvec3 forward, right, up;
};

RayFrame frameOf(const glm::dvec3& direction) {
  const glm::dvec3 forward = glm::normalize(direction / maxAbs(direction));
  const glm::dvec3 size = glm::abs(forward);
  const glm::dvec3 axis = size.x <= size.y && size.x <= size.z
                              ? glm::dvec3(1, 0, 0)
                              : (size.y <= size.z ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, 1));
  const glm::dvec3 right = glm::normalize(glm::cross(forward, axis));
  return {forward, right, glm::cross(forward, right)};
}

/// The point of the segment nearest to the third axis.
glm::dvec3 nearestOfSegment(const glm::dvec3& a, const glm::dvec3& b) {
  const glm::dvec2 ab(b - a);
  const double length2 = glm::dot(ab, ab);
  if (length2 == 0) return a;
  return glm::mix(a, b, std::clamp(-glm::dot(glm::dvec2(a), ab) / length2, 0.0, 1.0));
}

/// A triangle seen along the ray, which is the third axis.
struct SeenTriangle {
  glm::dvec3 corners[3];
  glm::dvec3 nearest_of_edge[3];  ///< to the ray

  SeenTriangle(const JudgeTriangle& t, const JudgeRay& ray, const RayFrame& frame) {
    const glm::dvec3 moved[3] = {t.a - ray.origin, t.b - ray.origin, t.c - ray.origin};
    for (int i = 0; i < 3; ++i) {
      corners[i] = {glm::dot(moved[i], frame.right), glm::dot(moved[i], frame.up),
                    glm::dot(moved[i], frame.forward)};
    }
    for (int i = 0; i < 3; ++i) nearest_of_edge[i] = nearestOfSegment(corners[i], corners[(i + 1) % 3]);
  }
  glm::dvec2 nearestOfBorder() const {
    const auto nearer = [](const glm::dvec2& a, const glm::dvec2& b) {
      return glm::dot(a, a) < glm::dot(b, b);
    };
    return std::min(
        {glm::dvec2(nearest_of_edge[0]), glm::dvec2(nearest_of_edge[1]), glm::dvec2(nearest_of_edge[2])},
        nearer);
  }
  glm::dvec2 centroid() const { return glm::dvec2(corners[0] + corners[1] + corners[2]) / 3.0; }
};

/// Tries rays beside the given one.
class RoundingSearch {
 public:
  RoundingSearch(const Judge& judge, const JudgeRay& ray, uint32_t answer, const ExactHit& exact,
                 double reach)
      : judge_(judge),
        ray_(ray),
        answer_(answer),
        exact_(exact),
        reach_(reach),
        frame_(frameOf(ray.direction)) {}

  /// Whether a ray within reach gives the answer.
  bool explains() const {
    return works(ray_) || nextToAnswer() || throughAnswer() || pastFirst() || anywhere();
  }

 private:
  bool worksMoved(const glm::dvec3& offset) const {
    return works(JudgeRay{ray_.origin + offset, ray_.direction});
  }
  bool worksBeside(const glm::dvec2& seen) const {
    return worksMoved(frame_.right * seen.x + frame_.up * seen.y);
  }

  /// Whether the answer is right for this ray. A triangle so close to the origin that rounding may put it
  /// behind it does not count: then what comes after it does.
  bool works(JudgeRay ray) const {
    for (int passed = 0;; ++passed) {
      const ExactHit first = judge_.nearest(ray);
      if (isFirst(first, ray)) return true;
      if (first.missed() || passed == kPassedAtOrigin) return false;
      for (const uint32_t triangle : first.triangles) {
        if (depths(ray, triangle).low > 0) return false;
      }
      const double least = kDoubleRounding * (maxAbs(ray.origin) / maxAbs(ray.direction));
      ray.origin += ray.direction * (first.t.high * (1 + kDoubleRounding) + least);
    }
  }

  bool isFirst(const ExactHit& first, const JudgeRay& ray) const {
    if (answer_ == kNoTriangle || first.missed()) return (answer_ == kNoTriangle) == first.missed();
    if (first.contains(answer_)) return true;
    if (!judge_.meets(ray, answer_)) return false;
    const double least = depths(ray, answer_).low;
    return std::any_of(first.triangles.begin(), first.triangles.end(),
                       [&](uint32_t triangle) { return least <= depths(ray, triangle).high; });
  }

  /// Distances at which the ray, which meets the triangle, does so when it is moved by up to reach_; not
  /// beyond its corners.
  DoubleRange depths(const JudgeRay& ray, uint32_t triangle) const {
    const auto t = judge_.planeDistance(ray, triangle);
    const JudgeTriangle shape = judge_.corners(triangle);
    const double length = glm::length(ray.direction), slack = reach_ / length;
    const glm::dvec3 normal = glm::cross(shape.b - shape.a, shape.c - shape.a);
    const double change = slack * length * glm::length(normal) / std::fabs(glm::dot(ray.direction, normal));
    const auto along = [&](const glm::dvec3& corner) {
      return glm::dot(corner - ray.origin, ray.direction) / (length * length);
    };
    const auto [least, most] = std::minmax({along(shape.a), along(shape.b), along(shape.c)});
    return {std::max(t->low - change, least - slack), std::min(t->high + change, most + slack)};
  }

  /// Rays just inside the answer's triangle, where they can be reached.
  bool nextToAnswer() const {
    if (answer_ == kNoTriangle) return false;
    const SeenTriangle seen(judge_.corners(answer_), ray_, frame_);
    const glm::dvec2 border = seen.nearestOfBorder(), inwards = seen.centroid() - border;
    const double spare = reach_ - glm::length(border), depth = glm::length(inwards);
    if (spare <= 0 || depth == 0) return false;
    for (const double share : {0.5, 0.01}) {
      if (worksBeside(border + inwards * (share * std::min(1.0, spare / depth)))) return true;
    }
    return false;
  }

  /// Rays that turn through the answer's triangle, which is seen edge on: from either side of it to the
  /// middle of what lies in reach.
  bool throughAnswer() const {
    if (answer_ == kNoTriangle) return false;
    const JudgeTriangle shape = judge_.corners(answer_);
    const SeenTriangle seen(shape, ray_, frame_);
    glm::dvec3 sum(0.0);
    int in_reach = 0;
    for (const glm::dvec3& place : seen.nearest_of_edge) {
      if (glm::length(glm::dvec2(place)) > 0.9 * reach_) continue;
      sum += place;
      ++in_reach;
    }
    const glm::dvec3 normal = glm::cross(shape.b - shape.a, shape.c - shape.a);
    if (in_reach < 2 || normal == glm::dvec3(0.0) || !(sum.z > 0)) return false;
    const glm::dvec3 middle = sum / double(in_reach);
    const glm::dvec3 target =
        ray_.origin + frame_.right * middle.x + frame_.up * middle.y + frame_.forward * middle.z;
    const double length = glm::length(ray_.direction);
    for (const double side : {0.5, -0.5}) {
      const glm::dvec3 origin = ray_.origin + glm::normalize(normal) * (side * reach_);
      if (works(JudgeRay{origin, (target - origin) * (length / middle.z)})) return true;
    }
    return false;
  }

  /// Rays just beyond the edges of what is met first.
  bool pastFirst() const {
    for (size_t i = 0; i < std::min(kTriedTriangles, exact_.triangles.size()); ++i) {
      const SeenTriangle seen(judge_.corners(exact_.triangles[i]), ray_, frame_);
      for (const glm::dvec2 place : seen.nearest_of_edge) {
        const double distance = glm::length(place);
        if (distance > 0 && distance < 0.9 * reach_ && worksBeside(place * (1 + 0.1 * reach_ / distance)))
          return true;
      }
    }
    return false;
  }

  bool anywhere() const {
    for (const double share : kTriedShares) {
      for (int i = 0; i < 27; ++i) {
        const glm::dvec3 way(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
        if (i == 13) continue;
        const glm::dvec3 offset = frame_.right * way.x + frame_.up * way.y + frame_.forward * way.z;
        if (worksMoved(offset * (share * reach_ / glm::length(way)))) return true;
      }
    }
    return false;
  }

  const Judge& judge_;
  const JudgeRay& ray_;
  uint32_t answer_;
  const ExactHit& exact_;
  double reach_;  ///< world units
  RayFrame frame_;
};

/// Whether the answer's distance is that of its triangle, moved by up to `reach`.
bool rightDistance(const Judge& judge, const JudgeRay& ray, const Hit& answer, double reach) {
  const auto t = judge.planeDistance(ray, answer.triangle);
  if (!t) return true;  // edge on: anything between its corners
  const JudgeTriangle shape = judge.corners(answer.triangle);
  const glm::dvec3 normal = glm::cross(shape.b - shape.a, shape.c - shape.a);
  const double change = reach * glm::length(normal) / std::fabs(glm::dot(ray.direction, normal));
  const double rounding = std::fabs(t->high) * 4 * kFloatRounding;
  return answer.t >= t->low - change - rounding && answer.t <= t->high + change + rounding;
}

}  // namespace

double floatStep(const Judge& judge, const JudgeRay& ray, std::span<const uint32_t> triangles) {
  double reach = 0;
  for (const uint32_t triangle : triangles) {
    const JudgeTriangle t = judge.corners(triangle);
    for (const glm::dvec3& corner : {t.a, t.b, t.c}) reach = std::max(reach, maxAbs(corner - ray.origin));
  }
  return reach * kFloatRounding;
}

Ruling rule(const Judge& judge, const Ray& float_ray, const Hit& answer, const ExactHit& exact,
            const RoundingLimit& limit) {
  const JudgeRay ray = judgeRay(float_ray);
  const bool hit = answer.triangle != kNoTriangle;
  if (!hit && exact.missed()) return {};
  if (hit && (answer.triangle >= judge.triangleCount() || !(answer.t > 0)))
    return {Verdict::kWrong, HUGE_VAL};

  std::vector<uint32_t> involved = exact.triangles;
  if (hit) involved.push_back(answer.triangle);
  const double step = floatStep(judge, ray, involved), reach = limit.steps * step;
  const bool meets = hit && (exact.contains(answer.triangle) || judge.meets(ray, answer.triangle));
  Ruling ruling;
  if (hit && !meets) {
    const SeenTriangle seen(judge.corners(answer.triangle), ray, frameOf(ray.direction));
    ruling.steps_beside = glm::length(seen.nearestOfBorder()) / step;
  }
  if (hit && !rightDistance(judge, ray, answer, reach)) {
    ruling.verdict = Verdict::kWrong;
  } else if (meets && exact.contains(answer.triangle)) {
    ruling.verdict = Verdict::kRight;
  } else if (RoundingSearch(judge, ray, answer.triangle, exact, reach).explains()) {
    ruling.verdict = Verdict::kRounded;
  } else {
    const bool real = !hit || meets || ruling.steps_beside <= limit.steps;
    ruling.verdict = real && !exact.missed() ? Verdict::kMissed : Verdict::kWrong;
  }
  return ruling;
}

}  // namespace sightline
