#version 460
// Moves the contents of a hash set into a larger one.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/list.glsl"

void runItem(uint old_slot) {
  uint key = Words(SL_LAUNCH.old_keys).at[old_slot];
  if (key == kNoTriangle) return;
  uint slot = claimSlot(kTheSet, key);
  if (slot == kSlotEmpty) {
    SL_SET_ADD(overflow, 0u, 1u);
    return;
  }
  Words(SL_LAUNCH.winner).at[slot] = Words(SL_LAUNCH.old_winner).at[old_slot];
}
