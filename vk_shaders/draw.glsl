// What every shader that draws sees.
#ifndef SL_DRAW_GLSL
#define SL_DRAW_GLSL
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_scalar_block_layout : require
#include "core/shared/language.h"
#include "vk_shaders/draw_launch.h"

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Words {
  uint at[];
};
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Floats {
  float at[];
};
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Units {
  CullUnit at[];
};
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer DrawLaunchAt {
  DrawLaunch launch;
};
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer CullLaunchAt {
  CullLaunch launch;
};
layout(push_constant, scalar) uniform Push {
  DrawPush push;
};
#define SL_DRAW DrawLaunchAt(push.launch).launch
#define SL_CULL CullLaunchAt(push.other).launch

vec3 positionOf(uint vertex) {
  Floats positions = Floats(SL_DRAW.positions + 12ul * vertex);
  return vec3(positions.at[0], positions.at[1], positions.at[2]);
}

#endif
