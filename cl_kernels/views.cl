// Id images: the triangle behind every pixel.
#include "cl_kernels/trace.cl"
#include "core/shared/view_ray.h"

/// Work items 0 .. total - 1 of the views, one after the other; triangles: view after view, row after row.
__kernel void traceViewsKernel(SL_SCENE_ARGS, __global const ViewFrame* views, uint resolution, uint total,
                               __global uint* triangles) {
  uint first = (uint)get_global_id(0) * SL_PACKET;
  if (first >= total) return;
  const uint per_view = viewItems(resolution);
  const uint view = first / per_view;  // of all lanes: per_view is a multiple of SL_PACKET
  const ViewFrame frame = views[view];
  Ray rays[SL_PACKET];
  Hit hits[SL_PACKET];
  uint pixels[SL_PACKET];
  for (uint i = 0; i < SL_PACKET; ++i) {
    const uint pixel = viewPixel(first - view * per_view + i, resolution);
    const uint row = pixel / resolution;
    pixels[i] = pixel;
    rays[i] = pixel == kNoTriangle ? noRay() : viewRay(frame, pixel - row * resolution, row, resolution);
  }
  traceRays(SL_SCENE_PACK, rays, hits);
  for (uint i = 0; i < SL_PACKET; ++i) {
    if (pixels[i] != kNoTriangle) {
      triangles[(size_t)view * resolution * resolution + pixels[i]] = hits[i].triangle;
    }
  }
}
