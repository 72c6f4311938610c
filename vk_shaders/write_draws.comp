#version 460
// The list of draws of the units that are next, in the order of units, and the list's head: how many.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/draw.glsl"

layout(local_size_x = kCullBlock) in;
shared uint sums[kCullBlock];

/// Sum of `value` over the group.
uint sumOfGroup(uint value) {
  uint lane = gl_LocalInvocationIndex;
  barrier();
  sums[lane] = value;
  for (uint step = kCullBlock / 2u; step > 0u; step /= 2u) {
    barrier();
    if (lane < step) sums[lane] += sums[lane + step];
  }
  barrier();
  return sums[0];
}

/// Sum over the lanes before this one.
uint sumBefore(uint value) {
  uint lane = gl_LocalInvocationIndex;
  barrier();
  sums[lane] = value;
  for (uint step = 1u; step < kCullBlock; step *= 2u) {
    barrier();
    uint other = lane >= step ? sums[lane - step] : 0u;
    barrier();
    sums[lane] += other;
  }
  barrier();
  return sums[lane] - value;
}

void writeDraw(uint place, uint unit, bool drawn) {
  uvec4 run = Units(SL_CULL.units).at[unit].run;
  if (push.numbers.w == kDrawMeshlets) {
    Words(SL_CULL.listed).at[place] = unit;
    return;
  }
  Words draw = Words(SL_CULL.draws + 4ul * kDrawWords * uint64(place));
  bool indexed = push.numbers.w == kDrawIndexed;
  draw.at[0] = 3u * run.y;
  draw.at[1] = drawn ? 1u : 0u;
  draw.at[2] = 3u * run.x;
  draw.at[3] = indexed ? 0u : run.z;
  draw.at[4] = run.z;
}

void main() {
  Words states = Words(SL_CULL.states);
  bool within = gl_GlobalInvocationID.x < push.numbers.y;
  bool ordered = push.numbers.w == kDrawOrdered;
  uint unit = push.numbers.x + gl_GlobalInvocationID.x;
  if (ordered && within) unit = Words(SL_CULL.order).at[gl_GlobalInvocationID.x];
  bool next = within && (states.at[unit] & kUnitNext) != 0u;

  uint before = 0u;
  for (uint block = gl_LocalInvocationIndex; block < gl_WorkGroupID.x; block += kCullBlock) {
    before += Words(SL_CULL.block_counts).at[push.numbers.z * SL_CULL.blocks + block];
  }
  uint first = sumOfGroup(before);
  uint place = first + sumBefore(next ? 1u : 0u);
  if (ordered && within) writeDraw(push.numbers.x + gl_GlobalInvocationID.x, unit, next);
  if (!ordered && next) writeDraw(push.numbers.x + place, unit, true);
  Words head = Words(SL_CULL.heads + 4ul * kHeadWords * push.numbers.z);
  uint triangles = sumOfGroup(next ? Units(SL_CULL.units).at[unit].run.y : 0u);
  uint count = sumOfGroup(next ? 1u : 0u);
  if (gl_LocalInvocationIndex == 0u && triangles > 0u) atomicAdd(head.at[kHeadTriangles], triangles);
  // Blocks are counted in the order of units, not in the given one; there nothing needs the head but statistics.
  if (ordered && gl_LocalInvocationIndex == 0u) atomicAdd(head.at[0], count);
  if (!ordered && gl_LocalInvocationIndex == 0u && gl_WorkGroupID.x + 1u == gl_NumWorkGroups.x) {
    uint all = first + count;
    head.at[0] = all;
    head.at[1] = min(all, kMeshletRow);
    head.at[2] = (all + kMeshletRow - 1u) / kMeshletRow;
    head.at[3] = 1u;
  }
}
