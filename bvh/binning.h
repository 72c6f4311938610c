#pragma once
// Binned SAH: where to cut a set of references in two.
#include <cstdint>

#include "bvh/reference.h"

namespace sightline {

inline constexpr uint32_t kMaxBins = 16;

/// Maps centroids to bins along the three axes. All references of a node fall into [0, bins).
struct BinMapping {
  Float4 start;
  Float4 factor;  ///< 0 along an axis without extent
  uint32_t bins = 0;
  bool splits[3] = {};  ///< the axis has an extent

  BinMapping(const Box& centroids, uint32_t count);
  Int4 bin(Float4 centroid) const { return truncate4((centroid - start) * factor); }
};

/// A histogram of references for each axis.
struct Bins {
  Box box[3][kMaxBins];
  uint32_t count[3][kMaxBins] = {};

  /// Adds references[0..count).
  void add(const Reference* references, uint32_t count, const BinMapping& mapping, const Measure& measure);
  void merge(const Bins& other, uint32_t bins);
};

/// Cost of a leaf of n references in units of one triangle test: whole groups count, because the tracers
/// test four triangles at once.
inline float leafCost(uint32_t n) {
  return static_cast<float>(n);
}

/// Cut between bin - 1 and bin along an axis. `axis` < 0: there is none.
struct ObjectSplit {
  int axis = -1;
  uint32_t bin = 0;
  uint32_t left_count = 0;
  float cost = 0;  ///< sum over both sides of half area times leaf cost; the node's own area is not in it
  Box left, right;
};

/// The cheapest cut; among equal ones the first axis, then the lowest bin.
ObjectSplit findObjectSplit(const Bins& bins, const BinMapping& mapping, const Measure& measure);

}  // namespace sightline
