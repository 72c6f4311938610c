// Top down, by binned SAH and, if asked for, spatial splits. Nodes above kParallelSize references are cut by
// all threads together, smaller ones are tasks of their own, and from kPieceSize on a task builds all that is
// below. Nothing depends on which thread does what: bins add up the same in any order, chunks have a fixed
// size, and the parts are put together depth first at the end (assemble.cpp).
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/parallel_reduce.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <vector>

#include "bvh/binning.h"
#include "bvh/bvh.h"
#include "bvh/partition.h"
#include "bvh/spatial.h"
#include "bvh/subtree.h"

namespace sightline {

namespace {

/// Nodes of at most so many references are built by one thread, with all that is below them.
constexpr uint32_t kPieceSize = 4096;
/// Larger nodes are binned and partitioned by many threads, in chunks.
constexpr uint32_t kParallelSize = 2 * kChunk;
/// What visiting one more node costs in triangle tests, where a leaf could end the path instead. Tracers
/// test a leaf's triangles four or eight at once, so small leaves do not pay: at 2 instead of 1, SAH cost
/// (with both costs at 1) grows by 0.5 % on a city and the nodes of a soup shrink by a third.
constexpr float kNodeCost = 2.0f;
/// From this depth on nodes are halved by count: log2(2^32) = 32 levels reach single references.
constexpr uint32_t kHalvingDepth = 64;
static_assert(kHalvingDepth + 32 == kMaxDepth);
/// More references than this would overflow the arithmetic with chunks.
constexpr uint32_t kMostReferences = 0xffffffffu - kChunk;
/// A node with a smaller share of the root's surface than this for its children's overlap is not split
/// spatially (Stich et al., section 4.5).
constexpr float kLeastOverlap = 1e-5f;
/// Nor is one whose cost would fall by less than this factor with no overlap at all.
constexpr float kWorthwhile = 0.98f;

/// A node to be built: references [begin, end) of one of the two arrays, and room for `extra` more behind.
struct Range {
  uint32_t begin, end, extra, depth;
  int array;
  Box box, centroids;

  uint32_t size() const { return end - begin; }
};

class Builder {
 public:
  Builder(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles,
          const BvhConfig& config)
      : positions_(positions), triangles_(triangles), config_(config), scene_{positions, triangles, {}} {}

  void run(Bvh& bvh);

 private:
  void makeReferences();
  std::unique_ptr<TreePart> build(const Range& range);
  bool split(const Range& range, Range& left, Range& right);
  ObjectSplit findObject(const Range& range, const BinMapping& mapping, std::vector<uint32_t>& left_of_chunk);
  bool worthSpatial(const Range& range, const ObjectSplit& object) const;
  SpatialSplit findSpatial(const Range& range);
  bool cutSpatial(const Range& range, const SpatialSplit& split, Range& left, Range& right);
  void cutObject(const Range& range, ObjectSplit& split, const BinMapping& mapping,
                 const std::vector<uint32_t>& left_of_chunk, Range& left, Range& right);
  void shareRoom(const Range& range, uint32_t remaining, Range& left, Range& right);
  void makeRoom(const Range& left, Range& right);
  void buildPiece(const Range& range, TreePart& part);
  uint32_t addNode(const Range& range, const Range& left, const Range& right, TreePart& part, uint32_t depth);
  void addChild(uint32_t node, int i, const Range& range, TreePart& part, uint32_t depth);
  uint32_t addLeaf(const Range& range, TreePart& part);
  Reference* at(const Range& range) { return array_[range.array].get() + range.begin; }

  std::span<const glm::vec3> positions_;
  std::span<const glm::uvec3> triangles_;
  BvhConfig config_;
  Triangles scene_;
  Measure measure_;
  float root_area_ = 0;
  std::unique_ptr<Reference[]> array_[2];
  Range root_{};
};

glm::vec3 withoutNegativeZero(glm::vec3 p) {
  return p + 0.0f;
}

void Builder::makeReferences() {
  const uint32_t n = static_cast<uint32_t>(triangles_.size());
  const bool splits = config_.spatial_splits && config_.split_budget > 0;  // NaN is none
  const double share = splits ? std::min(config_.split_budget, 1.0f) : 0.0f;
  const uint32_t extra = static_cast<uint32_t>(std::min(n * share, double{kMostReferences} - n));
  for (int i = 0; i < (n > kPieceSize ? 2 : 1); ++i) {
    array_[i] = std::make_unique_for_overwrite<Reference[]>(size_t{n} + extra);
  }
  using Blocks = tbb::blocked_range<uint32_t>;
  const auto unite = [](Box a, const Box& b) {
    a.grow(b);
    return a;
  };
  Reference* references = array_[0].get();
  root_ = {0, n, extra, 0, 0, {}, {}};
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
  scene_.measure = measure_;
  root_area_ = measure_.halfArea(root_.box);
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

/// left_of_chunk: see partitionParallel; stays empty if one thread does it all.
ObjectSplit Builder::findObject(const Range& range, const BinMapping& mapping,
                                std::vector<uint32_t>& left_of_chunk) {
  const uint32_t n = range.size();
  if (n <= kParallelSize) {
    Bins bins;
    bins.add(at(range), n, mapping, measure_);
    return findObjectSplit(bins, mapping, measure_);
  }
  const uint32_t chunks = (n + kChunk - 1) / kChunk;
  std::vector<Bins> bins(chunks);
  tbb::parallel_for(0u, chunks, [&](uint32_t c) {
    bins[c].add(at(range) + c * kChunk, std::min(kChunk, n - c * kChunk), mapping, measure_);
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

/// Spatial splits remove the overlap of an object split's children. They are not tried where the overlap is
/// small, and where cutting it off both children would not lower the cost enough.
bool Builder::worthSpatial(const Range& range, const ObjectSplit& object) const {
  if (range.extra == 0 || range.depth >= kHalvingDepth) return false;
  if (object.axis < 0) return true;
  const Box overlap{max4(object.left.low, object.right.low), min4(object.left.high, object.right.high)};
  if (overlap.isEmpty() || measure_.halfArea(overlap) <= kLeastOverlap * root_area_) return false;
  Box left = object.left, right = object.right;
  setLane(left.high, object.axis, lane(overlap.low, object.axis));
  setLane(right.low, object.axis, lane(overlap.high, object.axis));
  const float left_cost = left.isEmpty() ? 0 : measure_.halfArea(left) * leafCost(object.left_count);
  const float right_cost =
      right.isEmpty() ? 0 : measure_.halfArea(right) * leafCost(range.size() - object.left_count);
  return left_cost + right_cost < kWorthwhile * object.cost;
}

SpatialSplit Builder::findSpatial(const Range& range) {
  const uint32_t n = range.size();
  SpatialMapping mapping(range.box, measure_);
  const uint32_t chunks = (n + kChunk - 1) / kChunk;
  std::vector<SpatialBins> many(chunks > 1 ? chunks : 0);
  SpatialBins all;
  const auto addChunks = [&](auto&& add) {
    if (chunks == 1) {
      add(all, at(range), n);
      return;
    }
    tbb::parallel_for(0u, chunks, [&](uint32_t c) {
      many[c] = {};
      add(many[c], at(range) + c * kChunk, std::min(kChunk, n - c * kChunk));
    });
    for (const SpatialBins& bins : many) all.merge(bins);
  };
  addChunks(
      [&](SpatialBins& bins, const Reference* r, uint32_t count) { bins.addCounts(r, count, mapping); });
  if (!mapping.keepAffordable(all, n, range.extra)) return {};
  addChunks([&](SpatialBins& bins, const Reference* r, uint32_t count) {
    bins.addBoxes(r, count, mapping, scene_);
  });
  return findSpatialSplit(all, mapping, n, range.extra, measure_);
}

/// False: the range is a leaf.
bool Builder::split(const Range& range, Range& left, Range& right) {
  const uint32_t n = range.size();
  if (n == 1) return false;
  const BinMapping mapping(range.centroids, n);
  std::vector<uint32_t> left_of_chunk;
  ObjectSplit object;
  SpatialSplit spatial;
  if (range.depth < kHalvingDepth) object = findObject(range, mapping, left_of_chunk);
  if (n > config_.max_leaf_size && worthSpatial(range, object)) spatial = findSpatial(range);
  if (object.axis >= 0 && spatial.axis >= 0 && spatial.cost >= object.cost) spatial.axis = -1;
  if (n <= config_.max_leaf_size) {
    const float area = measure_.halfArea(range.box);
    if (object.axis < 0 && spatial.axis < 0) return false;
    if (area * leafCost(n) <= area * kNodeCost + (spatial.axis < 0 ? object.cost : spatial.cost))
      return false;
  }
  if (spatial.axis >= 0 && cutSpatial(range, spatial, left, right)) return true;
  cutObject(range, object, mapping, left_of_chunk, left, right);
  return true;
}

/// Shares out the room behind the references; they still lie without a gap.
void Builder::shareRoom(const Range& range, uint32_t remaining, Range& left, Range& right) {
  left.extra = leftShare(remaining, left.size(), right.size());
  right.extra = remaining - left.extra;
  left.depth = right.depth = range.depth + 1;
}

void Builder::makeRoom(const Range& left, Range& right) {
  Reference* const first = at(right);
  const uint32_t moved = std::min(left.extra, right.size());
  std::copy_backward(first, first + moved, first + right.size() + left.extra);
  right.begin += left.extra;
  right.end += left.extra;
}

bool Builder::cutSpatial(const Range& range, const SpatialSplit& split, Range& left, Range& right) {
  const uint32_t n = range.size();
  const bool parallel = n > kParallelSize;
  const int array = parallel ? 1 - range.array : range.array;
  const SpatialSides s = parallel ? partitionSpatialParallel(at(range), array_[array].get() + range.begin, n,
                                                             range.extra, split, scene_)
                                  : partitionSpatialInPlace(at(range), n, split, scene_);
  if (s.left_count == 0 || s.right_count == 0) return false;
  left = {range.begin, range.begin + s.left_count, 0, 0, array, s.left, s.centroids.left};
  right = {left.end, left.end + s.right_count, 0, 0, array, s.right, s.centroids.right};
  shareRoom(range, range.extra - (s.left_count + s.right_count - n), left, right);
  if (parallel) {
    right.begin += left.extra;
    right.end += left.extra;
  } else {
    makeRoom(left, right);
  }
  return true;
}

void Builder::cutObject(const Range& range, ObjectSplit& split, const BinMapping& mapping,
                        const std::vector<uint32_t>& left_of_chunk, Range& left, Range& right) {
  const uint32_t n = range.size();
  const bool median = split.axis < 0;
  const bool parallel = !median && n > kParallelSize;
  const int array = parallel ? 1 - range.array : range.array;
  SideCentroids sides;
  if (median) {
    sides = partitionMedian(at(range), n, range.centroids, measure_, split);
  } else if (!parallel) {
    sides = partitionInPlace(at(range), n, mapping, split, measure_);
  }
  left = {range.begin, range.begin + split.left_count, 0, 0, array, split.left, sides.left};
  right = {left.end, range.end, 0, 0, array, split.right, sides.right};
  shareRoom(range, range.extra, left, right);
  if (!parallel) {
    makeRoom(left, right);
    return;
  }
  right.begin += left.extra;
  right.end += left.extra;
  sides = partitionParallel(at(range), n, at(left), at(right), mapping, split, measure_, left_of_chunk);
  left.centroids = sides.left;
  right.centroids = sides.right;
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
  if (triangles.empty()) throw std::invalid_argument("a tree needs at least one triangle");
  if (triangles.size() > kMostReferences) throw std::length_error("too many triangles for one tree");
  BvhConfig checked = config;
  checked.max_leaf_size = std::clamp(config.max_leaf_size, 1u, 8u);
  Bvh bvh;
  tbb::task_arena arena(config.threads > 0 ? config.threads : tbb::task_arena::automatic);
  arena.execute([&] { Builder(positions, triangles, checked).run(bvh); });
  bvh.build_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return bvh;
}

}  // namespace sightline
