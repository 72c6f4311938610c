#include "core/bound/bound_cell.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>

#include "core/bound/hide.h"
#include "core/bound/layer_search.h"
#include "core/voxel/bin_triangles.h"
#include "core/voxel/reach.h"

namespace sightline {
namespace {

VoxelBox voxelsOf(const RealBox& box) {
  return {glm::ivec3(glm::floor(box.low)), glm::ivec3(glm::floor(box.high))};
}

// The voxels around the scene and the cell, a segment between which leaves none of them.
VoxelBox regionOf(const BoundScene& scene, const CellHull& hull) {
  const Bounds bounds = sceneBounds(scene.scene);
  const Lattice& lattice = scene.all.lattice;
  return voxelsOf({glm::min(lattice.toVoxels(bounds.low), hull.box().low),
                   glm::max(lattice.toVoxels(bounds.high), hull.box().high)});
}

// Rows of the voxels that the cell may meet and no triangle does.
std::vector<VoxelBox> freeRows(const CellHull& hull, const VoxelLookup& walls) {
  std::vector<VoxelBox> rows;
  const VoxelBox box = voxelsOf(hull.box());
  for (int z = box.low.z; z <= box.high.z; ++z) {
    for (int y = box.low.y; y <= box.high.y; ++y) {
      for (int x = box.low.x; x <= box.high.x; ++x) {
        const glm::dvec3 low(x, y, z);
        if (!hull.mayMeet({low, low + 1.0}) || walls.contains({x, y, z})) continue;
        const bool goes_on = !rows.empty() && rows.back().high == glm::ivec3(x - 1, y, z);
        if (goes_on) {
          rows.back().high.x = x;
        } else {
          rows.push_back({{x, y, z}, {x, y, z}});
        }
      }
    }
  }
  return rows;
}

BlockedSpace innerOf(const BoundScene& scene, const CellHull& hull, const VoxelBox& region,
                     const std::atomic<bool>* stop) {
  BlockedSpace inner({region.low >> 6, region.high >> 6});
  const VoxelGrid& walls = scene.walls();
  if (walls.blocks.empty()) return inner;
  ReachOptions options;
  options.boxes = freeRows(hull, VoxelLookup(walls));
  options.stop = stop;
  if (options.boxes.empty()) return inner;
  const VoxelSpace space = reach(walls, options);
  const VoxelBox blocks = inner.blocks();
  OpenBlock open;
  for (int z = blocks.low.z; z <= blocks.high.z; ++z) {
    for (int y = blocks.low.y; y <= blocks.high.y; ++y) {
      for (int x = blocks.low.x; x <= blocks.high.x; ++x) {
        const glm::ivec3 place(x, y, z), low = place * kBlockSide;
        const Share share = space.innerInBlock(place);
        if (share != Share::kSome) {
          inner.set(place, share);
          continue;
        }
        open.assign({});
        for (int i = 0; i < 512; ++i) {
          const glm::ivec3 brick = 8 * glm::ivec3(i & 7, (i >> 3) & 7, i >> 6);
          const Share of_brick = space.innerIn(low + brick, 3);
          if (of_brick == Share::kAll) open.insert(brick, 8);
          if (of_brick != Share::kSome) continue;
          for (int k = 0; k < 512; ++k) {
            const glm::ivec3 at = brick + glm::ivec3(k & 7, (k >> 3) & 7, k >> 6);
            if (space.innerIn(low + at, 0) == Share::kAll) open.insert(at, 1);
          }
        }
        inner.set(place, Share::kSome, open.packed());
      }
    }
  }
  return inner;
}

// Whether the triangle has a point in a voxel that is not blocked, such that its part there is not hidden
// either.
bool mayBeSeen(const std::array<glm::dvec3, 3>& corners, BlockedView& view, LayerSearch& search) {
  TriangleRows rows(corners);
  const RealBox around{glm::min(glm::min(corners[0], corners[1]), corners[2]),
                       glm::max(glm::max(corners[0], corners[1]), corners[2])};
  bool is_open = false;
  rows.visit(rows.box(), [&](int y, int z, int first, int last) {
    for (int x = first; x <= last && !is_open;) {
      const BlockedView::Cube cube = view.cubeAt({x, y, z});
      if (!cube.blocked) {
        const glm::dvec3 low(x, y, z);
        is_open = !search.hides({glm::max(low, around.low), glm::min(low + 1.0, around.high)});
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
  return innerOf(scene, hull, regionOf(scene, hull), stop);
}

CellBound boundCell(const BoundScene& scene, const ViewCell& cell, const BoundOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  const CellHull hull(cell, scene.all.lattice);
  const VoxelBox region = regionOf(scene, hull);
  CellBound result;
  BlockedSpace blocked = innerOf(scene, hull, region, options.stop);
  result.inner_voxels = blocked.count();
  HideOptions hide_options;
  hide_options.region = region;
  hide_options.free_side = options.free_side;
  hide_options.cuts = options.cuts;
  hide_options.least_side = options.least_side;
  hide_options.progress = options.progress;
  hide_options.stop = options.stop;
  hide(hull, scene.all, hide_options, blocked);
  result.hidden_voxels = blocked.count() - result.inner_voxels;

  const uint32_t count = scene.scene.triangleCount();
  std::vector<uint8_t> is_open(count, 0);
  const double voxels_a_unit = std::ldexp(1.0, -scene.all.lattice.exponent);
  tbb::parallel_for(tbb::blocked_range<uint32_t>(0, count, 4096), [&](const auto& range) {
    BlockedView view(blocked);
    LayerSearch search(hull, options.cuts, region, view);
    scene.scene.visitTriangles(range.begin(), range.end(),
                               [&](uint32_t id, const std::array<glm::vec3, 3>& corners) {
                                 is_open[id] = mayBeSeen(inVoxels(corners, voxels_a_unit), view, search);
                               });
  });
  for (uint32_t id = 0; id < count; ++id) {
    if (is_open[id] != 0) result.triangles.push_back(id);
  }
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace sightline
