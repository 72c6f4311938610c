#include "core/voxel/solid.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <tuple>

#include "core/base/interrupted.h"
#include "core/scene/object_of.h"
#include "core/voxel/bin_triangles.h"
#include "core/voxel/exact_sign.h"

namespace sightline {
namespace {

constexpr size_t kColumnsATime = 64;  // between two looks at `stop`

// Blocks of a grid in a row along x: places in grid.blocks.
struct Column {
  size_t begin = 0, end = 0;
};

// Where the middle line of a row of voxels crosses a triangle.
struct Crossing {
  uint32_t row = 0;  // y + 64 z in the column
  uint32_t object = 0;
  int last = 0;  // voxel of the row that meets the triangle: all beyond are behind it
  int turn = 0;  // 1 or -1: which side of the triangle is ahead
};

// On which side of the line from a to b the point is, moved by (e, e^2): 0 only if a and b are the same.
int sideOfLine(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& point) {
  const int side = orient2d(a.x, a.y, b.x, b.y, point.x, point.y);
  if (side != 0) return side;
  if (a.y != b.y) return a.y > b.y ? 1 : -1;
  return (b.x > a.x) - (b.x < a.x);
}

// 1 or -1: the line along x through this place crosses the triangle, and which way it turns around it.
int crossingOf(const std::array<glm::dvec3, 3>& corners, const glm::dvec2& place) {
  int turn = 0;
  for (size_t i = 0; i < 3; ++i) {
    const glm::dvec3 &a = corners[i], &b = corners[(i + 1) % 3];
    const int side = sideOfLine({a.y, a.z}, {b.y, b.z}, place);
    if (side == 0 || (i > 0 && side != turn)) return 0;
    turn = side;
  }
  return turn;
}

std::vector<Column> columnsOf(const VoxelGrid& grid) {
  std::vector<Column> columns;
  for (size_t i = 0; i < grid.blocks.size(); ++i) {
    const glm::ivec3& place = grid.blocks[i].place;
    if (i > 0 && place.y == grid.blocks[i - 1].place.y && place.z == grid.blocks[i - 1].place.z) {
      columns.back().end = i + 1;
    } else {
      columns.push_back({i, i + 1});
    }
  }
  return columns;
}

// What is inside in the blocks of a column, from its first block to its last.
class ColumnFill {
 public:
  ColumnFill(const Scene& scene, const VoxelGrid& grid, const ClosedParts& parts, InsideRule rule,
             const Column& column)
      : scene_(scene), grid_(grid), parts_(parts), rule_(rule), column_(column) {}

  struct Inner {
    glm::ivec3 place{0};
    Share share = Share::kNone;
    PackedBlock packed;
  };

  std::vector<Inner> fill() {
    findCrossings();
    std::vector<Inner> result;
    if (crossings_.empty()) return result;
    first_x_ = grid_.blocks[column_.begin].place.x;
    inside_.resize(size_t(grid_.blocks[column_.end - 1].place.x - first_x_ + 1));
    for (size_t begin = 0, end; begin < crossings_.size(); begin = end) {
      end = begin + 1;
      while (end < crossings_.size() && crossings_[end].row == crossings_[begin].row &&
             crossings_[end].object == crossings_[begin].object) {
        ++end;
      }
      fillRow(begin, end);
    }
    size_t next = column_.begin;
    for (size_t i = 0; i < inside_.size(); ++i) {
      glm::ivec3 place = grid_.blocks[column_.begin].place;
      place.x = first_x_ + int(i);
      if (grid_.blocks[next].place.x == place.x) leaveOut(grid_.blocks[next++], inside_[i]);
      Inner inner{place, Share::kNone, packBlock(inside_[i])};
      inner.share = inner.packed.shareOf(glm::ivec3(0), 6);
      if (inner.share != Share::kNone) result.push_back(std::move(inner));
    }
    return result;
  }

 private:
  void findCrossings() {
    std::vector<uint32_t> triangles;
    for (size_t i = column_.begin; i < column_.end; ++i) {
      for (const uint32_t id : grid_.blocks[i].triangles) {
        if (parts_.is_closed[id]) triangles.push_back(id);
      }
    }
    std::sort(triangles.begin(), triangles.end());
    triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
    const glm::ivec3 low = grid_.blocks[column_.begin].place * kBlockSide;
    constexpr int kFar = 1 << 30;
    const VoxelBox within{{-kFar, low.y, low.z}, {kFar, low.y + kBlockSide - 1, low.z + kBlockSide - 1}};
    for (const uint32_t id : triangles) {
      const auto corners = inVoxels(scene_.corners(id), std::ldexp(1.0, -grid_.lattice.exponent));
      const uint32_t object = objectOf(scene_, id);
      TriangleRows(corners).visit(within, [&](int y, int z, int, int last) {
        const int turn = crossingOf(corners, {y + 0.5, z + 0.5});
        if (turn == 0) return;
        crossings_.push_back({uint32_t(y - low.y + kBlockSide * (z - low.z)), object, last, turn});
      });
    }
    std::sort(crossings_.begin(), crossings_.end(), [](const Crossing& a, const Crossing& b) {
      return std::tie(a.row, a.object, a.last, a.turn) < std::tie(b.row, b.object, b.last, b.turn);
    });
  }

  // Of an object's crossings in a row.
  void fillRow(size_t begin, size_t end) {
    int64_t turns = 0;
    for (size_t i = begin; i + 1 < end; ++i) {
      turns += crossings_[i].turn;
      const bool is_inside = rule_ == InsideRule::kParity ? (i - begin) % 2 == 0 : turns != 0;
      if (is_inside) fillRun(crossings_[i].row, crossings_[i].last + 1, crossings_[i + 1].last);
    }
  }

  void fillRun(uint32_t row, int first, int last) {
    for (int x = first; x <= last;) {
      const int block = x >> 6, end = std::min(last, block * kBlockSide + kBlockSide - 1);
      inside_[size_t(block - first_x_)].row(int(row & 63), int(row >> 6)) |= rowBits(x & 63, end & 63);
      x = end + 1;
    }
  }

  void leaveOut(const VoxelBlock& block, BlockBits& bits) {
    surface_.clear();
    surface_.insert(block.bricks);
    for (int z = 0; z < kBlockSide; ++z) {
      for (int y = 0; y < kBlockSide; ++y) bits.row(y, z) &= ~surface_.row(y, z);
    }
  }

  const Scene& scene_;
  const VoxelGrid& grid_;
  const ClosedParts& parts_;
  InsideRule rule_;
  Column column_;
  int first_x_ = 0;  // block
  std::vector<Crossing> crossings_;
  std::vector<BlockBits> inside_;
  BlockBits surface_;
};

}  // namespace

VoxelSpace solidParts(const Scene& scene, const VoxelGrid& grid, const ClosedParts& parts, InsideRule rule,
                      const SolidHooks& hooks) {
  VoxelSpace space(grid);
  const std::vector<Column> columns = columnsOf(grid);
  std::vector<std::vector<ColumnFill::Inner>> found(std::min(kColumnsATime, columns.size()));
  for (size_t begin = 0; begin < columns.size(); begin += kColumnsATime) {
    if (hooks.stop != nullptr && *hooks.stop) throw Interrupted();
    const size_t count = std::min(kColumnsATime, columns.size() - begin);
    tbb::parallel_for(tbb::blocked_range<size_t>(0, count, 1), [&](const auto& range) {
      for (size_t i = range.begin(); i < range.end(); ++i) {
        found[i] = ColumnFill(scene, grid, parts, rule, columns[begin + i]).fill();
      }
    });
    for (size_t i = 0; i < count; ++i) {
      for (ColumnFill::Inner& inner : found[i]) {
        space.setInner(inner.place, inner.share, std::move(inner.packed));
      }
    }
    if (hooks.progress) hooks.progress(double(begin + count) / double(columns.size()));
  }
  return space;
}

}  // namespace sightline
