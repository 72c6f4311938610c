#pragma once
// Spatial splits: cutting a node at a plane, where triangles that cross it go to both sides, each side with
// the box of its part.
#include <cstdint>
#include <vector>

#include "bvh/clip.h"
#include "bvh/partition.h"
#include "bvh/reference.h"

namespace sightline {

inline constexpr uint32_t kSpatialBins = 16;

struct SpatialBins;

/// The planes at which a node may be cut: the borders of kSpatialBins slabs of equal width an axis.
struct SpatialMapping {
  float plane[3][kSpatialBins + 1];
  float start[3], factor[3];  ///< factor 0: no split along the axis

  SpatialMapping(const Box& box, const Measure& measure);
  /// Slabs that a reference reaches into, first <= last.
  void slabs(const Reference& r, int axis, uint32_t& first, uint32_t& last) const;
  /// Gives up the axes whose every plane would make more than `extra` references; false: none is left.
  bool keepAffordable(const SpatialBins& bins, uint32_t count, uint32_t extra);

 private:
  Measure measure_;
};

/// For each slab the bounds of the parts in it, and how many references begin and end there. Counting comes
/// first, since it is cheap and may show that no plane is affordable.
struct SpatialBins {
  Box box[3][kSpatialBins];
  uint32_t begins[3][kSpatialBins] = {};
  uint32_t ends[3][kSpatialBins] = {};

  void addCounts(const Reference* references, uint32_t count, const SpatialMapping& mapping);
  void addBoxes(const Reference* references, uint32_t count, const SpatialMapping& mapping,
                const Triangles& triangles);
  void merge(const SpatialBins& other);

 private:
  void addParts(const Reference& r, int axis, uint32_t first, uint32_t last, const SpatialMapping& mapping,
                Clipper& clipper);
};

/// A cut at a plane; `axis` < 0: none is possible.
struct SpatialSplit {
  int axis = -1;
  float plane = 0;
  uint32_t left_count = 0, right_count = 0;
  float cost = 0;  ///< as in ObjectSplit
  Box left, right;
};

/// The cheapest plane that makes at most `extra` more references; of equal ones the first.
SpatialSplit findSpatialSplit(const SpatialBins& bins, const SpatialMapping& mapping, uint32_t count,
                              uint32_t extra, const Measure& measure);

enum class Side { kLeft, kRight, kBoth };

/// Where a reference goes. If to both sides, left and right become its parts. A triangle that crosses the
/// plane still goes to one side alone where that is cheaper.
Side sideOf(const Reference& r, const SpatialSplit& split, const Triangles& triangles, Reference& left,
            Reference& right);

/// Both sides of a partition: counts, boxes and boxes of the centroids.
struct SpatialSides {
  uint32_t left_count = 0, right_count = 0;
  Box left, right;
  SideCentroids centroids;
};

/// In place: left ones first, right after them without a gap; there must be room behind for the doubled ones.
SpatialSides partitionSpatialInPlace(Reference* references, uint32_t count, const SpatialSplit& split,
                                     const Triangles& triangles);

/// By all threads of the arena, from references to target: left ones at its begin, the right ones
/// after room for the left side's share of what remains of `extra`.
SpatialSides partitionSpatialParallel(const Reference* references, Reference* target, uint32_t count,
                                      uint32_t extra, const SpatialSplit& split, const Triangles& triangles);

/// How much of `extra` the left side gets: in proportion to its references.
inline uint32_t leftShare(uint32_t extra, uint32_t left, uint32_t right) {
  return static_cast<uint32_t>(uint64_t{extra} * left / (uint64_t{left} + right));
}

}  // namespace sightline
