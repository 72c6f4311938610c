#include "core/voxel/opencl/voxelize_opencl.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <utility>
#include <vector>

#include "cl_kernels/program_source.h"
#include "core/base/error.h"
#include "core/opencl/opencl_context.h"

namespace sightline {
namespace {

using VoxelizerClock = std::chrono::steady_clock;

constexpr uint32_t kAllRows = 0xffffffffu;  // of cl_kernels/voxelize.cl, as are the next
constexpr uint32_t kMostGroup = 256;
constexpr uint32_t kBinGroup = 64;
constexpr uint64_t kMostPairs = 0xffffffffu;  // at once: their places have 32 bits
constexpr uint32_t kMaskWords =
    kBlockSide * kBlockSide * kBlockSide / (kBrickSide * kBrickSide * kBrickSide) / 32;

/// A row of a pair, y + 64 z, or all of them.
struct OpenRow {
  uint32_t pair, row;
  auto operator<=>(const OpenRow&) const = default;
};

std::string buildOptionsOf(Separation separation, bool floats) {
  const char* which = separation == Separation::kConservative ? "0"
                      : separation == Separation::k26         ? "26"
                                                              : "6";
  return std::string(kClBuildOptions) + " -DSL_SEPARATION=" + which + (floats ? " -DSL_VOXEL_FLOATS" : "");
}

// A buffer of at least so many bytes: a larger one than before where that was too small.
void reserve(OpenClContext& context, ClBuffer& buffer, uint64_t bytes, const char* what) {
  if (buffer.bytes() >= bytes) return;
  const uint64_t before = buffer.bytes();
  buffer = ClBuffer();
  buffer = context.buffer(std::max(bytes, before + before / 2), what);
}

uint32_t withRoom(uint32_t count) {
  return count + std::min(count / 2, ~count);
}

class OpenClVoxelizer {
 public:
  OpenClVoxelizer(const std::string& device, const Scene& scene, const VoxelizeOptions& options,
                  const OpenClVoxelizing& tuning)
      : scene_(scene),
        options_(options),
        group_(std::min(tuning.group > 0 ? tuning.group : 64, kMostGroup)),
        brick_capacity_(std::max(tuning.bricks, 1u)),
        open_capacity_(std::max(tuning.open_rows, 1u)),
        open_triangle_capacity_(open_capacity_),
        context_(device) {
    context_.build(kVoxelizeSource, buildOptionsOf(options.separation, tuning.floats));
    kernel_ = context_.kernel("voxelizeBlocks");
    bin_kernel_ = context_.kernel("binIntoBlocks");
    counters_ = context_.buffer(sizeof(uint32_t) * 2, "counters");
    uploadTriangles();
    context_.finish();
    done_.setup_seconds = std::chrono::duration<double>(VoxelizerClock::now() - start_).count();
  }

  BlockTriangles bin(const VoxelBox& blocks) {
    const VoxelizerClock::time_point start = VoxelizerClock::now();
    BlockTriangles result;
    result.blocks = blocks;
    const glm::ivec3 size = blocks.high - blocks.low + 1;
    const size_t count = size_t(size.x) * size_t(size.y) * size_t(size.z);
    const std::vector<uint32_t> open = countInBlocks(blocks, count);
    std::vector<uint32_t> counts(count);
    context_.readFast(counts_, counts.data(), count * sizeof(uint32_t));
    std::vector<std::pair<size_t, uint32_t>> more;  // blocks of triangles that the device left open
    for (const uint32_t id : open) addBlocksOf(id, blocks, more);
    result.first.assign(count + 1, 0);
    for (size_t i = 0; i < count; ++i) result.first[i] = counts[i];
    for (const auto& [block, id] : more) ++result.first[block];
    uint64_t total = 0;
    for (uint64_t& first : result.first) total += std::exchange(first, total);
    if (total > kMostPairs) {
      throw Error(
          "a layer of blocks holds more triangles than this device's lists: take larger voxels, or "
          "the processor");
    }
    result.ids.resize(total);
    if (total > 0) {
      fillBlocks(blocks, result);
      for (const auto& [block, id] : more) result.ids[result.first[block] + counts[block]++] = id;
    }
    tbb::parallel_for(tbb::blocked_range<size_t>(0, count), [&](const auto& range) {
      for (size_t i = range.begin(); i < range.end(); ++i) {
        std::sort(result.ids.begin() + int64_t(result.first[i]),
                  result.ids.begin() + int64_t(result.first[i + 1]));
      }
    });
    done_.open_triangles += open.size();
    done_.bin_seconds += std::chrono::duration<double>(VoxelizerClock::now() - start).count();
    return result;
  }

  void make(const BlockTriangles& binned, std::span<const size_t> filled, std::span<VoxelBlock> blocks) {
    const VoxelizerClock::time_point start = VoxelizerClock::now();
    uploadPairs(binned, filled, blocks);
    launchUntilListsSuffice(blocks.size());
    std::vector<uint32_t> first(2 * blocks.size()), masks(blocks.size() * kMaskWords);
    std::vector<OpenRow> open(open_count_);
    const size_t words = size_t(8) * brick_count_;
    if (bits_.size() < words) bits_.resize(words);
    context_.read(first_brick_, first.data(), first.size() * sizeof(uint32_t));
    context_.read(masks_, masks.data(), masks.size() * sizeof(uint32_t));
    if (!open.empty()) context_.read(open_, open.data(), open.size() * sizeof(OpenRow));
    if (words > 0) context_.readFast(bricks_, bits_.data(), words * sizeof(uint64_t));
    const VoxelizerClock::time_point read = VoxelizerClock::now();
    // Work items list them in any order, and families of targets twice.
    std::sort(open.begin(), open.end());
    open.erase(std::unique(open.begin(), open.end()), open.end());
    tbb::parallel_for(tbb::blocked_range<size_t>(0, blocks.size(), 16), [&](const auto& range) {
      for (size_t i = range.begin(); i < range.end(); ++i) {
        blocks[i].bricks = bricksOf(std::span(masks).subspan(kMaskWords * i, kMaskWords),
                                    std::span(first).subspan(2 * i, 2));
        decideOpen(open, first_pair_[i], first_pair_[i + 1], blocks[i]);
      }
    });
    done_.device_seconds += std::chrono::duration<double>(read - start).count();
    done_.host_seconds += std::chrono::duration<double>(VoxelizerClock::now() - read).count();
    done_.pairs += first_pair_.back();
    for (const OpenRow& row : open) ++(row.row == kAllRows ? done_.open_pairs : done_.open_rows);
  }

  const OpenClVoxelized& done() const { return done_; }
  uint64_t mostListBytes() const {
    return std::min(context_.maxAllocationBytes(), kMostPairs * sizeof(uint32_t));
  }

 private:
  void uploadTriangles() {
    if (!scene_.hasInstances()) {
      upload(positions_, scene_.positions, "positions of the scene");
      upload(triangles_, scene_.triangles, "triangles of the scene");
      return;
    }
    std::vector<glm::vec3> corners;
    std::vector<glm::uvec3> triangles;
    corners.reserve(size_t(3) * scene_.triangleCount());
    scene_.visitTriangles(0, scene_.triangleCount(), [&](uint32_t, const std::array<glm::vec3, 3>& t) {
      const auto at = uint32_t(corners.size());
      corners.insert(corners.end(), t.begin(), t.end());
      triangles.emplace_back(at, at + 1, at + 2);
    });
    upload(positions_, corners, "corners of the scene's triangles");
    upload(triangles_, triangles, "triangles of the scene");
  }

  template <typename T>
  void upload(ClBuffer& buffer, const std::vector<T>& values, const char* what) {
    reserve(context_, buffer, values.size() * sizeof(T), what);
    context_.write(buffer, values.data(), values.size() * sizeof(T));
  }

  void launchBinning(const VoxelBox& blocks, bool fills) {
    const glm::ivec3 size = blocks.high - blocks.low + 1;
    context_.fill(counts_, 0, counts_.bytes());
    context_.launch(bin_kernel_, scene_.triangleCount(), kBinGroup, positions_, triangles_,
                    scene_.triangleCount(), float(std::ldexp(1.0, -options_.lattice.exponent) / kBlockSide),
                    glm::ivec4(blocks.low, 0), glm::ivec4(size, 0), uint32_t(fills), open_triangle_capacity_,
                    counts_, first_, ids_, open_triangles_, counters_);
  }

  // Into counts_; what is left open is returned, ascending.
  std::vector<uint32_t> countInBlocks(const VoxelBox& blocks, size_t count) {
    reserve(context_, counts_, count * sizeof(uint32_t), "counts of blocks");
    reserve(context_, first_, sizeof(uint32_t), "blocks");
    reserve(context_, ids_, sizeof(uint32_t), "triangles of blocks");
    for (;;) {
      reserve(context_, open_triangles_, sizeof(uint32_t) * uint64_t(open_triangle_capacity_),
              "open triangles");
      context_.fill(counters_, 0, sizeof(uint32_t) * 2);
      launchBinning(blocks, false);
      uint32_t counters[2];
      context_.read(counters_, counters, sizeof counters);
      std::vector<uint32_t> open(counters[1]);
      if (counters[1] <= open_triangle_capacity_) {
        if (!open.empty()) context_.read(open_triangles_, open.data(), open.size() * sizeof(uint32_t));
        std::sort(open.begin(), open.end());
        return open;
      }
      open_triangle_capacity_ = withRoom(counters[1]);
      ++done_.repeats;
    }
  }

  void addBlocksOf(uint32_t id, const VoxelBox& blocks,
                   std::vector<std::pair<size_t, uint32_t>>& more) const {
    const glm::ivec3 size = blocks.high - blocks.low + 1;
    TriangleRows rows(inVoxels(scene_.corners(id), std::ldexp(1.0, -options_.lattice.exponent) / kBlockSide));
    rows.visit(blocks, [&](int y, int z, int from, int to) {
      for (int x = from; x <= to; ++x) {
        more.emplace_back(
            size_t(x - blocks.low.x) +
                size_t(size.x) * (size_t(y - blocks.low.y) + size_t(size.y) * size_t(z - blocks.low.z)),
            id);
      }
    });
  }

  // The device's part of the ids, in any order, at the beginning of each block's.
  void fillBlocks(const VoxelBox& blocks, BlockTriangles& result) {
    const std::vector<uint32_t> first(result.first.begin(), result.first.end());
    upload(first_, first, "blocks");
    reserve(context_, ids_, result.ids.size() * sizeof(uint32_t), "triangles of blocks");
    launchBinning(blocks, true);
    context_.readFast(ids_, result.ids.data(), result.ids.size() * sizeof(uint32_t));
  }

  void uploadPairs(const BlockTriangles& binned, std::span<const size_t> filled,
                   std::span<const VoxelBlock> blocks) {
    const uint64_t begin = binned.first[filled.front()], end = binned.first[filled.back() + 1];
    first_pair_.resize(blocks.size() + 1);
    std::vector<glm::ivec4> places(blocks.size());
    for (size_t i = 0; i < blocks.size(); ++i) {
      first_pair_[i] = uint32_t(binned.first[filled[i]] - begin);
      places[i] = glm::ivec4(blocks[i].place, 0);
    }
    first_pair_.back() = uint32_t(end - begin);
    pairs_of_host_ = std::span(binned.ids).subspan(begin, end - begin);
    reserve(context_, pairs_, pairs_of_host_.size_bytes(), "triangles of blocks");
    context_.write(pairs_, pairs_of_host_.data(), pairs_of_host_.size_bytes());
    upload(first_, first_pair_, "blocks");
    upload(places_, places, "places of blocks");
    reserve(context_, first_brick_, 2 * blocks.size() * sizeof(uint32_t), "bricks of blocks");
    reserve(context_, masks_, blocks.size() * kMaskWords * sizeof(uint32_t), "bricks of blocks");
  }

  // Bits are set again, and lists written again, to the same.
  void launchUntilListsSuffice(size_t blocks) {
    for (;;) {
      reserve(context_, bricks_, uint64_t(64) * brick_capacity_, "bricks");
      reserve(context_, open_, sizeof(OpenRow) * uint64_t(open_capacity_), "open rows");
      context_.fill(counters_, 0, sizeof(uint32_t) * 2);
      context_.launch(kernel_, uint64_t(2 * blocks) * group_, group_, positions_, triangles_,
                      float(std::ldexp(1.0, -options_.lattice.exponent)), places_, first_, pairs_,
                      brick_capacity_, open_capacity_, bricks_, first_brick_, masks_, open_, counters_);
      uint32_t counts[2];
      context_.read(counters_, counts, sizeof counts);
      brick_count_ = counts[0];
      open_count_ = counts[1];
      if (brick_count_ <= brick_capacity_ && open_count_ <= open_capacity_) return;
      // The next blocks may have more: some room is cheaper than to work again.
      if (brick_count_ > brick_capacity_) brick_capacity_ = withRoom(brick_count_);
      if (open_count_ > open_capacity_) open_capacity_ = withRoom(open_count_);
      ++done_.repeats;
    }
  }

  // first: of the lower and of the upper half of a block.
  std::vector<VoxelBrick> bricksOf(std::span<const uint32_t> masks, std::span<const uint32_t> first) const {
    std::vector<VoxelBrick> bricks;
    size_t count = 0;
    for (const uint32_t mask : masks) count += size_t(std::popcount(mask));
    bricks.reserve(count);
    for (uint32_t half = 0; half < 2; ++half) {
      auto bits = bits_.begin() + int64_t(8) * first[half];
      for (uint32_t word = half * kMaskWords / 2; word < (half + 1) * kMaskWords / 2; ++word) {
        for (uint32_t mask = masks[word]; mask != 0; mask &= mask - 1) {
          VoxelBrick brick;
          brick.place = uint16_t(32 * word + uint32_t(std::countr_zero(mask)));
          std::copy_n(bits, 8, brick.bits.begin());
          bits += 8;
          bricks.push_back(brick);
        }
      }
    }
    return bricks;
  }

  // Adds the rows of the pairs from first to end - 1 that the device left open.
  void decideOpen(std::span<const OpenRow> open, uint32_t first, uint32_t end, VoxelBlock& block) const {
    auto next = std::lower_bound(open.begin(), open.end(), OpenRow{first, 0});
    if (next == open.end() || next->pair >= end) return;
    BlockBits bits;
    bits.insert(block.bricks);
    while (next != open.end() && next->pair < end) {
      const auto pair_end =
          std::find_if(next, open.end(), [&](const OpenRow& r) { return r.pair != next->pair; });
      const auto corners =
          inVoxels(scene_.corners(pairs_of_host_[next->pair]), std::ldexp(1.0, -options_.lattice.exponent));
      if (options_.separation == Separation::kConservative) {
        TriangleRows rows(corners);
        insertRows(rows, std::span(next, pair_end), block.place, bits);
      } else {
        SeparatingRows rows(corners, options_.separation);
        insertRows(rows, std::span(next, pair_end), block.place, bits);
      }
      next = pair_end;
    }
    block.bricks = bits.bricks();
  }

  template <typename Rows>
  static void insertRows(Rows& rows, std::span<const OpenRow> open, const glm::ivec3& place,
                         BlockBits& bits) {
    const glm::ivec3 low = place * kBlockSide;
    const bool all = open.back().row == kAllRows;  // the last, as they are sorted
    for (const OpenRow& row : all ? open.last(1) : open) {
      VoxelBox box{low, low + (kBlockSide - 1)};
      if (!all) {
        box.low.y = box.high.y = low.y + int(row.row % kBlockSide);
        box.low.z = box.high.z = low.z + int(row.row / kBlockSide);
      }
      rows.visit(box, [&](int y, int z, int from, int to) {
        bits.row(y - low.y, z - low.z) |= rowBits(from - low.x, to - low.x);
      });
    }
  }

  VoxelizerClock::time_point start_ = VoxelizerClock::now();
  const Scene& scene_;
  const VoxelizeOptions& options_;
  uint32_t group_, brick_capacity_, open_capacity_, open_triangle_capacity_;
  uint32_t brick_count_ = 0, open_count_ = 0;
  OpenClContext context_;
  ClKernel kernel_, bin_kernel_;
  ClBuffer counts_, ids_, open_triangles_;
  ClBuffer positions_, triangles_, places_, first_, pairs_, bricks_, first_brick_, masks_, open_, counters_;
  std::vector<uint32_t> first_pair_;         ///< of each block of the launch, and one more
  std::span<const uint32_t> pairs_of_host_;  ///< of the launch: ids
  std::vector<uint64_t> bits_;               ///< of its bricks
  OpenClVoxelized done_;
};

}  // namespace

OpenClVoxelized voxelizeOpenCl(const Scene& scene, const VoxelizeOptions& options, const std::string& device,
                               const std::function<void(VoxelBlock&&)>& take,
                               const OpenClVoxelizing& tuning) {
  requireFits(options.lattice, sceneBounds(scene));  // before a device is asked for anything
  OpenClVoxelizer voxelizer(device, scene, options, tuning);
  VoxelizeOptions on_device = options;
  on_device.memory = std::min(options.memory, voxelizer.mostListBytes());
  VoxelizeSteps steps;
  steps.bin = [&](const VoxelBox& blocks) { return voxelizer.bin(blocks); };
  steps.make = [&](const BlockTriangles& binned, std::span<const size_t> filled,
                   std::span<VoxelBlock> blocks) { voxelizer.make(binned, filled, blocks); };
  steps.blocks_a_time = std::max(tuning.blocks_a_time, size_t{1});
  voxelizeBy(steps, scene, on_device, take);
  return voxelizer.done();
}

}  // namespace sightline
