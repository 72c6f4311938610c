#pragma once
#include <algorithm>
#include <glm/glm.hpp>

namespace sightline {

/// The largest of the three numbers.
inline double largest(const glm::dvec3& v) {
  return std::max({v.x, v.y, v.z});
}

}  // namespace sightline
