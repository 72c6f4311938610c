#version 460
// Which units are to be drawn, by one of four tests (draw_launch.h); and how many of each block.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/draw.glsl"
#include "core/shared/guarded_box.h"
#include "core/shared/pyramid.h"

layout(local_size_x = kCullBlock) in;
shared uint next_of_block;

/// Whether something nearer than all of the depths there hides the box.
bool pyramidHides(BoxExtent box) {
  uint width = SL_DRAW.camera.size.x;
  uint height = SL_DRAW.camera.size.y;
  uvec4 pixels = box.pixels;
  uint shrink = uint(SL_CULL.shrink);
  if (pixels.z >= pixels.x + 2u * shrink) pixels = uvec4(pixels.x + shrink, pixels.y, pixels.z - shrink, pixels.w);
  if (pixels.w >= pixels.y + 2u * shrink) pixels = uvec4(pixels.x, pixels.y + shrink, pixels.z, pixels.w - shrink);
  uint level = max(levelOfRun(pixels.x, pixels.z), levelOfRun(pixels.y, pixels.w));
  uint columns = levelSize(width, level);
  Floats texels = Floats(SL_CULL.pyramid + 4ul * levelStart(width, height, level));
  for (uint y = pixels.y >> level; y <= pixels.w >> level; ++y) {
    for (uint x = pixels.x >> level; x <= pixels.z >> level; ++x) {
      if (texels.at[y * columns + x] <= box.depth) return false;
    }
  }
  return true;
}

bool isCandidate(CullUnit unit) {
  return SL_CULL.candidates == 0ul ||
         ((Words(SL_CULL.candidates).at[unit.run.z >> 5u] >> (unit.run.z & 31u)) & 1u) != 0u;
}

/// The unit's state after the test.
uint stateAfter(uint state, CullUnit unit) {
  uint kept = state & (kUnitSeen | kUnitDrawn);
  if (push.numbers.w == kTestBoxes) {
    bool shown = (state & kUnitNext) != 0u;
    return (shown ? kUnitSeen : 0u) | (shown && (state & kUnitDrawn) == 0u ? kUnitNext : 0u);
  }
  if (push.numbers.w == kTestBefore) kept &= kUnitSeen;
  bool early = push.numbers.w == kTestBefore;
  if (!isCandidate(unit)) return early ? 0u : kept & ~kUnitSeen;
  BoxExtent box = boxExtent(SL_DRAW.camera, unit.low.xyz, unit.high.xyz);
  if (early) return box.place != kBoxOutside && kept != 0u ? kUnitSeen | kUnitDrawn | kUnitNext : kept;
  if (push.numbers.w == kTestAsk) {
    bool whole = guardBox(SL_DRAW.camera, unit.low.xyz, unit.high.xyz, SL_CULL.shrink).whole;
    if (box.place == kBoxAhead && whole) return (kept & kUnitDrawn) | kUnitAsked;
    return (kept & kUnitDrawn) | (box.place != kBoxOutside ? kUnitNext : 0u);
  }
  bool seen = box.place == kBoxNear || (box.place == kBoxAhead && !pyramidHides(box));
  return (seen ? kUnitSeen : 0u) | (seen && (kept & kUnitDrawn) == 0u ? kUnitNext : 0u);
}

void main() {
  if (gl_LocalInvocationIndex == 0u) next_of_block = 0u;
  barrier();
  if (gl_GlobalInvocationID.x < push.numbers.y) {
    uint unit = push.numbers.x + gl_GlobalInvocationID.x;
    Words states = Words(SL_CULL.states);
    uint state = stateAfter(states.at[unit], Units(SL_CULL.units).at[unit]);
    states.at[unit] = state;
    if ((state & kUnitNext) != 0u) atomicAdd(next_of_block, 1u);
  }
  barrier();
  if (gl_LocalInvocationIndex == 0u) Words(SL_CULL.block_counts).at[push.numbers.z * SL_CULL.blocks + gl_WorkGroupID.x] = next_of_block;
}
