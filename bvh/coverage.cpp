#include "bvh/coverage.h"

#include <algorithm>

#include "bvh/clip_polygon.h"

namespace sightline {

namespace {

using Polygon = std::vector<glm::dvec3>;

/// As clipPolygon.
Polygon clip(const Polygon& polygon, int axis, double plane, double sign) {
  Polygon result;
  clipPolygon(polygon.data(), polygon.size(), axis, plane, sign,
              [&](const glm::dvec3& corner) { result.push_back(corner); });
  return result;
}

/// Whether any point lies strictly on the side sign * coordinate > sign * plane.
bool reaches(const Polygon& polygon, int axis, double plane, double sign) {
  return std::any_of(polygon.begin(), polygon.end(),
                     [&](const glm::dvec3& p) { return sign * p[axis] > sign * plane; });
}

/// Adds what is left of a polygon outside a box to `outside`, in at most six convex pieces.
void subtract(Polygon polygon, const CoverageBox& box, std::vector<Polygon>& outside) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      const double plane = sign < 0 ? box.low[axis] : box.high[axis];
      if (!reaches(polygon, axis, plane, sign)) continue;
      outside.push_back(clip(polygon, axis, plane, sign));
      polygon = clip(polygon, axis, plane, -sign);
      if (polygon.empty()) return;
    }
  }
}

}  // namespace

void CoverageCheck::add(uint32_t id, const CoverageBox& box) {
  const glm::uvec3 t = triangles_[id];
  bool whole = true;
  for (int i = 0; i < 3; ++i) {
    const glm::vec3 p = positions_[t[i]];
    whole = whole && glm::all(glm::lessThanEqual(box.low, p)) && glm::all(glm::lessThanEqual(p, box.high));
  }
  if (whole) {
    covered_[id] = true;
  } else {
    parts_.push_back({id, box});
  }
}

std::string CoverageCheck::finish() {
  std::stable_sort(parts_.begin(), parts_.end(), [](const Part& a, const Part& b) { return a.id < b.id; });
  for (size_t i = 0; i < parts_.size();) {
    size_t end = i;
    while (end < parts_.size() && parts_[end].id == parts_[i].id) ++end;
    const uint32_t id = parts_[i].id;
    if (!covered_[id] && !coversTriangle(id, std::span(parts_).subspan(i, end - i))) {
      return "triangle " + std::to_string(id) + " is not covered by the boxes of its leaves";
    }
    covered_[id] = true;
    i = end;
  }
  const auto missing = std::find(covered_.begin(), covered_.end(), false);
  if (missing == covered_.end()) return "";
  return "triangle " + std::to_string(missing - covered_.begin()) + " is in no leaf";
}

bool CoverageCheck::coversTriangle(uint32_t id, std::span<const Part> parts) const {
  Polygon triangle;
  for (int i = 0; i < 3; ++i) triangle.emplace_back(positions_[triangles_[id][i]]);
  std::vector<Polygon> open{triangle};
  for (const Part& part : parts) {
    std::vector<Polygon> left;
    for (const Polygon& polygon : open) subtract(polygon, part.box, left);
    open = std::move(left);
    if (open.empty()) return true;
  }
  return open.empty();
}

}  // namespace sightline
