#version 460
// Which drawable a pixel shows. SL_PLAIN: not where it has a hole, or no back. SL_GLASS: the colour of glass instead.
#extension GL_GOOGLE_include_directive : require
#include "vk_shaders/draw.glsl"
#include "core/shared/glass_colour.h"
#if SL_PLAIN
#undef SL_SURFACE_WORD
#define SL_SURFACE_WORD(i) Words(SL_DRAW.surfaces).at[i]
#include "core/shared/surface.h"
#endif

layout(location = 0) flat in uint drawable;
#if SL_PLAIN
layout(location = 1) flat in uint slot;
layout(location = 2) in vec2 shares;
#endif
#if SL_GLASS
layout(location = 1) out vec4 colour;
#else
layout(location = 0) out uint shown;
#endif

void main() {
#if SL_PLAIN
  if (SL_DRAW.surfaces != 0ul) {
    uint surface = SL_SURFACE_WORD(kSurfaceHeaderWords + slot);
    if ((surface & kSurfaceFrontOnly) != 0u && !gl_FrontFacing) discard;
    if ((surface & kSurfaceMasked) != 0u && !maskHolds(0u, surface & kSurfaceIndex, shares.x, shares.y)) discard;
  }
#endif
#if SL_GLASS
  colour = glassColour(drawable);
#else
  shown = drawable;
#endif
}
