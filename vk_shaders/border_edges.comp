#version 460
// The sides of the border polygons of the entries from border_first on, three an entry: many rays share one.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/list.glsl"
#include "vk_shaders/sampling.glsl"

void runItem(uint item) {
  BorderEdges(SL_LAUNCH.border_edges).at[item] = borderEdgeAt(item / 3u, item % 3u);
}
