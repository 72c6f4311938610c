#version 460
// Puts triangles into the set and the list without a ray.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/list.glsl"

void runItem(uint item) {
  uint triangle = Words(SL_LAUNCH.indices).at[item];
  uint slot = claimSlot(kTheSet, triangle);
  if (slot == kSlotEmpty) {
    SL_SET_ADD(overflow, 0u, 1u);
    return;
  }
  Words(SL_LAUNCH.winner).at[slot] = kSlotOld;
  PvsEntry entry;
  entry.origin_triangle = uvec4(0u, 0u, 0u, triangle);
  entry.direction_stage = uvec4(0u, 0u, 0u, kStageContained);
  Entries(SL_LAUNCH.entries).at[SL_LAUNCH.list_end + item] = entry;
}
