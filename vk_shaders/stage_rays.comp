#version 460
// The rays that a stage traces, without tracing them: to compare devices.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/list.glsl"

void runItem(uint item) {
  Ray ray;
  if (SL_LAUNCH(stage) == kStageRandom) {
    uint offset;
    slotRayAt(item, offset, ray);
  } else {
    ray = batchRayAt(kTheStage, item + 1u);
  }
  SL_BUFFER(rays, item) = ray;
}
