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

namespace {

/// Share of a coordinate by which a computed point may be off; its box grows by so much. An interpolation
/// has about five roundings of 2^-24 each.
constexpr float kClipError = 0x1p-21f;
/// The same where products round to multiples of the least positive float.
constexpr float kLeastPad = 4 * std::numeric_limits<float>::denorm_min();
constexpr float kNoExtent = 1e-30f;

Float4 point4(glm::vec3 p) {
  const float f[4] = {p.x + 0.0f, p.y + 0.0f, p.z + 0.0f, 0};  // + 0: without negative zero
  return load4(f);
}

/// A triangle ready for cutting along one axis.
struct Corners {
  Float4 p[3];
  float along[3];
  float pad[4];

  Corners(const Triangles& t, uint32_t id) {
    const glm::uvec3 c = t.ids[id];
    glm::vec3 most(0);
    for (int i = 0; i < 3; ++i) {
      const glm::vec3 v = t.positions[c[i]];
      most = glm::max(most, glm::abs(v));
      p[i] = point4(v);
    }
    for (int i = 0; i < 3; ++i) pad[i] = most[i] * kClipError + kLeastPad;
    pad[3] = 0;
  }
  void turnTo(int axis) {
    for (int i = 0; i < 3; ++i) along[i] = lane(p[i], axis);
  }
  /// Bounds of the triangle's section with a plane, rounded outwards.
  Box section(float plane, float scale) const {
    Box box;
    for (int i = 0; i < 3; ++i) {
      const int j = i == 2 ? 0 : i + 1;
      const float a = along[i], b = along[j];
      if (!((a < plane && b > plane) || (a > plane && b < plane))) continue;
      const float t = (plane * scale - a * scale) / (b * scale - a * scale);
      const Float4 q = p[i] * splat4(1 - t) + p[j] * splat4(t);
      box.grow(q - load4(pad), q + load4(pad));
    }
    return box;
  }
};

/// A slab's part of a reference: what is known of the triangle there, within the reference and the slab.
Box within(Box part, const Reference& r, int axis, float slab_low, float slab_high) {
  alignas(16) float l[4], h[4];
  store4(l, max4(part.low, r.lowLanes()));
  store4(h, min4(part.high, r.highLanes()));
  l[axis] = std::max(r.low[axis], slab_low);
  h[axis] = std::min(r.high[axis], slab_high);
  return {load4(l) + splat4(0), load4(h) + splat4(0)};
}

float firstLane(Float4 a) {
  return lane(a, 0);
}

}  // namespace

SpatialMapping::SpatialMapping(const Box& box, const Measure& measure) : measure_(measure) {
  const float scale = firstLane(measure.scale);
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
  const float scale = firstLane(measure_.scale);
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

void SpatialBins::add(const Reference* references, uint32_t count, const SpatialMapping& mapping,
                      const Triangles& triangles) {
  const float scale = firstLane(triangles.measure.scale);
  for (const Reference* r = references; r != references + count; ++r) {
    uint32_t first[3], last[3];
    bool crosses = false;
    for (int a = 0; a < 3; ++a) {
      if (mapping.factor[a] == 0) continue;
      mapping.slabs(*r, a, first[a], last[a]);
      ++begins[a][first[a]];
      ++ends[a][last[a]];
      crosses = crosses || first[a] != last[a];
      if (first[a] == last[a]) box[a][first[a]].grow(r->lowLanes(), r->highLanes());
    }
    if (!crosses) continue;
    Corners corners(triangles, r->id);
    for (int a = 0; a < 3; ++a) {
      if (mapping.factor[a] == 0 || first[a] == last[a]) continue;
      corners.turnTo(a);
      const float* p = mapping.plane[a];
      Box before = corners.section(p[first[a]], scale);
      for (uint32_t b = first[a]; b <= last[a]; ++b) {
        const Box after = corners.section(p[b + 1], scale);
        Box part = before;
        part.grow(after);
        for (int i = 0; i < 3; ++i) {
          if (corners.along[i] >= p[b] && corners.along[i] <= p[b + 1]) part.grow(corners.p[i], corners.p[i]);
        }
        part = within(part, *r, a, p[b], p[b + 1]);
        if (!part.isEmpty()) box[a][b].grow(part);
        before = after;
      }
    }
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
  Corners corners(triangles, r.id);
  corners.turnTo(a);
  const Box section = corners.section(split.plane, firstLane(m.scale));
  Box part[2] = {section, section};
  for (int i = 0; i < 3; ++i) {
    if (corners.along[i] <= split.plane) part[0].grow(corners.p[i], corners.p[i]);
    if (corners.along[i] >= split.plane) part[1].grow(corners.p[i], corners.p[i]);
  }
  part[0] = within(part[0], r, a, r.low[a], split.plane);
  part[1] = within(part[1], r, a, split.plane, r.high[a]);
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
