#pragma once
// What is seen from a cell, by exact rays, against a bound: what makes that one right. Every triangle that an
// exact ray from the cell meets first is in it, or the ray passed an opaque voxel before: a leak.
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "core/bound/bound_cell.h"
#include "core/bound/leak.h"
#include "core/cell/cell_frame.h"
#include "core/judge/judge.h"
#include "tests/support/random_triangles.h"

namespace sightline::bound_test {

using testing_support::Random;

struct Sightings {
  std::vector<std::string> faults;  ///< seen, not in the bound, and no leak
  uint64_t leaks = 0;               ///< rays that meet such a triangle by a leak
  uint64_t seen = 0;                ///< rays that meet a triangle of the bound
};

class Onlooker {
 public:
  explicit Onlooker(const Scene& scene)
      : scene_(scene), bvh_(buildBvh(scene.positions, scene.triangles, {})), judge_(scene_, bvh_) {}

  /// By so many rays from anywhere in the cell to anywhere on each triangle.
  Sightings look(const BoundScene& voxels, const ViewCell& cell, const std::vector<uint32_t>& bound,
                 int tries, Random& random) const {
    const BlockedSpace opaque = innerVoxels(voxels, cell);
    const CellFrame frame = cellFrame(cell);
    Sightings sightings;
    for (uint32_t target = 0; target < scene_.triangleCount(); ++target) {
      for (int i = 0; i < tries; ++i) {
        const JudgeRay ray = rayTo(target, frame, random);
        if (cell.flat() && glm::dot(frame.axes[2], ray.direction) <= 0) continue;
        const ExactHit hit = judge_.nearest(ray);
        for (const uint32_t id : hit.triangles) {
          if (std::binary_search(bound.begin(), bound.end(), id)) {
            ++sightings.seen;
          } else if (opaquePlace(ray.origin, ray.origin + ray.direction * hit.t.high, voxels.all.lattice,
                                 opaque)) {
            ++sightings.leaks;
          } else {
            sightings.faults.push_back(
                fmt::format("{} is seen from ({}, {}, {})", id, ray.origin.x, ray.origin.y, ray.origin.z));
          }
        }
      }
    }
    return sightings;
  }

 private:
  JudgeRay rayTo(uint32_t target, const CellFrame& frame, Random& random) const {
    glm::dvec3 local;
    for (int axis = 0; axis < 3; ++axis)
      local[axis] = (2 * double(random.unit()) - 1) * frame.half_size[axis];
    if (random.pick(2) == 0) {  // what a cell sees alone, it often sees from its edges and corners
      for (int axis = 0; axis < 3; ++axis) {
        const uint32_t side = random.pick(3);
        if (side < 2) local[axis] = side == 0 ? -frame.half_size[axis] : frame.half_size[axis];
      }
    }
    double u = random.unit(), v = random.unit();
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const auto corners = scene_.corners(target);
    const glm::dvec3 a(corners[0]), b(corners[1]), c(corners[2]);
    const glm::dvec3 origin = frame.toWorld(local);
    return {origin, a + (b - a) * u + (c - a) * v - origin};
  }

  Scene scene_;
  Bvh bvh_;
  Judge judge_;
};

}  // namespace sightline::bound_test
