#version 460
// The glass that each of the given rays meets no farther than its given hit: pairs of ray and triangle, counted in the
// list's counter.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/trace.glsl"

void runItem(uint index) {
  walkGlass(kListGlass, index, SL_BUFFER(rays, index), SL_BUFFER(hits, index));
}
