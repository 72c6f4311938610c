// Based on: G. H. Meisters, Polygons Have Ears, 1975, in the plane that Newell's normal (M. E. Newell, see
// I. E. Sutherland, R. F. Sproull, R. A. Schumacker, A Characterization of Ten Hidden-Surface Algorithms,
// 1974) is nearest to. Differences from the textbook: where rounding or crossing edges leave no ear, a
// corner is cut all the same, so that the number of triangles is always n - 2.
#include "core/formats/triangulate.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace sightline {
namespace {

glm::dvec3 newellNormal(std::span<const glm::vec3> corners) {
  glm::dvec3 normal(0.0);
  const glm::dvec3 origin(corners[0]);  // keeps the products small far from the world's origin
  for (size_t i = 0; i < corners.size(); ++i) {
    const glm::dvec3 a = glm::dvec3(corners[i]) - origin;
    const glm::dvec3 b = glm::dvec3(corners[(i + 1) % corners.size()]) - origin;
    normal += glm::cross(a, b);
  }
  return normal;
}

/// The corners in the coordinate plane that the normal is nearest to, counter-clockwise.
std::vector<glm::dvec2> projected(std::span<const glm::vec3> corners, const glm::dvec3& normal) {
  const glm::dvec3 size = glm::abs(normal);
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
  const int u = normal[axis] >= 0.0 ? (axis + 1) % 3 : (axis + 2) % 3;
  const int v = normal[axis] >= 0.0 ? (axis + 2) % 3 : (axis + 1) % 3;
  std::vector<glm::dvec2> points;
  points.reserve(corners.size());
  for (const glm::vec3& corner : corners) points.emplace_back(corner[u], corner[v]);
  return points;
}

/// Twice the signed area of a, b, c: positive if they turn left.
double turn(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Whether all corners turn left and the outline goes around once (a star turns left more than once).
bool isConvex(const std::vector<glm::dvec2>& points) {
  const size_t n = points.size();
  for (size_t i = 0; i < n; ++i) {
    if (turn(points[i], points[(i + 1) % n], points[(i + 2) % n]) < 0.0) return false;
    if (i != 0 && turn(points[0], points[i], points[(i + 1) % n]) < 0.0) return false;
  }
  return true;
}

void appendFan(size_t n, std::vector<glm::uvec3>& triangles) {
  for (uint32_t i = 1; i + 1 < n; ++i) triangles.emplace_back(0, i, i + 1);
}

/// Cuts ears off the outline; `ring` holds the corners that are left. That takes a few n * n tests of a
/// corner against an ear, since what was found to lie in a corner's triangle is tried first the next time;
/// outlines made to spoil that come near n * n * n.
class EarClipper {
 public:
  EarClipper(const std::vector<glm::dvec2>& points, uint64_t& tests_left)
      : points_(points), ring_(points.size()), inside_(points.size(), kNothing), tests_left_(tests_left) {
    std::iota(ring_.begin(), ring_.end(), 0u);
  }

  /// False if it takes too long.
  bool run(std::vector<glm::uvec3>& triangles) {
    size_t candidate = 1;
    while (ring_.size() > 3) {
      const size_t ear = findEar(candidate % ring_.size());
      triangles.emplace_back(before(ear), ring_[ear], after(ear));
      inside_[ring_[ear]] = kGone;
      ring_.erase(ring_.begin() + std::ptrdiff_t(ear));
      candidate = ear;
      if (tests_left_ == 0) return false;
    }
    triangles.emplace_back(ring_[0], ring_[1], ring_[2]);
    return true;
  }

 private:
  uint32_t before(size_t i) const { return ring_[(i + ring_.size() - 1) % ring_.size()]; }
  uint32_t after(size_t i) const { return ring_[(i + 1) % ring_.size()]; }

  size_t findEar(size_t start) {
    const size_t n = ring_.size();
    size_t convex = n;
    for (size_t step = 0; step < n; ++step) {
      const size_t i = (start + step) % n;
      countTest();
      if (turn(points_[before(i)], points_[ring_[i]], points_[after(i)]) <= 0.0) continue;
      if (isEmpty(i)) return i;
      if (convex == n) convex = i;
    }
    return convex == n ? start : convex;
  }

  /// No other corner lies in the triangle at corner i. Corners at the very places of its own do not count:
  /// outlines with holes pass through the same point twice.
  bool isEmpty(size_t i) {
    const glm::dvec2& a = points_[before(i)];
    const glm::dvec2& b = points_[ring_[i]];
    const glm::dvec2& c = points_[after(i)];
    const auto lies_inside = [&](uint32_t other) {
      countTest();
      const glm::dvec2& p = points_[other];
      if (p == a || p == b || p == c) return false;
      return turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0;
    };
    uint32_t& known = inside_[ring_[i]];
    if (known != kNothing && inside_[known] != kGone && lies_inside(known)) return false;
    const auto found = std::find_if(ring_.begin(), ring_.end(), lies_inside);
    known = found == ring_.end() ? kNothing : *found;
    return found == ring_.end();
  }

  void countTest() { tests_left_ -= tests_left_ == 0 ? 0 : 1; }

  static constexpr uint32_t kNothing = 0xffffffff;
  static constexpr uint32_t kGone = 0xfffffffe;
  const std::vector<glm::dvec2>& points_;
  std::vector<uint32_t> ring_;
  std::vector<uint32_t> inside_;  ///< by corner: another that lay in its triangle when last tested, kNothing,
                                  ///< or kGone if it was cut off
  uint64_t& tests_left_;
};

}  // namespace

bool triangulate(std::span<const glm::vec3> corners, std::vector<glm::uvec3>& triangles,
                 uint64_t& tests_left) {
  if (corners.size() == 3) {
    triangles.emplace_back(0, 1, 2);
    return true;
  }
  const glm::dvec3 normal = newellNormal(corners);
  if (normal == glm::dvec3(0.0)) {
    appendFan(corners.size(), triangles);
    return true;
  }
  const std::vector<glm::dvec2> points = projected(corners, normal);
  if (isConvex(points)) {
    appendFan(corners.size(), triangles);
    return true;
  }
  if (corners.size() > kMaxConcaveCorners) return false;
  const size_t before = triangles.size();
  if (EarClipper(points, tests_left).run(triangles)) return true;
  triangles.resize(before);
  return false;
}

}  // namespace sightline
