#pragma once
#include <cstdint>
#include <glm/glm.hpp>

namespace sightline {

/// Triangles of a set that were only seen through narrow gaps.
struct Leaks {
  float width = 0;              ///< gaps narrower than this, world units
  uint64_t triangles = 0;       ///< of the set
  uint32_t first_triangle = 0;  ///< the one of the lowest id, where there are any
  glm::dvec3 place{0.0};        ///< the gap through which its witness sees it
  uint64_t rays = 0;            ///< that the search traced
  double seconds = 0;           ///< that it took
};

}  // namespace sightline
