#pragma once
#include <glm/glm.hpp>

namespace sightline {

/// Calls add(corner) for the corners of the part of a convex polygon with sign * coordinate >= sign * plane,
/// in order. Points on the plane get exactly the plane's coordinate, so that a piece cut at a box's face lies
/// in the box. Based on: I. Sutherland, G. Hodgman, Reentrant Polygon Clipping, 1974.
template <typename Add>
void clipPolygon(const glm::dvec3* corners, size_t count, int axis, double plane, double sign, Add&& add) {
  for (size_t i = 0; i < count; ++i) {
    const glm::dvec3 &p = corners[i], &q = corners[(i + 1) % count];
    const double from = sign * (p[axis] - plane), to = sign * (q[axis] - plane);
    if (from >= 0) add(p);
    if ((from > 0 && to < 0) || (from < 0 && to > 0)) {
      glm::dvec3 crossing = p + (q - p) * (from / (from - to));
      crossing[axis] = plane;
      add(crossing);
    }
  }
}

}  // namespace sightline
