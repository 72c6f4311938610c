#version 460
// Appends the new triangles of a batch to the list, each with the ray that won it, and marks their slots as
// old.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/list.glsl"
#include "core/shared/hemicube.h"

/// The ray through the centre of the pixel of sample `index` (0 ..) of a batch of hemicubes.
Ray hemicubeRayAt(uint index) {
  uint resolution = SL_THE_LAUNCH.raster_resolution;
  uint samples = hemicubeSamples(resolution);
  uint place = index % samples;
  uint view = index / samples * kHemicubeViews + hemicubeView(place, resolution);
  uint pixel = hemicubePixel(place, resolution);
  ViewFrame frame = Buffer_ViewFrame(SL_THE_LAUNCH.hemicubes).at[view];
  return viewRay(frame, pixel % resolution, pixel / resolution, resolution);
}

void runItem(uint item) {
  uint index = takeWinner(kTheStage, item);
  bool drawn = SL_THE_LAUNCH.hemicubes != 0ul;
  Ray ray = noRay();
  if (drawn) {
    ray = hemicubeRayAt(index - 1u);
  } else {
    ray = batchRayAt(kTheStage, index);
  }
  appendEntryOf(kTheStage, item, ray);
}
