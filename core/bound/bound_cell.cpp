#include "core/bound/bound_cell.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "core/base/interrupted.h"
#include "core/bound/hide.h"
#include "core/bound/layer_search.h"
#include "core/bound/start_rows.h"
#include "core/voxel/bin_triangles.h"
#include "core/voxel/reach.h"

namespace sightline {
namespace {

constexpr uint32_t kTrianglesATime = 1u << 18;  // between two looks at `stop`

// The voxels around the scene and the cell, a segment between which leaves none of them.
VoxelBox regionOf(const BoundScene& scene, const CellHull& hull) {
  const Bounds bounds = sceneBounds(scene.scene);
  const Lattice& lattice = scene.all.lattice;
  return voxelsOf({glm::min(lattice.toVoxels(bounds.low), hull.box().low),
                   glm::max(lattice.toVoxels(bounds.high), hull.box().high)});
}

// The voxels of the region that are inner.
void copyInner(const VoxelSpace& space, const VoxelBox& region, const glm::ivec3& place,
               BlockedSpace& inner) {
  const glm::ivec3 low = place * kBlockSide;
  const auto isWithin = [&](const glm::ivec3& from, int side) {
    return holds(region, from) && holds(region, from + (side - 1));
  };
  const Share share = space.innerInBlock(place);
  if (share == Share::kNone) return;
  if (share == Share::kAll && isWithin(low, kBlockSide)) return inner.set(place, share);
  OpenBlock open;
  open.assign({});
  for (int i = 0; i < 512; ++i) {
    const glm::ivec3 brick = 8 * glm::ivec3(i & 7, (i >> 3) & 7, i >> 6);
    const Share of_brick = space.innerIn(low + brick, 3);
    if (of_brick == Share::kNone) continue;
    if (of_brick == Share::kAll && isWithin(low + brick, kBrickSide)) {
      open.insert(brick, kBrickSide);
      continue;
    }
    for (int k = 0; k < 512; ++k) {
      const glm::ivec3 at = brick + glm::ivec3(k & 7, (k >> 3) & 7, k >> 6);
      if (space.innerIn(low + at, 0) == Share::kAll && isWithin(low + at, 1)) open.insert(at, 1);
    }
  }
  inner.set(place, Share::kSome, open.packed());
}

BlockedSpace innerOf(const BoundScene& scene, const ViewCell& cell, const CellHull& hull,
                     const VoxelBox& region, const std::atomic<bool>* stop) {
  BlockedSpace inner({region.low >> 6, region.high >> 6});
  const VoxelGrid& walls = scene.walls();
  if (walls.blocks.empty()) return inner;
  ReachOptions options;
  options.boxes = startRows(scene, cell, hull, region);
  options.within = region;
  options.stop = stop;
  if (options.boxes.empty()) return inner;
  const VoxelSpace space = reach(walls, options);
  const VoxelBox blocks = inner.blocks();
  for (int z = blocks.low.z; z <= blocks.high.z; ++z) {
    for (int y = blocks.low.y; y <= blocks.high.y; ++y) {
      for (int x = blocks.low.x; x <= blocks.high.x; ++x) copyInner(space, region, {x, y, z}, inner);
    }
  }
  return inner;
}

// A triangle's part in a voxel, up to rounding: a box around it.
RealBox partIn(const std::array<glm::dvec3, 3>& corners, const glm::ivec3& voxel) {
  std::array<glm::dvec3, 9> polygon, kept;
  std::copy(corners.begin(), corners.end(), polygon.begin());
  size_t count = 3;
  for (int side = 0; side < 6 && count > 0; ++side) {  // Sutherland and Hodgman 1974
    const int axis = side / 2;
    const double sign = (side & 1) != 0 ? 1 : -1, limit = voxel[axis] + (side & 1);
    size_t next = 0;
    for (size_t i = 0; i < count; ++i) {
      const glm::dvec3 &a = polygon[i], &b = polygon[(i + 1) % count];
      const double over_a = sign * (a[axis] - limit), over_b = sign * (b[axis] - limit);
      if (over_a <= 0) kept[next++] = a;
      if ((over_a < 0 && over_b > 0) || (over_a > 0 && over_b < 0))
        kept[next++] = a + (b - a) * (over_a / (over_a - over_b));
    }
    polygon = kept;
    count = next;
  }
  const glm::dvec3 low(voxel), high = low + 1.0;
  RealBox box{glm::min(glm::min(corners[0], corners[1]), corners[2]),
              glm::max(glm::max(corners[0], corners[1]), corners[2])};
  if (count > 0) {
    // Each cut may be off by some roundings of the corners.
    const glm::dvec3 slack = glm::max(glm::abs(box.low), glm::abs(box.high)) * 0x1p-46;
    RealBox part{polygon[0], polygon[0]};
    for (size_t i = 1; i < count; ++i) {
      part.low = glm::min(part.low, polygon[i]);
      part.high = glm::max(part.high, polygon[i]);
    }
    box = {glm::max(box.low, part.low - slack), glm::min(box.high, part.high + slack)};
  }
  return {glm::max(low, box.low), glm::min(high, box.high)};
}

// Whether the triangle has a point in a voxel that is not blocked, such that its part there is not hidden
// either.
bool mayBeSeen(const std::array<glm::dvec3, 3>& corners, BlockedView& view, LayerSearch& search) {
  TriangleRows rows(corners);
  bool is_open = false;
  rows.visit(rows.box(), [&](int y, int z, int first, int last) {
    for (int x = first; x <= last && !is_open;) {
      const BlockedView::Cube cube = view.cubeAt({x, y, z});
      if (!cube.blocked) {
        is_open = !search.hides(partIn(corners, {x, y, z}));
        ++x;
      } else {
        x = (x & -cube.side) + cube.side;
      }
    }
  });
  return is_open;
}

}  // namespace

BlockedSpace innerVoxels(const BoundScene& scene, const ViewCell& cell, const std::atomic<bool>* stop) {
  const CellHull hull(cell, scene.all.lattice);
  return innerOf(scene, cell, hull, regionOf(scene, hull), stop);
}

CellBound boundCell(const BoundScene& scene, const ViewCell& cell, const BoundOptions& options) {
  return boundCell(scene, cell, innerVoxels(scene, cell, options.stop), options);
}

CellBound boundCell(const BoundScene& scene, const ViewCell& cell, BlockedSpace&& blocked,
                    const BoundOptions& options) {
  const CellHull hull(cell, scene.all.lattice);
  HideOptions hide_options;
  hide_options.region = regionOf(scene, hull);
  hide_options.free_side = options.free_side;
  hide_options.surface_side = options.surface_side;
  hide_options.part_size = options.part_size;
  hide_options.progress = options.progress;
  hide_options.stop = options.stop;
  CellBound result;
  result.opaque_voxels = blocked.count();
  hide(hull, scene.all, hide_options, blocked);
  result.hidden_voxels = blocked.count() - result.opaque_voxels;

  const uint32_t count = scene.scene.triangleCount();
  std::vector<uint8_t> is_open(count, 0);
  const double voxels_a_unit = std::ldexp(1.0, -scene.all.lattice.exponent);
  for (uint32_t begin = 0; begin < count;) {
    if (options.stop != nullptr && *options.stop) throw Interrupted();
    const uint32_t end = begin + std::min(count - begin, kTrianglesATime);
    tbb::parallel_for(tbb::blocked_range<uint32_t>(begin, end, 1024), [&](const auto& range) {
      BlockedView view(blocked);
      LayerSearch search(hull, options.triangle_part_size, hide_options.region, view);
      scene.scene.visitTriangles(range.begin(), range.end(),
                                 [&](uint32_t id, const std::array<glm::vec3, 3>& corners) {
                                   is_open[id] = mayBeSeen(inVoxels(corners, voxels_a_unit), view, search);
                                 });
    });
    begin = end;
  }
  for (uint32_t id = 0; id < count; ++id) {
    if (is_open[id] != 0) result.triangles.push_back(id);
  }
  return result;
}

}  // namespace sightline
