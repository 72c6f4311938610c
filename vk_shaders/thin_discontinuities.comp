#version 460
// Of the border rays that met a discontinuity, a bit each, those that keepsDiscontinuity names.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/list.glsl"

void runItem(uint item) {
  thinDiscontinuitiesOf(kTheStage, item);
}
