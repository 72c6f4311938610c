#include "core/bound/leak.h"

#include <algorithm>
#include <cmath>

namespace sightline {
namespace {

double largestOf(const glm::dvec3& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

}  // namespace

std::optional<glm::dvec3> opaquePlace(const glm::dvec3& from, const glm::dvec3& to, const Lattice& lattice,
                                      const BlockedSpace& opaque) {
  const double size = lattice.voxelSize();
  const glm::dvec3 start = from / size, way = (to - from) / size;
  int axis = 0;
  for (const int other : {1, 2}) {
    if (std::abs(way[other]) > std::abs(way[axis])) axis = other;
  }
  const double slack = (largestOf(start) + largestOf(way)) * 0x1p-46;
  const int step = way[axis] < 0 ? -1 : 1;
  const int first = int(std::floor(start[axis])), last = int(std::floor(start[axis] + way[axis]));
  for (int at = first;; at += step) {
    // The part of the segment in this layer meets at most two voxels along each other axis, and those that it
    // touches.
    double enter = 0, leave = 1;
    if (way[axis] != 0) {
      const double low = (at - start[axis]) / way[axis], high = (at + 1 - start[axis]) / way[axis];
      enter = std::clamp(std::min(low, high), 0.0, 1.0);
      leave = std::clamp(std::max(low, high), 0.0, 1.0);
    }
    const glm::dvec3 a = start + way * enter, b = start + way * leave;
    glm::ivec3 low(glm::floor(glm::min(a, b) - slack)), high(glm::floor(glm::max(a, b) + slack));
    low[axis] = high[axis] = at;
    for (int z = low.z; z <= high.z; ++z) {
      for (int y = low.y; y <= high.y; ++y) {
        for (int x = low.x; x <= high.x; ++x) {
          if (!opaque.contains({x, y, z})) continue;
          const glm::dvec3 corner(x, y, z);
          return glm::clamp(0.5 * (a + b), corner, corner + 1.0) * size;
        }
      }
    }
    if (at == last) return std::nullopt;
  }
}

}  // namespace sightline
