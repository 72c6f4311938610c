#version 460
// The rays that a stage traces, without tracing them: to compare devices.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/list.glsl"
#include "vk_shaders/sampling.glsl"

void runItem(uint item) {
  uint stage = SL_LAUNCH.stage;
  Ray ray;
  if (stage == kStageRandom) {
    RandomSegment segment = SL_LAUNCH.segment;
    Face face = Faces(SL_LAUNCH.faces).at[segment.range.x];
    ray = offsetRay(segment, face, SL_LAUNCH.shifts, slotOffset(segment, item));
  } else if (stage == kStageBorder) {
    ray = borderRayAt(item);
  } else {
    ray = reverseRayAt(item);
  }
  Rays(SL_LAUNCH.rays).at[item] = ray;
}
