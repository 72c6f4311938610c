#pragma once
// Based on: T. Akenine-Moller, Fast 3D Triangle-Box Overlap Testing, 2001: the separating axis theorem over
// the box's three normals, the triangle's normal and the nine cross products of edges; here in double, in the
// box's frame, and with touching counted as overlap.
#include <algorithm>
#include <glm/glm.hpp>

namespace sightline {

/// Whether the projections of box and triangle on the axis have no point in common. A zero axis (parallel
/// edges) separates nothing.
inline bool separates(const glm::dvec3& axis, const glm::dvec3 (&corners)[3], const glm::dvec3& half_size) {
  const double a = glm::dot(axis, corners[0]);
  const double b = glm::dot(axis, corners[1]);
  const double c = glm::dot(axis, corners[2]);
  const double radius = glm::dot(glm::abs(axis), half_size);
  return std::min({a, b, c}) > radius || std::max({a, b, c}) < -radius;
}

/// Whether the triangle and the closed box |p| <= half_size have a point in common.
inline bool triangleMeetsBox(const glm::dvec3 (&corners)[3], const glm::dvec3& half_size) {
  const glm::dvec3 low = glm::min(corners[0], glm::min(corners[1], corners[2]));
  const glm::dvec3 high = glm::max(corners[0], glm::max(corners[1], corners[2]));
  for (int i = 0; i < 3; ++i) {
    if (low[i] > half_size[i] || high[i] < -half_size[i]) return false;
  }
  const glm::dvec3 edges[3] = {corners[1] - corners[0], corners[2] - corners[1], corners[0] - corners[2]};
  if (separates(glm::cross(edges[0], edges[1]), corners, half_size)) return false;
  for (const glm::dvec3& edge : edges) {
    if (separates({0.0, -edge.z, edge.y}, corners, half_size)) return false;
    if (separates({edge.z, 0.0, -edge.x}, corners, half_size)) return false;
    if (separates({-edge.y, edge.x, 0.0}, corners, half_size)) return false;
  }
  return true;
}

}  // namespace sightline
