#version 460
// Nearest hits of given rays.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/trace.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 8) writeonly buffer Hits {
  Hit at[];
};

void runItem(uint index) {
  LeafHit found_leaf = nearestHit(Rays(SL_LAUNCH.rays).at[index]);
  Hit hit;
  hit.t = found_leaf.t;
  hit.triangle = triangleOf(found_leaf);
  Hits(SL_LAUNCH.hits).at[index] = hit;
}
