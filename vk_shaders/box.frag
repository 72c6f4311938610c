#version 460
// A pixel of a unit's box that is not hidden: the unit may be seen.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/draw.glsl"

layout(early_fragment_tests) in;
layout(location = 0) flat in uint unit;

void main() {
  Words states = Words(SL_CULL.states);
  if ((states.at[unit] & kUnitNext) == 0u) atomicOr(states.at[unit], kUnitNext);
}
