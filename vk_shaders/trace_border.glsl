#version 460
// Border rays of the entries from border_first on; notes what each hit and, a bit a ray, whether it met a
// discontinuity. There may be more work items than rays.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/trace.glsl"

void runItem(uint index) {
  if (index >= Words(SL_LAUNCH.border_starts).at[SL_LAUNCH.border_count]) return;
  Ray ray = borderRayAt(index);
  LeafHit found_leaf = nearestHit(ray);
  Hit hit;
  hit.t = found_leaf.t;
  hit.triangle = triangleOf(found_leaf);
  Words(SL_LAUNCH.border_hits).at[index] = found_leaf.leaf;
  insertHit(kTheSet, hit.triangle, index + 1u);
  if (isDiscontinuity(ray, hit, SL_LAUNCH.params)) {
    atomicOr(Words(SL_LAUNCH.bits).at[index >> 5], 1u << (index & 31u));
  }
  if (hasDirection(ray)) countRay(index);
}
