#pragma once
// What makes a set right, in one sentence: it holds the triangles that a ray from a point of the view cell,
// in a direction that the cell looks in, meets first, and those that meet the cell itself (a flat cell: with
// a part in front of it). Here that is decided by brute force in double, by code that shares nothing with the
// bakes but the cell's frame.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/cell/cell_frame.h"
#include "core/judge/judge.h"
#include "core/pvs/pvs_file.h"
#include "tests/support/random_triangles.h"

namespace sightline::definition_test {

using testing_support::Random;

/// A convex polygon in the cell's frame.
using Polygon = std::vector<glm::dvec3>;

/// Its part where sign * coordinate <= limit (Sutherland and Hodgman 1974).
inline Polygon clipped(const Polygon& polygon, int axis, double sign, double limit) {
  Polygon kept;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double over_a = sign * a[axis] - limit, over_b = sign * b[axis] - limit;
    if (over_a <= 0) kept.push_back(a);
    if ((over_a < 0 && over_b > 0) || (over_a > 0 && over_b < 0)) {
      kept.push_back(a + (b - a) * (over_a / (over_a - over_b)));
    }
  }
  return kept;
}

class Definition {
 public:
  Definition(const Scene& scene, const ViewCell& cell)
      : scene_(scene),
        cell_(cell),
        frame_(cellFrame(cell)),
        bvh_(buildBvh(scene.positions, scene.triangles, {})),
        judge_(scene_, bvh_) {
    for (uint32_t id = 0; id < scene.triangles.size(); ++id) {
      Polygon corners;
      for (int c = 0; c < 3; ++c) corners.push_back(frame_.toLocal(corner(id, c)));
      corners_.push_back(corners);
    }
    double reach = maxAbs(frame_.center) + glm::length(frame_.half_size);
    for (const glm::vec3& p : scene.positions) reach = std::max(reach, maxAbs(glm::dvec3(p)));
    rounding_ = reach * 0x1p-20;
  }

  /// All that is wrong with the set, a line each. rays: random ones of the bake; tries: segments from the
  /// cell to each triangle.
  std::vector<std::string> faults(const CellPvs& pvs, uint64_t rays, uint32_t tries, Random& random) const {
    std::vector<std::string> lines;
    std::vector<int64_t> place(scene_.triangles.size(), -1);
    for (size_t i = 0; i < pvs.triangles.size(); ++i) {
      if (pvs.triangles[i] >= place.size()) {
        lines.push_back(fmt::format("id {} is no triangle", pvs.triangles[i]));
      } else {
        place[pvs.triangles[i]] = int64_t(i);
      }
    }
    for (uint32_t id = 0; id < place.size(); ++id) {
      const Sight sight = sightOf(id, tries, random);
      if (place[id] < 0) {
        const double expected = sight.random_share * double(rays);
        if (expected >= kMustBeFound)
          lines.push_back(fmt::format("{} is missing: {:.0f} rays", id, expected));
        if (meetsCell(id, -2 * rounding_))
          lines.push_back(fmt::format("{} is missing: it meets the cell", id));
        continue;
      }
      const std::string fault = faultOf(id, pvs.witnesses[size_t(place[id])], sight.seen);
      if (!fault.empty()) lines.push_back(fmt::format("{}: {}", id, fault));
    }
    return lines;
  }

  /// Whether nothing of the triangle is in front of a flat cell by more than rounding.
  bool behind(uint32_t id) const {
    return std::all_of(corners_[id].begin(), corners_[id].end(),
                       [&](const glm::dvec3& c) { return c.z <= rounding_; });
  }

 private:
  /// A triangle that so many of a bake's random rays are expected to meet may not be missing: of independent
  /// rays, all would pass it once in 10^17 times.
  static constexpr double kMustBeFound = 40;

  /// How a triangle is seen from the cell.
  struct Sight {
    bool seen = false;  ///< by some segment
    double random_share =
        0;  ///< of random rays (uniform over the surface and the hemisphere there) that meet it
  };

  struct SurfacePoint {
    glm::dvec3 place, normal;
  };

  glm::dvec3 corner(uint32_t id, int c) const {
    return glm::dvec3(scene_.positions[scene_.triangles[id][c]]);
  }

  /// What is wrong with a triangle of the set, or nothing.
  std::string faultOf(uint32_t id, const Witness& witness, bool seen) const {
    if (cell_.flat() && behind(id)) return "lies behind the cell";
    if (witness.stage == kStageContained) return meetsCell(id, rounding_) ? "" : "does not meet the cell";
    const glm::dvec3 from = frame_.toLocal(glm::dvec3(witness.origin));
    for (int axis = 0; axis < 3; ++axis) {
      if (std::abs(from[axis]) > frame_.half_size[axis] + rounding_) return "its ray begins outside the cell";
    }
    if (cell_.flat() && glm::dot(frame_.axes[2], glm::dvec3(witness.direction)) <= 0) {
      return "its ray runs where the cell does not look";
    }
    const JudgeRay ray{glm::dvec3(witness.origin), glm::dvec3(witness.direction)};
    if (judge_.nearest(ray).contains(id)) return "";
    if (!seen) return "nothing sees it, nor does its ray meet it first";
    const std::vector<uint32_t> beside = judge_.near(ray, rounding_, HUGE_VAL);
    return std::binary_search(beside.begin(), beside.end(), id) ? "" : "its ray passes far from it";
  }

  /// Whether the triangle meets the cell grown by `margin` on all sides, and has a part in front of a flat
  /// one.
  bool meetsCell(uint32_t id, double margin) const {
    Polygon polygon = corners_[id];
    for (int axis = 0; axis < 3; ++axis) {
      const double limit =
          frame_.half_size[axis] + (frame_.half_size[axis] > 0 ? margin : std::max(margin, 0.0));
      polygon = clipped(clipped(polygon, axis, 1, limit), axis, -1, limit);
    }
    const auto in_front = [&](const glm::dvec3& c) { return c.z > (margin < 0 ? rounding_ : 0); };
    return !polygon.empty() &&
           (!cell_.flat() || std::any_of(corners_[id].begin(), corners_[id].end(), in_front));
  }

  /// By random segments from the cell's surface to the triangle.
  Sight sightOf(uint32_t id, uint32_t tries, Random& random) const {
    const Polygon& t = corners_[id];
    const glm::dvec3 twice_area = glm::cross(t[1] - t[0], t[2] - t[0]);
    Sight sight;
    for (uint32_t i = 0; i < tries; ++i) {
      double u = random.unit(), v = random.unit();
      if (u + v > 1) u = 1 - u, v = 1 - v;
      const glm::dvec3 target = t[0] + (t[1] - t[0]) * u + (t[2] - t[0]) * v;
      const SurfacePoint from = surfacePoint(random);
      const glm::dvec3 way = target - from.place;
      if ((cell_.flat() && way.z <= 0) || !isFirst(id, from.place, way)) continue;
      sight.seen = true;
      if (glm::dot(way, from.normal) <= 0) continue;
      // Its solid angle as a share of the hemisphere, 2 pi.
      const double distance = glm::length(way);
      sight.random_share += 0.5 * std::abs(glm::dot(twice_area, way)) /
                            (distance * distance * distance * 6.283185307179586 * tries);
    }
    return sight;
  }

  /// Uniform over the faces; of a flat cell the side that looks.
  SurfacePoint surfacePoint(Random& random) const {
    SurfacePoint point;
    const glm::dvec3& size = cell_.size;
    const double areas[3] = {size.y * size.z, size.z * size.x, size.x * size.y};
    double left = double(random.unit()) * (areas[0] + areas[1] + areas[2]);
    int axis = 0;
    for (; axis < 2 && left >= areas[axis]; ++axis) left -= areas[axis];
    for (int i = 0; i < 3; ++i) point.place[i] = (2 * double(random.unit()) - 1) * frame_.half_size[i];
    const double side = cell_.flat() || random.pick(2) == 0 ? 1 : -1;
    point.place[axis] = side * frame_.half_size[axis];
    point.normal = glm::dvec3(0);
    point.normal[axis] = side;
    return point;
  }

  bool isFirst(uint32_t id, const glm::dvec3& origin, const glm::dvec3& way) const {
    for (uint32_t other = 0; other < corners_.size(); ++other) {
      if (other != id && distanceTo(other, origin, way) < 1 - 1e-12) return false;
    }
    return true;
  }

  /// In units of the way; infinite where it misses (Moeller and Trumbore 1997).
  double distanceTo(uint32_t id, const glm::dvec3& origin, const glm::dvec3& way) const {
    const Polygon& t = corners_[id];
    const glm::dvec3 e1 = t[1] - t[0], e2 = t[2] - t[0], p = glm::cross(way, e2);
    const double det = glm::dot(e1, p);
    if (det == 0) return HUGE_VAL;
    const glm::dvec3 s = origin - t[0], q = glm::cross(s, e1);
    const double u = glm::dot(s, p) / det, v = glm::dot(way, q) / det, d = glm::dot(e2, q) / det;
    return u >= 0 && v >= 0 && u + v <= 1 && d > 0 ? d : HUGE_VAL;
  }

  Scene scene_;
  ViewCell cell_;
  CellFrame frame_;
  Bvh bvh_;
  Judge judge_;
  std::vector<Polygon> corners_;  ///< of each triangle, in the cell's frame
  double rounding_;               ///< what floats may be off: some steps of the largest coordinate
};

}  // namespace sightline::definition_test
