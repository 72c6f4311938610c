#version 460
// The discontinuities from reverse_first on, with all that their rays share.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/list.glsl"

void runItem(uint item) {
  makeReverseItem(kTheStage, item);
}
