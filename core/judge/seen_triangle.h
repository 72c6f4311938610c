#pragma once
#include <algorithm>
#include <cmath>

#include "core/judge/judge_ray.h"

namespace sightline {

/// Axes with the ray as the third; the ray's line is where the first two are 0.
struct RayFrame {
  glm::dvec3 right, up, forward;

  explicit RayFrame(const glm::dvec3& direction) {
    forward = glm::normalize(direction / maxAbs(direction));
    const glm::dvec3 size = glm::abs(forward);
    const glm::dvec3 axis = size.x <= size.y && size.x <= size.z
                                ? glm::dvec3(1, 0, 0)
                                : (size.y <= size.z ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, 1));
    right = glm::normalize(glm::cross(forward, axis));
    up = glm::cross(forward, right);
  }
};

/// The point of the segment nearest to 0.
inline glm::dvec2 nearestOfSegment(const glm::dvec2& a, const glm::dvec2& b) {
  const glm::dvec2 ab = b - a;
  const double length2 = glm::dot(ab, ab);
  return length2 == 0 ? a : a + ab * std::clamp(-glm::dot(a, ab) / length2, 0.0, 1.0);
}

/// A triangle as seen along a ray, which is 0. In double: good to 2^-50 of the distance, where a float step
/// is 2^-24 of it.
struct SeenTriangle {
  glm::dvec2 corners[3];
  glm::dvec2 nearest_of_edge[3];  ///< edge i runs from corner i to the next

  SeenTriangle(const JudgeTriangle& t, const JudgeRay& ray, const RayFrame& frame) {
    const glm::dvec3 moved[3] = {t.a - ray.origin, t.b - ray.origin, t.c - ray.origin};
    for (int i = 0; i < 3; ++i) corners[i] = {glm::dot(moved[i], frame.right), glm::dot(moved[i], frame.up)};
    for (int i = 0; i < 3; ++i) nearest_of_edge[i] = nearestOfSegment(corners[i], corners[(i + 1) % 3]);
  }

  /// From the ray's line to the triangle; 0: it passes inside.
  double distance() const {
    int left = 0, right = 0;
    double nearest = HUGE_VAL;
    for (int i = 0; i < 3; ++i) {
      const glm::dvec2 &p = corners[i], &q = corners[(i + 1) % 3];
      const double side = p.x * q.y - p.y * q.x;
      left += side > 0;
      right += side < 0;
      nearest = std::min(nearest, glm::length(nearest_of_edge[i]));
    }
    return left == 3 || right == 3 ? 0 : nearest;
  }
};

}  // namespace sightline
