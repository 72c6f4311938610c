// What every shader sees: the launch's struct, buffers by address, the set.
#ifndef SL_STATE_GLSL
#define SL_STATE_GLSL
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require
#include "core/shared/bvh_node.h"
#include "core/shared/counters.h"
#include "core/shared/placement.h"
#include "core/shared/stage_launch.h"

// Arrays by address: Buffer_TYPE, as SL_ADDRESS names them.
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Buffer_uint {
  uint at[];
};
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Buffer_Face {
  Face at[];
};
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Buffer_RandomSegment {
  RandomSegment at[];
};
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Buffer_PvsEntry {
  PvsEntry at[];
};
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Buffer_BorderEdge {
  BorderEdge at[];
};
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Buffer_Discontinuity {
  Discontinuity at[];
};
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Buffer_ReverseItem {
  ReverseItem at[];
};
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Buffer_Ray {
  Ray at[];
};
layout(buffer_reference, scalar, buffer_reference_align = 8) buffer Buffer_Hit {
  Hit at[];
};
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Buffer_ViewFrame {
  ViewFrame at[];
};
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Buffer_InstanceRecord {
  InstanceRecord at[];
};
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Floats {
  float at[];
};

#include "vk_shaders/launch.h"
#include "core/shared/vulkan_push.h"
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer LaunchAt {
  VulkanLaunch launch;
};

layout(push_constant, scalar) uniform Push {
  VulkanPush push;
};
#define SL_THE_LAUNCH LaunchAt(push.launch).launch

#define sl_set_keys SL_THE_LAUNCH.keys.at
#define sl_set_winner SL_THE_LAUNCH.winner.at
#define sl_set_fresh SL_THE_LAUNCH.fresh.at
#define sl_set_overflow Buffer_uint(uint64_t(SL_THE_LAUNCH.counters) + 4u * kOverflowCounter).at
#define sl_set_capacity SL_LAUNCH(capacity)
#include "core/shared/set.h"
/// The arguments of the set's and of the stages' functions, which GLSL does not need.
const uint kTheSet = 0u;
const uint kTheStage = 0u;

#undef SL_SURFACE_WORD
#define SL_SURFACE_WORD(i) Buffer_uint(SL_THE_LAUNCH.surfaces).at[i]
#include "core/shared/surface.h"
/// The argument of its functions, likewise.
const uint kTheSurfaces = 0u;

/// The leaf of a primitive of an instance in the top level.
uint leafOf(uint part, uint primitive) {
  return Buffer_uint(SL_THE_LAUNCH.part_starts).at[part] + primitive;
}

uint idOfLeaf(uint leaf, uint part) {
  return Buffer_uint(SL_THE_LAUNCH.leaf_ids).at[leaf] + Buffer_uint(SL_THE_LAUNCH.part_ids).at[part];
}

/// Corner 0, 1 or 2 of the triangle in a leaf.
vec3 leafCorner(uint leaf, uint corner) {
  Floats corners = Floats(SL_THE_LAUNCH.corners + uint64(kCornerBytes) * leaf);
  return vec3(corners.at[3u * corner], corners.at[3u * corner + 1u], corners.at[3u * corner + 2u]);
}

#endif
