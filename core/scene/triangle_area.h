#pragma once
#include <glm/glm.hpp>

namespace sightline {

/// Whether the triangle has no area: its cross product, in double, is exactly zero.
inline bool hasZeroArea(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  const glm::dvec3 origin(a);
  return glm::cross(glm::dvec3(b) - origin, glm::dvec3(c) - origin) == glm::dvec3(0.0);
}

}  // namespace sightline
