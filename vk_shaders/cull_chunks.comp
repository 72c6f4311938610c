#version 460
// Which chunks a view of a hemicube may show: a VkDrawIndirectCommand each, view after view, that draws nothing where
// the chunk's box lies wholly outside the view.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/list.glsl"
#include "core/shared/vector.h"

/// Whether all of a box, low to high relative to the view point, lies behind the plane through it. On the safe side by
/// more than a few roundings.
bool isBehind(vec3 normal, vec3 low, vec3 high) {
  vec3 a = normal * low;
  vec3 b = normal * high;
  vec3 farthest = max(a, b);
  vec3 sizes = max(abs(a), abs(b));
  return farthest.x + farthest.y + farthest.z < -1e-6f * (sizes.x + sizes.y + sizes.z);
}

void runItem(uint item) {
  uint chunk = item % SL_THE_LAUNCH.chunk_count;
  Buffer_ViewFrame views = Buffer_ViewFrame(SL_THE_LAUNCH.hemicube);
  ViewFrame view = views.at[item / SL_THE_LAUNCH.chunk_count];
  Floats bounds = Floats(SL_THE_LAUNCH.chunk_bounds + 4ul * kBoxFloats * chunk);
  vec3 low = vec3(bounds.at[0], bounds.at[1], bounds.at[2]) - view.origin.xyz;
  vec3 high = vec3(bounds.at[3], bounds.at[4], bounds.at[5]) - view.origin.xyz;
  vec3 forward = view.forward.xyz;
  bool outside = isBehind(forward + view.right.xyz, low, high) || isBehind(forward - view.right.xyz, low, high) ||
                 isBehind(forward + view.up.xyz, low, high) || isBehind(forward - view.up.xyz, low, high) ||
                 isBehind(views.at[0].forward.xyz, low, high);
  uint first = chunk * kChunkTriangles;
  Buffer_uint draws = Buffer_uint(SL_THE_LAUNCH.draws + 16ul * item);
  draws.at[0] = 3u * (min(first + kChunkTriangles, SL_THE_LAUNCH.triangle_count) - first);
  draws.at[1] = outside ? 0u : 1u;
  draws.at[2] = 3u * first;
  draws.at[3] = 0u;
}
