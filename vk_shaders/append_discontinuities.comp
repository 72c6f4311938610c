#version 460
// Appends the discontinuities of the border rays in `indices` to those that wait.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/list.glsl"

void runItem(uint item) {
  appendDiscontinuityOf(kTheStage, item);
}
