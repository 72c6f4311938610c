// Compute shaders over lists: 64 work items a group, one item each.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/state.glsl"
layout(local_size_x = 64) in;

void runItem(uint item);

void main() {
  uint item = first_item + gl_GlobalInvocationID.x;
  if (item < item_end) runItem(item);
}
