// Based on: M. Stich, H. Friedrich, A. Dietrich, Spatial Splits in Bounding Volume Hierarchies, 2009, with
// its reference unsplitting. Where we differ: the number of additional references is bounded, every node
// has a share of the bound in proportion to its size, and unsplitting weighs each reference against the
// boxes found by binning, so that the order of the references does not matter.
#include "bvh/spatial.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <utility>

namespace sightline {

SpatialMapping::SpatialMapping(const Box& box, const Measure& measure) : measure_(measure) {
  const float scale = lane(measure.scale, 0);
  for (int a = 0; a < 3; ++a) {
    const float low = lane(box.low, a), high = lane(box.high, a);
    for (uint32_t i = 0; i <= kSpatialBins; ++i) {
      const float f = static_cast<float>(i) / kSpatialBins;
      plane[a][i] = std::min(low * (1 - f) + high * f + 0.0f, high);
      if (i > 0) plane[a][i] = std::max(plane[a][i - 1], plane[a][i]);
    }
    const float extent = high * scale - low * scale;
    start[a] = low * scale;
    factor[a] = extent > kNoExtent ? kSpatialBins / extent : 0;
  }
}

void SpatialMapping::slabs(const Reference& r, int axis, uint32_t& first, uint32_t& last) const {
  const float scale = lane(measure_.scale, 0);
  const auto guess = [&](float x) {
    const float b = (x * scale - start[axis]) * factor[axis];
    return static_cast<uint32_t>(std::clamp(b, 0.0f, static_cast<float>(kSpatialBins - 1)));
  };
  const float* p = plane[axis];
  first = guess(r.low[axis]);
  while (first > 0 && p[first] > r.low[axis]) --first;
  while (first + 1 < kSpatialBins && p[first + 1] <= r.low[axis]) ++first;
  last = std::max(first, guess(r.high[axis]));
  while (last + 1 < kSpatialBins && p[last + 1] < r.high[axis]) ++last;
  while (last > first && p[last] >= r.high[axis]) --last;
}

bool SpatialMapping::keepAffordable(const SpatialBins& bins, uint32_t count, uint32_t extra) {
  bool any = false;
  for (int a = 0; a < 3; ++a) {
    uint32_t left = 0, ended = 0;
    bool affordable = false;
    for (uint32_t b = 1; b < kSpatialBins; ++b) {
      left += bins.begins[a][b - 1];
      ended += bins.ends[a][b - 1];
      const uint32_t doubled = left - ended;
      affordable = affordable || (left > 0 && ended < count && doubled <= extra);
    }
    if (!affordable) factor[a] = 0;
    any = any || factor[a] != 0;
  }
  return any;
}

void SpatialBins::addCounts(const Reference* references, uint32_t count, const SpatialMapping& mapping) {
  for (int a = 0; a < 3; ++a) {
    if (mapping.factor[a] == 0) continue;
    for (const Reference* r = references; r != references + count; ++r) {
      uint32_t first, last;
      mapping.slabs(*r, a, first, last);
      ++begins[a][first];
      ++ends[a][last];
    }
  }
}

void SpatialBins::addBoxes(const Reference* references, uint32_t count, const SpatialMapping& mapping,
                           const Triangles& triangles) {
  for (const Reference* r = references; r != references + count; ++r) {
    uint32_t first[3] = {}, last[3] = {};
    for (int a = 0; a < 3; ++a) {
      if (mapping.factor[a] == 0) continue;
      mapping.slabs(*r, a, first[a], last[a]);
      if (first[a] == last[a]) box[a][first[a]].grow(r->lowLanes(), r->highLanes());
    }
    if (first[0] == last[0] && first[1] == last[1] && first[2] == last[2]) continue;
    Clipper clipper(triangles, r->id);
    for (int a = 0; a < 3; ++a) {
      if (first[a] != last[a]) addParts(*r, a, first[a], last[a], mapping, clipper);
    }
  }
}

void SpatialBins::addParts(const Reference& r, int axis, uint32_t first, uint32_t last,
                           const SpatialMapping& mapping, Clipper& clipper) {
  clipper.turnTo(axis);
  const float* plane = mapping.plane[axis];
  Box before = clipper.section(plane[first]);
  for (uint32_t b = first; b <= last; ++b) {
    const Box after = clipper.section(plane[b + 1]);
    before.grow(after);
    const Box part = clipper.part(before, r, plane[b], plane[b + 1]);
    if (!part.isEmpty()) box[axis][b].grow(part);
    before = after;
  }
}

void SpatialBins::merge(const SpatialBins& other) {
  for (int a = 0; a < 3; ++a) {
    for (uint32_t b = 0; b < kSpatialBins; ++b) {
      box[a][b].grow(other.box[a][b]);
      begins[a][b] += other.begins[a][b];
      ends[a][b] += other.ends[a][b];
    }
  }
}

SpatialSplit findSpatialSplit(const SpatialBins& bins, const SpatialMapping& mapping, uint32_t count,
                              uint32_t extra, const Measure& measure) {
  SpatialSplit best;
  for (int a = 0; a < 3; ++a) {
    if (mapping.factor[a] == 0) continue;
    Box right[kSpatialBins];
    uint32_t right_count[kSpatialBins] = {};
    Box box;
    uint32_t n = 0;
    for (uint32_t b = kSpatialBins; b-- > 1;) {
      box.grow(bins.box[a][b]);
      n += bins.ends[a][b];
      right[b] = box;
      right_count[b] = n;
    }
    box = Box();
    n = 0;
    for (uint32_t b = 1; b < kSpatialBins; ++b) {
      box.grow(bins.box[a][b - 1]);
      n += bins.begins[a][b - 1];
      if (n == 0 || right_count[b] == 0 || box.isEmpty() || right[b].isEmpty()) continue;
      if (uint64_t{n} + right_count[b] > uint64_t{count} + extra) continue;
      const float cost =
          measure.halfArea(box) * leafCost(n) + measure.halfArea(right[b]) * leafCost(right_count[b]);
      if (best.axis < 0 || cost < best.cost) {
        best = {a, mapping.plane[a][b], n, right_count[b], cost, box, right[b]};
      }
    }
  }
  return best;
}

Side sideOf(const Reference& r, const SpatialSplit& split, const Triangles& triangles, Reference& left,
            Reference& right) {
  const int a = split.axis;
  if (r.low[a] >= split.plane) return Side::kRight;
  if (r.high[a] <= split.plane) return Side::kLeft;
  const Measure& m = triangles.measure;
  Clipper clipper(triangles, r.id);
  clipper.turnTo(a);
  const Box section = clipper.section(split.plane);
  const Box part[2] = {clipper.part(section, r, -std::numeric_limits<float>::infinity(), split.plane),
                       clipper.part(section, r, split.plane, std::numeric_limits<float>::infinity())};
  if (part[0].isEmpty()) return Side::kRight;
  if (part[1].isEmpty()) return Side::kLeft;

  const float l = m.halfArea(split.left), h = m.halfArea(split.right);
  Box left_all = split.left, right_all = split.right;
  left_all.grow(r.lowLanes(), r.highLanes());
  right_all.grow(r.lowLanes(), r.highLanes());
  const float both = l * leafCost(split.left_count) + h * leafCost(split.right_count);
  const float only_left =
      m.halfArea(left_all) * leafCost(split.left_count) + h * leafCost(split.right_count - 1);
  const float only_right =
      l * leafCost(split.left_count - 1) + m.halfArea(right_all) * leafCost(split.right_count);
  if (only_left <= both && only_left <= only_right) return Side::kLeft;
  if (only_right <= both) return Side::kRight;

  Reference* const parts[2] = {&left, &right};
  for (int i = 0; i < 2; ++i) {
    alignas(16) float low[4], high[4];
    store4(low, part[i].low);
    store4(high, part[i].high);
    *parts[i] = {{low[0], low[1], low[2]}, r.id, {high[0], high[1], high[2]}, 0};
  }
  return Side::kBoth;
}

namespace {

void growLeft(SpatialSides& s, const Reference& r, const Measure& measure) {
  const Float4 c = measure.centroid(r);
  s.left.grow(r.lowLanes(), r.highLanes());
  s.centroids.left.grow(c, c);
  ++s.left_count;
}

void growRight(SpatialSides& s, const Reference& r, const Measure& measure) {
  const Float4 c = measure.centroid(r);
  s.right.grow(r.lowLanes(), r.highLanes());
  s.centroids.right.grow(c, c);
  ++s.right_count;
}

}  // namespace

SpatialSides partitionSpatialInPlace(Reference* references, uint32_t count, const SpatialSplit& split,
                                     const Triangles& triangles) {
  SpatialSides sides;
  Reference* l = references;
  Reference* r = references + count;
  Reference* end = r;
  Reference left, right;
  while (l != r) {
    const Side side = sideOf(*l, split, triangles, left, right);
    if (side == Side::kRight) {
      growRight(sides, *l, triangles.measure);
      std::swap(*l, *--r);
      continue;
    }
    if (side == Side::kBoth) {
      growRight(sides, right, triangles.measure);
      *end++ = right;
      *l = left;
    }
    growLeft(sides, *l++, triangles.measure);
  }
  return sides;
}

SpatialSides partitionSpatialParallel(const Reference* references, Reference* target, uint32_t count,
                                      uint32_t extra, const SpatialSplit& split, const Triangles& triangles) {
  const uint32_t chunks = (count + kChunk - 1) / kChunk;
  std::vector<SpatialSides> sides(chunks);
  std::vector<uint32_t> left_start(chunks), right_start(chunks);
  const auto forChunk = [&](uint32_t c, auto&& f) {
    Reference left, right;
    for (uint32_t i = c * kChunk; i < std::min(count, (c + 1) * kChunk); ++i) {
      const Side side = sideOf(references[i], split, triangles, left, right);
      const bool both = side == Side::kBoth;
      if (side != Side::kRight) f(true, both ? left : references[i]);
      if (side != Side::kLeft) f(false, both ? right : references[i]);
    }
  };
  tbb::parallel_for(0u, chunks, [&](uint32_t c) {
    SpatialSides s;
    forChunk(c, [&](bool left, const Reference& r) {
      left ? growLeft(s, r, triangles.measure) : growRight(s, r, triangles.measure);
    });
    sides[c] = s;
  });
  SpatialSides all;
  for (uint32_t c = 0; c < chunks; ++c) {
    left_start[c] = all.left_count;
    right_start[c] = all.right_count;
    all.left_count += sides[c].left_count;
    all.right_count += sides[c].right_count;
    all.left.grow(sides[c].left);
    all.right.grow(sides[c].right);
    all.centroids.left.grow(sides[c].centroids.left);
    all.centroids.right.grow(sides[c].centroids.right);
  }
  if (all.left_count == 0 || all.right_count == 0) return all;
  const uint32_t remaining = extra - (all.left_count + all.right_count - count);
  Reference* const first_right =
      target + all.left_count + leftShare(remaining, all.left_count, all.right_count);
  tbb::parallel_for(0u, chunks, [&](uint32_t c) {
    Reference* l = target + left_start[c];
    Reference* r = first_right + right_start[c];
    forChunk(c, [&](bool left, const Reference& reference) { *(left ? l : r)++ = reference; });
  });
  return all;
}

}  // namespace sightline
