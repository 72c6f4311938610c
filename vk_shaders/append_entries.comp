#version 460
// Appends the new triangles of a batch to the list, each with the ray that won it, and marks their slots as
// old.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/list.glsl"
#include "vk_shaders/sampling.glsl"
#include "vk_shaders/views.glsl"
#include "core/shared/hemicube.h"

/// The ray through the centre of the pixel of sample `index` (0 ..) of a batch of hemicubes.
Ray hemicubeRayAt(uint index) {
  uint resolution = SL_LAUNCH.raster_resolution;
  uint samples = hemicubeSamples(resolution);
  uint place = index % samples;
  uint view = index / samples * kHemicubeViews + hemicubeView(place, resolution);
  uint pixel = hemicubePixel(place, resolution);
  return viewRay(Views(SL_LAUNCH.hemicubes).at[view], pixel % resolution, pixel / resolution, resolution);
}

void runItem(uint item) {
  uint triangle = Words(SL_LAUNCH.indices).at[item];
  uint slot = findSlot(kTheSet, triangle);
  uint index = Words(SL_LAUNCH.winner).at[slot];
  Words(SL_LAUNCH.winner).at[slot] = kSlotOld;
  uint stage = SL_LAUNCH.stage;
  Ray ray;
  if (SL_LAUNCH.hemicubes != 0ul) {
    ray = hemicubeRayAt(index - 1u);
  } else if (stage == kStageRandom) {
    ray = segmentRayAt(index);
  } else if (stage == kStageBorder) {
    ray = borderRayAt(index - 1u);
  } else {
    ray = reverseRayAt(index - 1u);
  }
  PvsEntry entry;
  entry.origin_triangle = uvec4(floatBitsToUint(ray.origin.xyz), triangle);
  entry.direction_stage = uvec4(floatBitsToUint(ray.direction.xyz), stage);
  Entries(SL_LAUNCH.entries).at[SL_LAUNCH.list_end + item] = entry;
}
