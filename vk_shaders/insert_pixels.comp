#version 460
// Inserts the triangle of each sample of a hemicube's images, under the sample's index in the batch.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/list.glsl"
#include "core/shared/hemicube.h"

void runItem(uint place) {
  uint resolution = SL_THE_LAUNCH.raster_resolution;
  uint image = hemicubeView(place, resolution) * resolution * resolution;
  uint leaf = Buffer_uint(SL_THE_LAUNCH.raster_leaves).at[image + hemicubePixel(place, resolution)];
  if (leaf == kNoTriangle) return;
  insertHit(kTheSet, Buffer_uint(SL_THE_LAUNCH.leaf_ids).at[leaf], SL_THE_LAUNCH.raster_first + place);
}
