#include "bvh/partition.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <utility>

namespace sightline {

namespace {

bool isLeft(const ObjectSplit& split, const BinMapping& mapping, Float4 centroid) {
  return static_cast<uint32_t>(mapping.bin(centroid).v[split.axis]) < split.bin;
}

/// The axis along which the centroids spread most; of equal ones the first.
int widestAxis(const Box& centroids) {
  alignas(16) float e[4];
  store4(e, centroids.high - centroids.low);
  return static_cast<int>(std::max_element(e, e + 3) - e);
}

}  // namespace

SideCentroids partitionInPlace(Reference* references, uint32_t count, const BinMapping& mapping,
                               const ObjectSplit& split, const Measure& measure) {
  SideCentroids sides;
  Reference* l = references;
  Reference* r = references + count;
  while (l != r) {
    const Float4 c = measure.centroid(*l);
    if (isLeft(split, mapping, c)) {
      sides.left.grow(c, c);
      ++l;
    } else {
      sides.right.grow(c, c);
      std::swap(*l, *--r);
    }
  }
  return sides;
}

SideCentroids partitionParallel(const Reference* references, uint32_t count, Reference* left,
                                Reference* right, const BinMapping& mapping, const ObjectSplit& split,
                                const Measure& measure, const std::vector<uint32_t>& left_of_chunk) {
  const uint32_t chunks = static_cast<uint32_t>(left_of_chunk.size());
  std::vector<uint32_t> left_start(chunks);
  uint32_t sum = 0;
  for (uint32_t c = 0; c < chunks; ++c) {
    left_start[c] = sum;
    sum += left_of_chunk[c];
  }
  std::vector<SideCentroids> sides(chunks);
  tbb::parallel_for(0u, chunks, [&](uint32_t c) {
    const uint32_t begin = c * kChunk, end = std::min(count, begin + kChunk);
    Reference* l = left + left_start[c];
    Reference* r = right + (begin - left_start[c]);
    SideCentroids s;
    for (uint32_t i = begin; i < end; ++i) {
      const Float4 centroid = measure.centroid(references[i]);
      if (isLeft(split, mapping, centroid)) {
        s.left.grow(centroid, centroid);
        *l++ = references[i];
      } else {
        s.right.grow(centroid, centroid);
        *r++ = references[i];
      }
    }
    sides[c] = s;
  });
  for (uint32_t c = 1; c < chunks; ++c) {
    sides[0].left.grow(sides[c].left);
    sides[0].right.grow(sides[c].right);
  }
  return sides[0];
}

SideCentroids partitionMedian(Reference* references, uint32_t count, const Box& centroids,
                              const Measure& measure, ObjectSplit& split) {
  const int axis = widestAxis(centroids);
  split = {};
  split.axis = axis;
  split.left_count = count / 2;
  if (lane(centroids.high, axis) > lane(centroids.low, axis)) {
    std::nth_element(references, references + split.left_count, references + count,
                     [&](const Reference& a, const Reference& b) {
                       const float ca = lane(measure.centroid(a), axis), cb = lane(measure.centroid(b), axis);
                       return ca != cb ? ca < cb : a.id < b.id;
                     });
  }
  SideCentroids sides;
  for (uint32_t i = 0; i < count; ++i) {
    const Reference& r = references[i];
    const Float4 c = measure.centroid(r);
    (i < split.left_count ? split.left : split.right).grow(r.lowLanes(), r.highLanes());
    (i < split.left_count ? sides.left : sides.right).grow(c, c);
  }
  return sides;
}

}  // namespace sightline
