#version 460
// The sides of the border polygons of the entries from border_first on, three an entry.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/list.glsl"

void runItem(uint item) {
  makeBorderEdge(kTheStage, item);
}
