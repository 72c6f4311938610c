#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/parallel_reduce.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <vector>

#include "bvh/binning.h"
#include "bvh/bvh.h"
#include "bvh/partition.h"
#include "bvh/subtree.h"

namespace sightline {

namespace {

/// Nodes of at most so many references are built by one thread, with all that is below them.
constexpr uint32_t kPieceSize = 4096;
/// From this depth on nodes are halved by count: log2(2^32) = 32 levels reach single references.
constexpr uint32_t kHalvingDepth = 64;

/// A node to be built: references [begin, end) of one of the two arrays.
struct Range {
  uint32_t begin, end, depth;
  int array;
  Box box, centroids;

  uint32_t size() const { return end - begin; }
};

class Builder {
 public:
  Builder(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles,
          const BvhConfig& config)
      : positions_(positions), triangles_(triangles), config_(config) {}

  void run(Bvh& bvh);

 private:
  void makeReferences();
  std::unique_ptr<TreePart> build(const Range& range);
  bool split(const Range& range, Range& left, Range& right);
  ObjectSplit findSplitSerial(const Range& range, const BinMapping& mapping);
  ObjectSplit findSplitParallel(const Range& range, const BinMapping& mapping,
                                std::vector<uint32_t>& left_of_chunk);
  void buildPiece(const Range& range, TreePart& part);
  uint32_t addNode(const Range& range, const Range& left, const Range& right, TreePart& part, uint32_t depth);
  void addChild(uint32_t node, int i, const Range& range, TreePart& part, uint32_t depth);
  uint32_t addLeaf(const Range& range, TreePart& part);
  Reference* at(const Range& range) { return array_[range.array].get() + range.begin; }

  std::span<const glm::vec3> positions_;
  std::span<const glm::uvec3> triangles_;
  BvhConfig config_;
  Measure measure_;
  std::unique_ptr<Reference[]> array_[2];
  Range root_{};
};

glm::vec3 withoutNegativeZero(glm::vec3 p) {
  return p + 0.0f;
}

void Builder::makeReferences() {
  const uint32_t n = static_cast<uint32_t>(triangles_.size());
  array_[0] = std::make_unique_for_overwrite<Reference[]>(n);
  using Blocks = tbb::blocked_range<uint32_t>;
  const auto unite = [](Box a, const Box& b) {
    a.grow(b);
    return a;
  };
  Reference* references = array_[0].get();
  root_ = {0, n, 0, 0, {}, {}};
  root_.box = tbb::parallel_reduce(
      Blocks(0, n, kChunk), Box(),
      [&](const Blocks& block, Box box) {
        for (uint32_t i = block.begin(); i < block.end(); ++i) {
          const glm::uvec3 t = triangles_[i];
          const glm::vec3 a = positions_[t.x], b = positions_[t.y], c = positions_[t.z];
          const glm::vec3 low = withoutNegativeZero(glm::min(glm::min(a, b), c));
          const glm::vec3 high = withoutNegativeZero(glm::max(glm::max(a, b), c));
          references[i] = {{low.x, low.y, low.z}, i, {high.x, high.y, high.z}, 0};
          box.grow(references[i].lowLanes(), references[i].highLanes());
        }
        return box;
      },
      unite);
  float largest = 0;
  for (int a = 0; a < 3; ++a) {
    largest = std::max({largest, std::fabs(lane(root_.box.low, a)), std::fabs(lane(root_.box.high, a))});
  }
  int exponent = 0;
  std::frexp(largest, &exponent);
  // 2^-127 and less are not normal numbers, 2^128 is none at all.
  measure_.scale = splat4(std::ldexp(1.0f, std::clamp(-exponent, -126, 127)));
  root_.centroids = tbb::parallel_reduce(
      Blocks(0, n, kChunk), Box(),
      [&](const Blocks& block, Box box) {
        for (uint32_t i = block.begin(); i < block.end(); ++i) {
          const Float4 c = measure_.centroid(references[i]);
          box.grow(c, c);
        }
        return box;
      },
      unite);
}

ObjectSplit Builder::findSplitSerial(const Range& range, const BinMapping& mapping) {
  Bins bins;
  bins.add(at(range), range.size(), mapping, measure_);
  return findObjectSplit(bins, mapping, measure_);
}

ObjectSplit Builder::findSplitParallel(const Range& range, const BinMapping& mapping,
                                       std::vector<uint32_t>& left_of_chunk) {
  const uint32_t chunks = (range.size() + kChunk - 1) / kChunk;
  std::vector<Bins> bins(chunks);
  tbb::parallel_for(0u, chunks, [&](uint32_t c) {
    const uint32_t begin = c * kChunk;
    bins[c].add(at(range) + begin, std::min(kChunk, range.size() - begin), mapping, measure_);
  });
  Bins all = bins[0];
  for (uint32_t c = 1; c < chunks; ++c) all.merge(bins[c], mapping.bins);
  const ObjectSplit split = findObjectSplit(all, mapping, measure_);
  left_of_chunk.assign(chunks, 0);
  for (uint32_t c = 0; split.axis >= 0 && c < chunks; ++c) {
    for (uint32_t b = 0; b < split.bin; ++b) left_of_chunk[c] += bins[c].count[split.axis][b];
  }
  return split;
}

/// False: the range is a leaf.
bool Builder::split(const Range& range, Range& left, Range& right) {
  const uint32_t n = range.size();
  if (n == 1) return false;
  const BinMapping mapping(range.centroids, n);
  const bool parallel = n > 2 * kChunk;
  std::vector<uint32_t> left_of_chunk;
  ObjectSplit s;
  if (range.depth < kHalvingDepth) {
    s = parallel ? findSplitParallel(range, mapping, left_of_chunk) : findSplitSerial(range, mapping);
  }
  if (n <= config_.max_leaf_size) {
    const float area = measure_.halfArea(range.box);
    if (s.axis < 0 || area * leafCost(n) <= area + s.cost) return false;
  }
  SideCentroids sides;
  int array = range.array;
  if (s.axis < 0) {
    sides = partitionMedian(at(range), n, range.centroids, measure_, s);
  } else if (parallel) {
    array = 1 - array;
    sides = partitionParallel(at(range), array_[array].get() + range.begin, n, mapping, s, measure_,
                              left_of_chunk);
  } else {
    sides = partitionInPlace(at(range), n, mapping, s, measure_);
  }
  const uint32_t middle = range.begin + s.left_count;
  left = {range.begin, middle, range.depth + 1, array, s.left, sides.left};
  right = {middle, range.end, range.depth + 1, array, s.right, sides.right};
  return true;
}

std::unique_ptr<TreePart> Builder::build(const Range& range) {
  auto part = std::make_unique<TreePart>();
  part->box = range.box;
  Range left, right;
  if (range.size() <= kPieceSize) {
    buildPiece(range, *part);
  } else {
    split(range, left, right);
    tbb::parallel_invoke([&] { part->child[0] = build(left); }, [&] { part->child[1] = build(right); });
  }
  return part;
}

void Builder::buildPiece(const Range& range, TreePart& part) {
  part.nodes.reserve(range.size() / 2 + 1);
  part.references.reserve(range.size());
  Range left, right;
  if (split(range, left, right)) {
    addNode(range, left, right, part, 1);
  } else {
    addLeaf(range, part);
  }
}

uint32_t Builder::addNode(const Range& range, const Range& left, const Range& right, TreePart& part,
                          uint32_t depth) {
  const uint32_t node = static_cast<uint32_t>(part.nodes.size());
  part.nodes.emplace_back();
  part.cost += measure_.halfArea(range.box);
  part.depth = std::max(part.depth, depth);
  addChild(node, 0, left, part, depth);
  addChild(node, 1, right, part, depth);
  return node;
}

void Builder::addChild(uint32_t node, int i, const Range& range, TreePart& part, uint32_t depth) {
  Range left, right;
  if (split(range, left, right)) {
    const uint32_t child = addNode(range, left, right, part, depth + 1);
    setChild(part.nodes[node], i, range.box, child, 0);
  } else {
    setChild(part.nodes[node], i, range.box, addLeaf(range, part), range.size());
  }
}

uint32_t Builder::addLeaf(const Range& range, TreePart& part) {
  const uint32_t first = static_cast<uint32_t>(part.references.size());
  for (const Reference* r = at(range); r != at(range) + range.size(); ++r) part.references.push_back(r->id);
  std::sort(part.references.begin() + first, part.references.end());
  part.cost += static_cast<double>(measure_.halfArea(range.box)) * range.size();
  return first;
}

void Builder::run(Bvh& bvh) {
  makeReferences();
  if (root_.size() > 2 * kChunk) array_[1] = std::make_unique_for_overwrite<Reference[]>(root_.size());
  std::unique_ptr<TreePart> root = build(root_);
  array_[0].reset();
  array_[1].reset();
  assemble(std::move(root), measure_, bvh);
  collapse(bvh, measure_);
}

}  // namespace

Bvh buildBvh(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles,
             const BvhConfig& config) {
  const auto start = std::chrono::steady_clock::now();
  BvhConfig checked = config;
  checked.max_leaf_size = std::clamp(config.max_leaf_size, 1u, 8u);
  Bvh bvh;
  tbb::task_arena arena(config.threads > 0 ? config.threads : tbb::task_arena::automatic);
  arena.execute([&] { Builder(positions, triangles, checked).run(bvh); });
  bvh.build_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return bvh;
}

}  // namespace sightline
