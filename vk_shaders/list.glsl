// Compute shaders over lists: a group of work items, one item each.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/sampling.glsl"
layout(local_size_x = SL_LIST_GROUP) in;

void runItem(uint item);

void main() {
  uint item = push.first_item + gl_GlobalInvocationID.x;
  if (item < push.item_end) runItem(item);
}
