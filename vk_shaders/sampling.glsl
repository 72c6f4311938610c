// The rays of a batch by their index: random, border and reverse.
#ifndef SL_SAMPLING_GLSL
#define SL_SAMPLING_GLSL
#include "vk_shaders/state.glsl"
#include "core/shared/border.h"
#include "core/shared/gvs_reverse.h"
#include "core/shared/random_ray.h"
#include "core/shared/reverse.h"

/// Corner 0, 1 or 2 of the triangle in a leaf.
vec3 leafCorner(uint leaf, uint corner) {
  Floats corners = Floats(SL_LAUNCH.corners + 36ul * leaf);
  return vec3(corners.at[3u * corner], corners.at[3u * corner + 1u], corners.at[3u * corner + 2u]);
}

layout(buffer_reference, scalar, buffer_reference_align = 16) buffer BorderEdges {
  BorderEdge at[];
};
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Discontinuities {
  Discontinuity at[];
};
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer ReverseItems {
  ReverseItem at[];
};

/// The entry of the border batch that border ray `index` belongs to. Needs what sum_border_rays wrote, but for
/// the original method.
uint borderEntryOf(uint index) {
  if (isGvs(SL_LAUNCH.params)) return index / kGvsPositions;
  Words starts = Words(SL_LAUNCH.border_starts);
  uint low = 0u;
  uint high = SL_LAUNCH.border_count;
  while (high - low > 1u) {
    uint middle = (low + high) / 2u;
    if (starts.at[middle] <= index) {
      low = middle;
    } else {
      high = middle;
    }
  }
  return low;
}

/// Which ray of its entry's polygon border ray `index` is.
uint borderRayOf(uint index, uint entry_index) {
  if (isGvs(SL_LAUNCH.params)) return index - entry_index * kGvsPositions;
  return index - Words(SL_LAUNCH.border_starts).at[entry_index];
}

/// Samples between the ends of the long edges of the entry's polygon. Needs what border_edges wrote.
uint borderSamplesAt(uint entry_index) {
  return uint(BorderEdges(SL_LAUNCH.border_edges).at[3u * entry_index].bisector.w);
}

/// The leaf of the launch's entry `entry_index`.
uint borderLeaf(uint entry_index) {
  uint triangle = Entries(SL_LAUNCH.entries).at[SL_LAUNCH.border_first + entry_index].origin_triangle.w;
  return Words(SL_LAUNCH.leaf_of).at[triangle];
}

/// Origin of the border rays of an entry, or another vector by its bits.
vec3 borderOrigin(uvec4 entry) {
  return vec3(uintBitsToFloat(entry.x), uintBitsToFloat(entry.y), uintBitsToFloat(entry.z));
}

/// Side 0, 1 or 2 of the border polygon of the launch's entry `entry_index`: for border_edges.
BorderEdge borderEdgeAt(uint entry_index, uint side) {
  uvec4 entry = Entries(SL_LAUNCH.entries).at[SL_LAUNCH.border_first + entry_index].origin_triangle;
  uint leaf = Words(SL_LAUNCH.leaf_of).at[entry.w];
  return borderEdge(leafCorner(leaf, 0u), leafCorner(leaf, 1u), leafCorner(leaf, 2u), side,
                    borderOrigin(entry), SL_LAUNCH.params);
}

/// Vertex 0 .. 8 of the border polygon of the launch's entry. Needs what border_edges wrote.
vec3 borderVertexAt(uint entry_index, uint vertex) {
  return gvsVertexOf(BorderEdges(SL_LAUNCH.border_edges).at[3u * entry_index + vertex / 3u], vertex);
}

/// Border ray `index` (0 ..) of the border batch. Needs what border_edges wrote.
Ray borderRayAt(uint index) {
  StageParams params = SL_LAUNCH.params;
  uint entry_index = borderEntryOf(index);
  uint k = borderRayOf(index, entry_index);
  uvec4 entry = Entries(SL_LAUNCH.entries).at[SL_LAUNCH.border_first + entry_index].origin_triangle;
  if (isGvs(params)) {
    vec3 first = borderVertexAt(entry_index, gvsFirstVertex(k));
    vec3 second = borderVertexAt(entry_index, gvsSecondVertex(k));
    return gvsBorderRay(first, second, k, borderOrigin(entry), params);
  }
  uint side = borderSide(k, borderSamplesAt(entry_index));
  BorderEdge edge = BorderEdges(SL_LAUNCH.border_edges).at[3u * entry_index + side];
  return borderRay(edge, k, borderOrigin(entry), params);
}

/// The item of discontinuity `place` (0 ..) of those that wait: for reverse_items.
ReverseItem reverseItemAt(uint place) {
  StageParams params = SL_LAUNCH.params;
  uvec4 ray = Discontinuities(SL_LAUNCH.discontinuities).at[place].ray;
  PvsEntry entry = Entries(SL_LAUNCH.entries).at[ray.x];
  uint leaf = Words(SL_LAUNCH.leaf_of).at[entry.origin_triangle.w];
  vec3 p0 = leafCorner(leaf, 0u);
  vec3 p1 = leafCorner(leaf, 1u);
  vec3 p2 = leafCorner(leaf, 2u);
  vec3 origin = borderOrigin(entry.origin_triangle);
  Ray border = polygonRay(p0, p1, p2, ray.y, ray.w, origin, params);
  vec3 target = add3(xyz3(border.origin), xyz3(border.direction));
  uint64 number = SL_LAUNCH.items_before + place;
  uint mask = 0u;
  for (uint f = 0u; f < params.counts.w; ++f) {
    mask |= (faceLooksAt(Faces(SL_LAUNCH.faces).at[f], target) ? 1u : 0u) << f;
  }
  ReverseItem item = openItem(target, number, mask);
  if (ray.z != kNoTriangle) {
    item = occludedItem(item, leafCorner(ray.z, 0u), leafCorner(ray.z, 1u), leafCorner(ray.z, 2u));
  }
  if (!isGvs(params)) return item;
  Ray found;
  found.origin = vec4(origin, 0.0f);
  found.direction = vec4(borderOrigin(entry.direction_stage), 0.0f);
  return gvsReverseItem(item, found, p0, p1, p2, params);
}

/// Reverse ray `index` (0 ..) of the reverse launch, or none. Needs what reverse_items wrote.
Ray reverseRayAt(uint index) {
  StageParams params = SL_LAUNCH.params;
  uint per_item = reverseRayCount(params);
  uint place = index / per_item;
  uint k = index - place * per_item;
  ReverseItem item = ReverseItems(SL_LAUNCH.reverse_items).at[place];
  if (item.number.z == 0u) return noRay();
  if (isGvs(params)) {
    Ray ray = noRay();
    for (uint f = 0u; f < params.counts.w && !hasDirection(ray); ++f) {
      ray = gvsReverseRay(item, Faces(SL_LAUNCH.faces).at[f], k, params);
    }
    return ray;
  }
  return reverseRay(item, Faces(SL_LAUNCH.faces).at[reverseFace(item, k)], k, params);
}

/// The random ray that a slot of the launch's segment traces, and its offset there. false: the slot has none.
bool slotRayAt(uint slot, out uint offset, out Ray ray) {
  RandomSegment segment = SL_LAUNCH.segment;
  offset = slotOffset(segment, slot);
  ray = noRay();
  if (offset == kNoTriangle) return false;
  ray = offsetRay(segment, Faces(SL_LAUNCH.faces).at[segment.range.x], SL_LAUNCH.shifts, offset);
  return true;
}

/// The random ray with this index (1 ..) in the batch.
Ray segmentRayAt(uint index) {
  for (uint s = 0u; s < SL_LAUNCH.segment_count; ++s) {
    RandomSegment segment = Segments(SL_LAUNCH.segments).at[s];
    uint offset = index - segment.batch.x;
    if (offset < segment.range.w) {
      Face face = Faces(SL_LAUNCH.faces).at[segment.range.x];
      return randomRay(segmentFirst(segment), offset, face, SL_LAUNCH.params.shifts);
    }
  }
  return noRay();
}

#endif
