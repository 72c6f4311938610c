#version 460
// Border rays of the original method, one level a launch (core/shared/gvs_border.h): the slots of the entries
// from border_first on; traces those whose neighbours hit different triangles. Notes as trace_border does.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/trace.glsl"

void runItem(uint slot) {
  uint level = SL_LAUNCH(level);
  uint entry = slot / gvsSlots(level);
  uint position = gvsPosition(level, slot % gvsSlots(level));
  uint first = entry * kGvsPositions;
  if (level > 0u && !gvsDivides(SL_BUFFER(border_hits, first + gvsBefore(level, position)),
                                SL_BUFFER(border_hits, first + gvsAfter(level, position)))) {
    return;
  }
  Ray ray = borderRayAt(kTheStage, entry, position);
  if (!hasDirection(ray)) return;
  uint index = first + position;
  Hit hit = insertSight(ray, index + 1u);
  SL_BUFFER(border_hits, index) = hit.triangle;
  Corners t = cornersOf(SL_BUFFER(entries, SL_LAUNCH(border_first) + entry).origin_triangle.w);
  if (isGvsDiscontinuity(ray, hit, t.a, t.b, t.c, SL_LAUNCH(params))) {
    atomicOr(SL_BUFFER(bits, index >> 5), 1u << (index & 31u));
  }
  countRay(index);
}
