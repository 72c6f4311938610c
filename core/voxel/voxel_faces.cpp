#include "core/voxel/voxel_faces.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>

#include "core/base/error.h"

namespace sightline {
namespace {

constexpr int kMostExactPlace = 1 << 24;  // whole numbers that floats hold

/// Sides of a block's voxels that cross an axis at one place of it: word v, bit u, along the axes that it
/// does not cross, ascending.
using Layer = std::array<uint64_t, kBlockSide>;

/// A block's bits, and those of the six beside it at the sides that they share.
class BlockSides {
 public:
  BlockSides(const VoxelLookup& lookup, const VoxelBlock& block) {
    own_.insert(block.bricks);
    for (int axis = 0; axis < 3; ++axis) {
      for (int high = 0; high < 2; ++high) {
        glm::ivec3 place = block.place;
        place[axis] += high != 0 ? 1 : -1;
        const VoxelBlock* beside = lookup.block(place);
        BlockBits& bits = beside_[2 * axis + high];
        if (beside != nullptr) bits.insert(beside->bricks);
      }
    }
  }

  /// The sides that face down or up each layer of the axis.
  std::vector<Layer> open(int axis, bool high) const {
    std::vector<Layer> layers(kBlockSide, Layer{});
    const BlockBits& beside = beside_[size_t(2 * axis + (high ? 1 : 0))];
    const int step = high ? 1 : -1, edge = high ? 0 : kBlockSide - 1;
    const auto isInside = [](int place) { return place >= 0 && place < kBlockSide; };
    for (int z = 0; z < kBlockSide; ++z) {
      for (int y = 0; y < kBlockSide; ++y) {
        const uint64_t row = own_.row(y, z);
        if (row == 0) continue;
        if (axis == 2) {
          layers[size_t(z)][size_t(y)] =
              row & ~(isInside(z + step) ? own_.row(y, z + step) : beside.row(y, edge));
        } else if (axis == 1) {
          layers[size_t(y)][size_t(z)] =
              row & ~(isInside(y + step) ? own_.row(y + step, z) : beside.row(edge, z));
        } else {
          const uint64_t carried = (beside.row(y, z) >> edge) & 1;
          const uint64_t after = high ? row >> 1 | carried << 63 : row << 1 | carried;
          for (uint64_t left = row & ~after; left != 0; left &= left - 1) {
            layers[size_t(std::countr_zero(left))][size_t(z)] |= uint64_t{1} << y;
          }
        }
      }
    }
    return layers;
  }

 private:
  BlockBits own_;
  std::array<BlockBits, 6> beside_;
};

/// Takes the rectangles out of a layer: the lowest row's first run, and the rows above that hold it whole.
template <typename Take>
void cutRectangles(Layer& layer, FaceMerging merging, Take&& take) {
  for (int v = 0; v < kBlockSide; ++v) {
    while (layer[size_t(v)] != 0) {
      const int low = std::countr_zero(layer[size_t(v)]);
      const int wide = merging == FaceMerging::kNone ? 1 : std::countr_one(layer[size_t(v)] >> low);
      const uint64_t run = rowBits(low, low + wide - 1);
      int end = v;
      while (end < kBlockSide && (layer[size_t(end)] & run) == run &&
             (end == v || merging != FaceMerging::kNone)) {
        layer[size_t(end++)] &= ~run;
      }
      take(glm::ivec2(low, v), glm::ivec2(wide, end - v));
    }
  }
}

/// Of the two axes that a face does not cross.
glm::ivec2 otherAxes(int axis) {
  return {axis == 0 ? 1 : 0, axis == 2 ? 1 : 2};
}

std::vector<VoxelFace> facesOfBlock(const VoxelLookup& lookup, const VoxelBlock& block, FaceMerging merging) {
  std::vector<VoxelFace> faces;
  const BlockSides sides(lookup, block);
  for (int axis = 0; axis < 3; ++axis) {
    const glm::ivec2 others = otherAxes(axis);
    for (const bool high : {false, true}) {
      std::vector<Layer> layers = sides.open(axis, high);
      for (int layer = 0; layer < kBlockSide; ++layer) {
        cutRectangles(layers[size_t(layer)], merging, [&](const glm::ivec2& low, const glm::ivec2& size) {
          VoxelFace face{block.place * kBlockSide, size, axis, high};
          face.low[axis] += layer + (high ? 1 : 0);
          face.low[others.x] += low.x;
          face.low[others.y] += low.y;
          faces.push_back(face);
        });
      }
    }
  }
  return faces;
}

/// Corners as numbers whose order is z, y, x: places along an axis are less than 2^21 above the lowest.
class CornerKeys {
 public:
  explicit CornerKeys(const VoxelGrid& grid) {
    low_ = grid.blocks.front().place;
    for (const VoxelBlock& block : grid.blocks) low_ = glm::min(low_, block.place);
    low_ *= kBlockSide;
  }
  uint64_t of(const glm::ivec3& corner) const {
    const glm::uvec3 place(corner - low_);
    return uint64_t(place.z) << 42 | uint64_t(place.y) << 21 | place.x;
  }
  glm::ivec3 at(uint64_t key) const {
    return low_ + glm::ivec3(int(key & 0x1fffff), int(key >> 21 & 0x1fffff), int(key >> 42));
  }

 private:
  glm::ivec3 low_{0};
};

}  // namespace

std::array<glm::ivec3, 4> VoxelFace::corners() const {
  const glm::ivec2 others = otherAxes(axis);
  glm::ivec3 u(0), v(0);
  u[others.x] = size.x;
  v[others.y] = size.y;
  // u x v points up the axis, but for y: x x z points down.
  if (high != (axis == 1)) return {low, low + u, low + u + v, low + v};
  return {low, low + v, low + u + v, low + u};
}

std::vector<VoxelFace> facesOf(const VoxelGrid& grid, FaceMerging merging) {
  const VoxelLookup lookup(grid);
  std::vector<std::vector<VoxelFace>> of_blocks(grid.blocks.size());
  tbb::parallel_for(size_t(0), grid.blocks.size(),
                    [&](size_t i) { of_blocks[i] = facesOfBlock(lookup, grid.blocks[i], merging); });
  std::vector<VoxelFace> faces;
  for (std::vector<VoxelFace>& some : of_blocks) {
    faces.insert(faces.end(), some.begin(), some.end());
    some = {};
  }
  return faces;
}

VoxelMesh voxelMesh(const VoxelGrid& grid, FaceMerging merging) {
  if (grid.blocks.empty()) throw Error("the set of voxels is empty: it has no faces");
  for (const VoxelBlock& block : grid.blocks) {
    const glm::ivec3 far = glm::max(glm::abs(block.place), glm::abs(block.place + 1)) * kBlockSide;
    if (std::max({far.x, far.y, far.z}) <= kMostExactPlace) continue;
    throw Error(
        fmt::format("voxels farther than {} from the origin have no exact corners in single precision: "
                    "take larger voxels",
                    kMostExactPlace));
  }
  const std::vector<VoxelFace> faces = facesOf(grid, merging);
  const CornerKeys keys(grid);
  std::vector<uint64_t> corners(4 * faces.size());
  tbb::parallel_for(size_t(0), faces.size(), [&](size_t i) {
    const auto its = faces[i].corners();
    for (size_t k = 0; k < 4; ++k) corners[4 * i + k] = keys.of(its[k]);
  });
  tbb::parallel_sort(corners);
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  VoxelMesh mesh;
  mesh.positions.resize(corners.size());
  const float size = std::ldexp(1.0f, grid.lattice.exponent);
  tbb::parallel_for(size_t(0), corners.size(),
                    [&](size_t i) { mesh.positions[i] = glm::vec3(keys.at(corners[i])) * size; });
  mesh.faces.resize(faces.size());
  tbb::parallel_for(size_t(0), faces.size(), [&](size_t i) {
    const auto its = faces[i].corners();
    for (int k = 0; k < 4; ++k) {
      mesh.faces[i][k] =
          uint32_t(std::ranges::lower_bound(corners, keys.of(its[size_t(k)])) - corners.begin());
    }
  });
  return mesh;
}

Scene voxelScene(const VoxelGrid& grid, FaceMerging merging) {
  VoxelMesh mesh = voxelMesh(grid, merging);
  if (mesh.faces.size() >= uint64_t(1) << 31) {
    throw Error(fmt::format("{} faces are too many for a scene: take a coarser level", mesh.faces.size()));
  }
  Scene scene;
  scene.positions = std::move(mesh.positions);
  scene.triangles.resize(2 * mesh.faces.size());
  tbb::parallel_for(size_t(0), mesh.faces.size(), [&](size_t i) {
    const glm::uvec4& f = mesh.faces[i];
    scene.triangles[2 * i] = {f.x, f.y, f.z};
    scene.triangles[2 * i + 1] = {f.x, f.z, f.w};
  });
  scene.objects.push_back({"voxels", 0, uint32_t(scene.triangles.size())});
  return scene;
}

}  // namespace sightline
