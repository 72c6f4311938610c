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
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer ReverseItems {
  ReverseItem at[];
};

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

/// Border ray `index` (0 ..) of the last border launch. Needs what border_edges wrote.
Ray borderRayAt(uint index) {
  StageParams params = SL_LAUNCH.params;
  uint per_entry = borderRayCount(params);
  uint entry_index = index / per_entry;
  uint k = index - entry_index * per_entry;
  uvec4 entry = Entries(SL_LAUNCH.entries).at[SL_LAUNCH.border_first + entry_index].origin_triangle;
  if (isGvs(params)) {
    vec3 first = borderVertexAt(entry_index, gvsFirstVertex(k));
    return rayTo(borderOrigin(entry), gvsPoint(first, borderVertexAt(entry_index, gvsSecondVertex(k)), k));
  }
  BorderEdge edge = BorderEdges(SL_LAUNCH.border_edges).at[3u * entry_index + borderSide(k, params)];
  return borderRay(edge, k, borderOrigin(entry), params);
}

/// The original method's item of a discontinuity of the launch's entry.
ReverseItem gvsReverseItemAt(ReverseItem item, uint entry_index) {
  PvsEntry entry = Entries(SL_LAUNCH.entries).at[SL_LAUNCH.border_first + entry_index];
  uint leaf = borderLeaf(entry_index);
  Ray ray;
  ray.origin = vec4(borderOrigin(entry.origin_triangle), 0.0f);
  ray.direction = vec4(borderOrigin(entry.direction_stage), 0.0f);
  return gvsReverseItem(item, ray, leafCorner(leaf, 0u), leafCorner(leaf, 1u), leafCorner(leaf, 2u),
                        SL_LAUNCH.params);
}

/// Discontinuity `place` (0 ..) of the last border launch: for reverse_items.
ReverseItem reverseItemAt(uint place) {
  uint border_index = Words(SL_LAUNCH.discontinuities).at[place];
  Ray border = borderRayAt(border_index);
  vec3 target = add3(xyz3(border.origin), xyz3(border.direction));
  uint64 number = SL_LAUNCH.items_before + place;
  uint mask = 0u;
  for (uint f = 0u; f < SL_LAUNCH.params.counts.w; ++f) {
    mask |= (faceLooksAt(Faces(SL_LAUNCH.faces).at[f], target) ? 1u : 0u) << f;
  }
  ReverseItem item;
  item.target = vec4(target.x, target.y, target.z, 0.0f);
  uint occluder = Words(SL_LAUNCH.border_hits).at[border_index];
  bool occluded = occluder != kNoTriangle;
  item.number = uvec4(uint(number), uint(number >> 32), mask, occluded ? 1u : 0u);
  item.a = occluded ? vec4(leafCorner(occluder, 0u), 0.0f) : vec4(0.0f);
  item.b = occluded ? vec4(leafCorner(occluder, 1u), 0.0f) : vec4(0.0f);
  item.c = occluded ? vec4(leafCorner(occluder, 2u), 0.0f) : vec4(0.0f);
  return isGvs(SL_LAUNCH.params) ? gvsReverseItemAt(item, border_index / kGvsPositions) : item;
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
      ray = gvsReverseRay(item, Faces(SL_LAUNCH.faces).at[f], k);
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
