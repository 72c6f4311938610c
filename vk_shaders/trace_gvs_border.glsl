#version 460
// Border rays of the original method, one level a launch (core/shared/gvs_border.h): the slots of the entries
// from border_first on; traces those whose neighbours hit different triangles. Notes as trace_border does.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/trace.glsl"

/// The triangle that the border ray hit, kNoTriangle or kNotTraced.
uint borderTriangle(uint index) {
  uint leaf = Words(SL_LAUNCH.border_hits).at[index];
  return leaf >= kNotTraced ? leaf : Words(SL_LAUNCH.leaf_ids).at[leaf];
}

bool divides(uint entry, uint level, uint position) {
  return level == 0u || gvsDivides(borderTriangle(entry + gvsBefore(level, position)),
                                   borderTriangle(entry + gvsAfter(level, position)));
}

void runItem(uint slot) {
  uint level = SL_LAUNCH.level;
  uint entry = slot / gvsSlots(level);
  uint position = gvsPosition(level, slot % gvsSlots(level));
  uint index = entry * kGvsPositions + position;
  if (!divides(entry * kGvsPositions, level, position)) return;
  Ray ray = borderRayAt(index);
  if (!hasDirection(ray)) return;
  LeafHit found_leaf = nearestHit(ray);
  Hit hit;
  hit.t = found_leaf.t;
  hit.triangle = triangleOf(found_leaf);
  Words(SL_LAUNCH.border_hits).at[index] = found_leaf.leaf;
  insertHit(kTheSet, hit.triangle, index + 1u);
  uint leaf = borderLeaf(entry);
  vec3 p0 = leafCorner(leaf, 0u);
  if (isGvsDiscontinuity(ray, hit, p0, leafCorner(leaf, 1u), leafCorner(leaf, 2u), SL_LAUNCH.params)) {
    atomicOr(Words(SL_LAUNCH.bits).at[index >> 5], 1u << (index & 31u));
  }
  countRay(index);
}
