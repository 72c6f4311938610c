// Based on: I. Wald, On fast Construction of SAH-based Bounding Volume Hierarchies, 2007. As in Embree, small
// nodes get fewer bins. Minima, maxima and counts do not depend on the order in which references arrive, so
// neither does the tree.
#include "bvh/binning.h"

#include <algorithm>

namespace sightline {

namespace {

/// Just below 1, so that the highest centroid falls into the last bin and not past it.
constexpr float kJustBelowOne = 0.99999f;

}  // namespace

BinMapping::BinMapping(const Box& centroids, uint32_t count) : start(centroids.low) {
  bins = std::min(kMaxBins, 4 + count / 16);
  alignas(16) float extent[4], f[4] = {};
  store4(extent, centroids.high - centroids.low);
  for (int a = 0; a < 3; ++a) {
    splits[a] = extent[a] > kNoExtent;
    if (splits[a]) f[a] = static_cast<float>(bins) * kJustBelowOne / extent[a];
  }
  factor = load4(f);
}

void Bins::add(const Reference* references, uint32_t n, const BinMapping& mapping, const Measure& measure) {
  for (const Reference* r = references; r != references + n; ++r) {
    const Int4 b = mapping.bin(measure.centroid(*r));
    const Float4 low = r->lowLanes(), high = r->highLanes();
    for (int a = 0; a < 3; ++a) {
      box[a][b.v[a]].grow(low, high);
      ++count[a][b.v[a]];
    }
  }
}

void Bins::merge(const Bins& other, uint32_t bins) {
  for (int a = 0; a < 3; ++a) {
    for (uint32_t b = 0; b < bins; ++b) {
      box[a][b].grow(other.box[a][b]);
      count[a][b] += other.count[a][b];
    }
  }
}

ObjectSplit findObjectSplit(const Bins& bins, const BinMapping& mapping, const Measure& measure) {
  ObjectSplit best;
  for (int a = 0; a < 3; ++a) {
    if (!mapping.splits[a]) continue;
    float right_cost[kMaxBins] = {};
    Box right;
    uint32_t n = 0;
    for (uint32_t b = mapping.bins; b-- > 1;) {
      n += bins.count[a][b];
      right.grow(bins.box[a][b]);
      if (n) right_cost[b] = measure.halfArea(right) * leafCost(n);
    }
    const uint32_t total = n + bins.count[a][0];
    Box left;
    n = 0;
    for (uint32_t b = 1; b < mapping.bins; ++b) {
      n += bins.count[a][b - 1];
      left.grow(bins.box[a][b - 1]);
      if (n == 0 || n == total) continue;
      const float cost = measure.halfArea(left) * leafCost(n) + right_cost[b];
      if (best.axis < 0 || cost < best.cost) {
        best.axis = a;
        best.bin = b;
        best.left_count = n;
        best.cost = cost;
      }
    }
  }
  if (best.axis < 0) return best;
  for (uint32_t b = 0; b < mapping.bins; ++b) {
    (b < best.bin ? best.left : best.right).grow(bins.box[best.axis][b]);
  }
  return best;
}

}  // namespace sightline
