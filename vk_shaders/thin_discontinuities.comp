#version 460
// Of the border rays that met a discontinuity, a bit each, those that keepsDiscontinuity names.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/list.glsl"
#include "vk_shaders/sampling.glsl"

/// Whether the border ray before `index`, on the same side, met a discontinuity by the same occluder.
bool followsAnother(uint index) {
  uint before = index - 1u;
  if ((Words(SL_LAUNCH.bits).at[before >> 5] >> (before & 31u) & 1u) == 0u) return false;
  return Words(SL_LAUNCH.border_hits).at[before] == Words(SL_LAUNCH.border_hits).at[index];
}

void runItem(uint word) {
  uint kept = 0u;
  for (uint bits = Words(SL_LAUNCH.bits).at[word]; bits != 0u; bits &= bits - 1u) {
    uint bit = uint(findLSB(bits));
    uint index = word * 32u + bit;
    uint entry_index = borderEntryOf(index);
    uint place = borderPlace(borderRayOf(index, entry_index), borderSamplesAt(entry_index));
    bool follows = place > 0u && followsAnother(index);
    kept |= (keepsDiscontinuity(place, follows, SL_LAUNCH.params) ? 1u : 0u) << bit;
  }
  Words(SL_LAUNCH.kept_bits).at[word] = kept;
}
