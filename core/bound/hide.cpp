#include "core/bound/hide.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>

#include "core/base/interrupted.h"
#include "core/bound/layer_search.h"
#include "core/voxel/voxel_space.h"

namespace sightline {
namespace {

constexpr size_t kBlocksATime = 256;  // between two looks at `stop`

/// One block, as an octree.
class BlockHiding {
 public:
  BlockHiding(const CellHull& hull, const HideOptions& options, const BlockedSpace& blocked)
      : hull_(hull),
        options_(options),
        view_(blocked),
        search_(hull, options.part_size, options.region, view_) {}

  /// surface: of the block, nullptr: none. false: nothing was hidden.
  bool run(const glm::ivec3& place, const VoxelBlock* surface, OpenBlock& own) {
    low_ = place * kBlockSide;
    own_ = &own;
    surface_words_.fill(0);
    if (surface != nullptr) {
      bricks_.fill(nullptr);
      for (const VoxelBrick& brick : surface->bricks) {
        surface_words_[size_t(brick.place >> 6)] |= uint64_t{1} << (brick.place & 63);
        bricks_[brick.place] = &brick.bits;
      }
    }
    view_.setOwn(place, &own);
    is_changed_ = false;
    visit(glm::ivec3(0), kBlockSide);
    return is_changed_;
  }

 private:
  void visit(const glm::ivec3& at, int side) {
    const bool has_surface = meetsSurface(at, side);
    if ((!has_surface && side < options_.free_side) || isBlocked(at, side)) return;
    const glm::dvec3 low(low_ + at);
    const RealBox box{low, low + double(side)};
    if (hull_.isBehind(box) || search_.hides(box)) {
      own_->insert(at, side);
      is_changed_ = true;
      return;
    }
    if (side <= options_.surface_side) return;
    // From near to far, so that the nearer ones may hide the others.
    const int half = side / 2;
    const glm::ivec3 far(glm::lessThan(low + double(half), hull_.center()));
    for (int i = 0; i < 8; ++i) {
      const glm::ivec3 step = glm::ivec3(i & 1, (i >> 1) & 1, i >> 2) ^ far;
      visit(at + step * half, half);
    }
  }

  bool isBlocked(const glm::ivec3& at, int side) const {
    return isIn(own_->all, at, side) || isInBits(at, side);
  }

  static uint64_t square(int x, int y, int side) {
    uint64_t bits = 0;
    for (int i = 0; i < side; ++i) bits |= ((uint64_t{1} << side) - 1) << (x + 8 * (y + i));
    return bits;
  }

  // Whether all bits of a cube of bricks are set.
  static bool isIn(const std::array<uint64_t, 8>& words, const glm::ivec3& at, int side) {
    const glm::ivec3 brick = at >> 3;
    const int count = std::max(side / 8, 1);
    const uint64_t bits = square(brick.x, brick.y, count);
    for (int z = brick.z; z < brick.z + count; ++z) {
      if ((words[size_t(z)] & bits) != bits) return false;
    }
    return true;
  }

  bool isInBits(const glm::ivec3& at, int side) const {
    if (side >= 8) return false;
    const glm::ivec3 brick = at >> 3, in = at & 7;
    const OpenBlock::Brick& words = own_->bits[size_t(64 * brick.z + 8 * brick.y + brick.x)];
    const uint64_t bits = square(in.x, in.y, side);
    for (int z = in.z; z < in.z + side; ++z) {
      if ((words[size_t(z)] & bits) != bits) return false;
    }
    return true;
  }

  bool meetsSurface(const glm::ivec3& at, int side) const {
    const glm::ivec3 brick = at >> 3;
    const int count = std::max(side / 8, 1);
    const uint64_t bits = square(brick.x, brick.y, count);
    uint64_t any = 0;
    for (int z = brick.z; z < brick.z + count; ++z) any |= surface_words_[size_t(z)] & bits;
    if (any == 0 || side >= 8) return any != 0;
    const std::array<uint64_t, 8>& words = *bricks_[size_t(64 * brick.z + 8 * brick.y + brick.x)];
    const glm::ivec3 in = at & 7;
    const uint64_t voxels = square(in.x, in.y, side);
    for (int z = in.z; z < in.z + side; ++z) {
      if ((words[size_t(z)] & voxels) != 0) return true;
    }
    return false;
  }

  const CellHull& hull_;
  const HideOptions& options_;
  BlockedView view_;
  LayerSearch search_;
  glm::ivec3 low_{0};
  OpenBlock* own_ = nullptr;
  bool is_changed_ = false;
  std::array<uint64_t, 8> surface_words_{};  ///< word z, bit x + 8 y of a brick: has voxels of the surface
  std::array<const std::array<uint64_t, 8>*, 512> bricks_{};  ///< of these
};

}  // namespace

void hide(const CellHull& hull, const VoxelGrid& surface, const HideOptions& options, BlockedSpace& blocked) {
  // Waves of blocks that are as many blocks from the cell, counted along x, y and z: segments from the cell
  // to one pass through those of waves before it only. So each is looked at with what these have hidden.
  const VoxelBox all = overlapOf(blocked.blocks(), {options.region.low >> 6, options.region.high >> 6});
  const glm::ivec3 cell_low(glm::floor(hull.box().low / double(kBlockSide))),
      cell_high(glm::floor(hull.box().high / double(kBlockSide)));
  std::vector<std::vector<glm::ivec3>> waves;
  size_t left = 0;
  for (int z = all.low.z; z <= all.high.z; ++z) {
    for (int y = all.low.y; y <= all.high.y; ++y) {
      for (int x = all.low.x; x <= all.high.x; ++x) {
        const glm::ivec3 place(x, y, z);
        if (blocked.share(place) == Share::kAll) continue;
        const glm::ivec3 steps = glm::max(glm::max(cell_low - place, place - cell_high), glm::ivec3(0));
        const size_t wave = size_t(steps.x + steps.y + steps.z);
        if (wave >= waves.size()) waves.resize(wave + 1);
        waves[wave].push_back(place);
        ++left;
      }
    }
  }
  const VoxelLookup lookup(surface);
  const size_t count_all = left;
  for (const std::vector<glm::ivec3>& wave : waves) {
    std::vector<Share> shares(wave.size(), Share::kNone);
    std::vector<PackedBlock> packed(wave.size());
    for (size_t begin = 0; begin < wave.size(); begin += kBlocksATime) {
      if (options.stop != nullptr && *options.stop) throw Interrupted();
      const size_t end = std::min(begin + kBlocksATime, wave.size());
      tbb::parallel_for(tbb::blocked_range<size_t>(begin, end, 1), [&](const auto& range) {
        BlockHiding hiding(hull, options, blocked);
        OpenBlock own;
        for (size_t i = range.begin(); i < range.end(); ++i) {
          const Share share = blocked.share(wave[i]);
          own.assign(share == Share::kSome ? blocked.packed(wave[i]) : PackedBlock{});
          if (!hiding.run(wave[i], lookup.block(wave[i]), own)) continue;
          shares[i] = own.isFull() ? Share::kAll : Share::kSome;
          if (shares[i] == Share::kSome) packed[i] = own.packed();
        }
      });
      left -= end - begin;
      if (options.progress) options.progress(double(count_all - left) / double(count_all));
    }
    for (size_t i = 0; i < wave.size(); ++i) {
      if (shares[i] != Share::kNone) blocked.set(wave[i], shares[i], std::move(packed[i]));
    }
  }
}

}  // namespace sightline
