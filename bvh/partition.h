#pragma once
// Putting a node's references on the two sides of a cut.
#include <cstdint>
#include <vector>

#include "bvh/binning.h"

namespace sightline {

/// References handled by one thread at a time in nodes that many threads share. Fixed, so that the result
/// does not depend on the number of threads.
inline constexpr uint32_t kChunk = 1 << 14;

/// Bounds of the centroids on both sides.
struct SideCentroids {
  Box left, right;
};

/// Reorders references[0..count) in place: those left of the cut first.
SideCentroids partitionInPlace(Reference* references, uint32_t count, const BinMapping& mapping,
                               const ObjectSplit& split, const Measure& measure);

/// Copies references[0..count) to left and right, by all threads of the current arena. left_of_chunk: for
/// each chunk of kChunk references, how many lie left.
SideCentroids partitionParallel(const Reference* references, uint32_t count, Reference* left,
                                Reference* right, const BinMapping& mapping, const ObjectSplit& split,
                                const Measure& measure, const std::vector<uint32_t>& left_of_chunk);

/// Cuts into halves by count, at the median of the centroids along the widest axis: always possible.
SideCentroids partitionMedian(Reference* references, uint32_t count, const Box& centroids,
                              const Measure& measure, ObjectSplit& split);

}  // namespace sightline
