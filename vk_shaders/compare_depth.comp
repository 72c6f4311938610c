#version 460
// Pixels where an image shows what lies behind what the reference shows there.
//   launch: CompareLaunch; numbers: pixels, drawables
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/draw.glsl"
#include "vk_shaders/compare_launch.h"

layout(local_size_x = 256) in;
const uint kRowGroups = 32768u;  // of the grid
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer CompareAt {
  CompareLaunch launch;
};

void main() {
  uint pixel = (gl_WorkGroupID.y * kRowGroups + gl_WorkGroupID.x) * 256u + gl_LocalInvocationIndex;
  if (pixel >= push.numbers.x) return;
  CompareLaunch compare = CompareAt(push.launch).launch;
  uint id = Words(compare.ids).at[pixel];
  // As bits: depths are not negative, so that their order is theirs.
  uint reference = Words(compare.reference).at[pixel];
  uint tested = Words(compare.tested).at[pixel];
  Words counts = Words(compare.counts);
  if (tested < reference) {
    atomicAdd(counts.at[kFalsePixels], 1u);
    if (id < push.numbers.y) atomicAdd(counts.at[kDrawableCounts + 2u * id], 1u);
  }
  if (tested > reference) atomicAdd(counts.at[kTooNearPixels], 1u);
  if (id < push.numbers.y) atomicAdd(counts.at[kDrawableCounts + 2u * id + 1u], 1u);
}
