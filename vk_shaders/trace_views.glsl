#version 460
// Id images: the triangle behind every pixel, view after view, row after row.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/trace.glsl"

void runItem(uint item) {
  uint resolution = SL_LAUNCH(resolution);
  uint per_view = viewItems(resolution);
  uint view = item / per_view;
  uint pixel = viewPixel(item - view * per_view, resolution);
  if (pixel == kNoTriangle) return;
  uint row = pixel / resolution;
  Ray ray = viewRay(SL_BUFFER(views, view), pixel - row * resolution, row, resolution);
  uint first = view * resolution * resolution;  // below 2^32, as the work items are
  SL_BUFFER(view_triangles, first + pixel) = triangleOf(nearestHit(ray));
}
