#version 460
// Border rays of the entries from border_first on; notes what each hit and, a bit a ray, whether it met a
// discontinuity. There may be more work items than rays.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/trace.glsl"

void runItem(uint index) {
  if (index >= SL_BUFFER(border_starts, SL_LAUNCH(border_count))) return;
  Ray ray = borderRayByIndex(index);
  Hit hit = insertSight(ray, index + 1u);
  SL_BUFFER(border_hits, index) = hit.triangle;
  if (isDiscontinuity(ray, hit, SL_LAUNCH(params))) {
    atomicOr(SL_BUFFER(bits, index >> 5), 1u << (index & 31u));
  }
  if (hasDirection(ray)) countRay(index);
}
