#include "core/voxel/voxel_attributes.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "bvh/clip_polygon.h"
#include "core/scene/object_of.h"
#include "core/voxel/bin_triangles.h"
#include "core/voxel/triangle_rows.h"

namespace sightline {
namespace {

// Normals that cancel out leave what rounding leaves of them: less than this share of the area.
constexpr double kCancelled = 0x1p-30;

/// A convex polygon in three dimensions. A triangle cut by six planes has at most nine corners, and some more
/// where rounding bends its sides.
struct Polygon {
  std::array<glm::dvec3, 16> corners;
  int count = 0;

  void add(const glm::dvec3& corner) {
    if (count < int(corners.size())) corners[size_t(count++)] = corner;
  }
};

// The part where sign * (p[axis] - at) >= 0.
Polygon cutBy(const Polygon& polygon, int axis, double at, double sign) {
  Polygon part;
  clipPolygon(polygon.corners.data(), size_t(polygon.count), axis, at, sign,
              [&](const glm::dvec3& corner) { part.add(corner); });
  return part;
}

// The part from `low` to `low` + 1 along an axis.
Polygon slabOf(const Polygon& polygon, int axis, int low) {
  double least = polygon.corners[0][axis], most = least;
  for (int i = 1; i < polygon.count; ++i) {
    least = std::min(least, polygon.corners[size_t(i)][axis]);
    most = std::max(most, polygon.corners[size_t(i)][axis]);
  }
  Polygon part = least < low ? cutBy(polygon, axis, low, 1) : polygon;
  return most > low + 1 && part.count > 0 ? cutBy(part, axis, low + 1, -1) : part;
}

// Twice the area, as a vector along the normal.
glm::dvec3 areaOf(const Polygon& polygon) {
  glm::dvec3 sum(0);
  for (int i = 2; i < polygon.count; ++i) {
    sum += glm::cross(polygon.corners[size_t(i - 1)] - polygon.corners[0],
                      polygon.corners[size_t(i)] - polygon.corners[0]);
  }
  return sum;
}

/// What a voxel has of the triangles so far. Objects come one after the other: their triangles are runs.
struct VoxelSum {
  glm::dvec3 normal{0.0};
  double area = 0;
  double object_area = 0, best_area = -1;
  uint32_t object = 0, best_object = 0;
  bool is_met = false;  ///< by `object`

  void add(const glm::dvec3& unit_normal, double more, uint32_t of_object) {
    if (of_object != object) finish();
    object = of_object;
    object_area += more;
    normal += unit_normal * more;
    area += more;
    is_met = true;
  }
  void finish() {
    if (is_met && object_area > best_area) {
      best_area = object_area;
      best_object = object;
    }
    object_area = 0;
    is_met = false;
  }
};

/// Gives each voxel of the block its part of a triangle, row by row: what rows have in common is cut once.
class TriangleParts {
 public:
  TriangleParts(const std::array<glm::dvec3, 3>& corners, const glm::ivec3& block_low) {
    whole_.count = 3;
    for (size_t i = 0; i < 3; ++i) whole_.corners[i] = corners[i] - glm::dvec3(block_low);
    const glm::dvec3 area = areaOf(whole_);
    const double length = std::sqrt(glm::dot(area, area));
    normal_ = length > 0 ? area / length : glm::dvec3(0);
  }
  const glm::dvec3& normal() const { return normal_; }

  /// The area in the voxel; rows come by z, then y.
  double areaIn(int x, int y, int z) {
    if (z != z_) layer_ = slabOf(whole_, 2, z);
    if (z != z_ || y != y_) row_ = layer_.count > 0 ? slabOf(layer_, 1, y) : layer_;
    z_ = z;
    y_ = y;
    if (row_.count == 0) return 0;
    return std::max(0.0, glm::dot(areaOf(slabOf(row_, 0, x)), normal_) / 2);
  }

 private:
  Polygon whole_, layer_, row_;
  glm::dvec3 normal_{0.0};
  int y_ = -1, z_ = -1;
};

}  // namespace

VoxelRanks::VoxelRanks(const VoxelBlock& block) : block_(block) {
  brick_at_.fill(-1);
  first_.reserve(block.bricks.size() * 8);
  uint32_t rank = 0;
  for (size_t i = 0; i < block.bricks.size(); ++i) {
    brick_at_[block.bricks[i].place] = int16_t(i);
    for (const uint64_t word : block.bricks[i].bits) {
      first_.push_back(rank);
      rank += uint32_t(std::popcount(word));
    }
  }
}

uint32_t VoxelRanks::of(int x, int y, int z) const {
  const auto brick = size_t(brick_at_[size_t((x >> 3) + 8 * (y >> 3) + 64 * (z >> 3))]);
  const uint64_t word = block_.bricks[brick].bits[size_t(z & 7)];
  const uint64_t before = (uint64_t{1} << ((x & 7) + 8 * (y & 7))) - 1;
  return first_[8 * brick + size_t(z & 7)] + uint32_t(std::popcount(word & before));
}

uint32_t packNormal(const glm::dvec3& direction) {
  const double length = std::sqrt(glm::dot(direction, direction));
  if (!(length > 0)) return 0;
  uint32_t packed = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto steps = int32_t(std::floor(direction[axis] / length * 511 + 0.5));
    packed |= (uint32_t(steps) & 0x3ff) << (10 * axis);
  }
  return packed;
}

glm::dvec3 unpackNormal(uint32_t packed) {
  glm::dvec3 direction;
  for (int axis = 0; axis < 3; ++axis) {
    const auto steps = int32_t((packed >> (10 * axis)) & 0x3ff);
    direction[axis] = double(steps < 512 ? steps : steps - 1024) / 511;
  }
  return direction;
}

void addAttributes(const Scene& scene, std::span<const uint32_t> triangles, WantedAttributes wanted,
                   const Lattice& lattice, VoxelBlock& block) {
  if (!wanted.normals && !wanted.objects) return;
  const VoxelRanks ranks(block);
  BlockBits bits;
  bits.insert(block.bricks);
  std::vector<VoxelSum> sums(block.count());
  const glm::ivec3 low = block.place * kBlockSide;
  const double voxels_a_unit = std::ldexp(1.0, -lattice.exponent);
  for (const uint32_t id : triangles) {
    const auto corners = inVoxels(scene.corners(id), voxels_a_unit);
    const uint32_t object = objectOf(scene, id);
    TriangleParts parts(corners, low);
    TriangleRows(corners).visit({low, low + (kBlockSide - 1)}, [&](int y, int z, int first, int last) {
      y -= low.y;
      z -= low.z;
      uint64_t row = bits.row(y, z) & rowBits(first - low.x, last - low.x);
      for (; row != 0; row &= row - 1) {
        const int x = std::countr_zero(row);
        sums[ranks.of(x, y, z)].add(parts.normal(), parts.areaIn(x, y, z), object);
      }
    });
  }
  if (wanted.normals) block.normals.reserve(sums.size());
  if (wanted.objects) block.objects.reserve(sums.size());
  for (VoxelSum& sum : sums) {
    sum.finish();
    const bool cancels =
        glm::dot(sum.normal, sum.normal) <= (kCancelled * sum.area) * (kCancelled * sum.area);
    if (wanted.normals) block.normals.push_back(cancels ? 0 : packNormal(sum.normal));
    if (wanted.objects) block.objects.push_back(sum.best_object);
  }
}

}  // namespace sightline
