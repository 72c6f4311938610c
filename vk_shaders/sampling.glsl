// The rays of a batch by their index: random, border and reverse.
#ifndef SL_SAMPLING_GLSL
#define SL_SAMPLING_GLSL
#include "vk_shaders/state.glsl"
#include "core/shared/border.h"
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

/// Origin of the border rays of an entry.
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

/// Border ray `index` (0 ..) of the last border launch. Needs what border_edges wrote.
Ray borderRayAt(uint index) {
  StageParams params = SL_LAUNCH.params;
  uint per_entry = borderRayCount(params);
  uint entry_index = index / per_entry;
  uint k = index - entry_index * per_entry;
  uvec4 entry = Entries(SL_LAUNCH.entries).at[SL_LAUNCH.border_first + entry_index].origin_triangle;
  BorderEdge edge = BorderEdges(SL_LAUNCH.border_edges).at[3u * entry_index + borderSide(k, params)];
  return borderRay(edge, k, borderOrigin(entry), params);
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
  return item;
}

/// Reverse ray `index` (0 ..) of the reverse launch, or none. Needs what reverse_items wrote.
Ray reverseRayAt(uint index) {
  StageParams params = SL_LAUNCH.params;
  uint per_item = reverseRayCount(params);
  uint place = index / per_item;
  uint k = index - place * per_item;
  ReverseItem item = ReverseItems(SL_LAUNCH.reverse_items).at[place];
  if (item.number.z == 0u) return noRay();
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
