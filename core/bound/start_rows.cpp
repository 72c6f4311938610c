#include "core/bound/start_rows.h"

#include <algorithm>
#include <set>
#include <tuple>

#include "core/scene/contained.h"
#include "core/voxel/bin_triangles.h"
#include "core/voxel/voxel_space.h"

namespace sightline {
namespace {

struct RowsFirst {
  bool operator()(const glm::ivec3& a, const glm::ivec3& b) const {
    return std::tie(a.z, a.y, a.x) < std::tie(b.z, b.y, b.x);
  }
};
using Voxels = std::set<glm::ivec3, RowsFirst>;

// Adds the next voxel in the order of RowsFirst.
void append(std::vector<VoxelBox>& rows, const glm::ivec3& voxel) {
  const bool goes_on = !rows.empty() && rows.back().high == voxel - glm::ivec3(1, 0, 0);
  if (goes_on) {
    rows.back().high.x = voxel.x;
  } else {
    rows.push_back({voxel, voxel});
  }
}

bool mayMeet(const CellHull& hull, const glm::ivec3& voxel) {
  const glm::dvec3 low(voxel);
  return hull.mayMeet({low, low + 1.0});
}

// Of the cell's voxels those in which a triangle that stops rays and meets the cell has a part.
Voxels crossedVoxels(const BoundScene& scene, const ViewCell& cell, const CellHull& hull) {
  Voxels crossed;
  const VoxelBox box = voxelsOf(hull.box());
  const double voxels_a_unit = std::ldexp(1.0, -scene.all.lattice.exponent);
  for (const uint32_t id : containedTriangles(scene.scene, cell)) {
    if ((scene.scene.surfaceOf(id) & kPassable) != 0) continue;
    TriangleRows rows(inVoxels(scene.scene.corners(id), voxels_a_unit));
    rows.visit(box, [&](int y, int z, int first, int last) {
      for (int x = first; x <= last; ++x) {
        if (mayMeet(hull, {x, y, z})) crossed.insert({x, y, z});
      }
    });
  }
  return crossed;
}

// Adds the cell's voxels with triangles that hang together with these by faces, edges and corners: part of
// the cell may reach from a triangle that meets it through them only.
void spread(Voxels& crossed, const CellHull& hull, const VoxelLookup& walls) {
  const VoxelBox box = voxelsOf(hull.box());
  std::vector<glm::ivec3> left(crossed.begin(), crossed.end());
  while (!left.empty()) {
    const glm::ivec3 voxel = left.back();
    left.pop_back();
    for (int i = 0; i < 27; ++i) {
      const glm::ivec3 next = voxel + glm::ivec3(i % 3, i / 3 % 3, i / 9) - 1;
      if (!holds(box, next) || !walls.contains(next) || !mayMeet(hull, next)) continue;
      if (crossed.insert(next).second) left.push_back(next);
    }
  }
}

}  // namespace

std::vector<VoxelBox> startRows(const BoundScene& scene, const ViewCell& cell, const CellHull& hull,
                                const VoxelBox& region) {
  std::vector<VoxelBox> rows;
  const VoxelLookup walls(scene.walls());
  const VoxelBox box = voxelsOf(hull.box());
  for (int z = box.low.z; z <= box.high.z; ++z) {
    for (int y = box.low.y; y <= box.high.y; ++y) {
      for (int x = box.low.x; x <= box.high.x; ++x) {
        if (mayMeet(hull, {x, y, z}) && !walls.contains({x, y, z})) append(rows, {x, y, z});
      }
    }
  }
  if (rows.empty()) return rows;
  Voxels crossed = crossedVoxels(scene, cell, hull);
  spread(crossed, hull, walls);
  Voxels beside;
  for (const glm::ivec3& voxel : crossed) {
    for (int side = 0; side < 6; ++side) {
      glm::ivec3 next = voxel;
      next[side / 2] += (side & 1) != 0 ? 1 : -1;
      if (holds(region, next) && !walls.contains(next)) beside.insert(next);
    }
  }
  for (const glm::ivec3& voxel : beside) append(rows, voxel);
  return rows;
}

}  // namespace sightline
