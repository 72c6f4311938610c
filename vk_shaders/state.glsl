// What every shader sees: the launch's struct, buffers by address, the set.
#ifndef SL_STATE_GLSL
#define SL_STATE_GLSL
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require
#include "vk_shaders/launch.h"

layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer LaunchAt {
  VulkanLaunch launch;
};
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Words {
  uint at[];
};
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Floats {
  float at[];
};
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Faces {
  Face at[];
};
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Segments {
  RandomSegment at[];
};
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Entries {
  PvsEntry at[];
};
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Rays {
  Ray at[];
};

/// One dispatch of a launch: it runs the work items first_item .. item_end - 1.
layout(push_constant, scalar) uniform Push {
  uint64_t launch_address;
  uint first_item;
  uint item_end;
};
#define SL_LAUNCH LaunchAt(launch_address).launch

#define sl_set_keys Words(SL_LAUNCH.keys).at
#define sl_set_winner Words(SL_LAUNCH.winner).at
#define sl_set_fresh Words(SL_LAUNCH.fresh).at
#define sl_set_overflow Words(SL_LAUNCH.counters + 4u * kOverflowCounter).at
#define sl_set_capacity SL_LAUNCH.capacity
#include "core/shared/set.h"
/// The argument of the set's functions, which GLSL does not need.
const uint kTheSet = 0u;

#endif
