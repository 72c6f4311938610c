#version 460
// Moves the contents of a hash set into a larger one.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/list.glsl"

void runItem(uint item) {
  rehashOf(kTheStage, item);
}
