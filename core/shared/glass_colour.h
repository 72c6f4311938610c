// What glass looks like in pictures of drawn frames.
#ifndef SL_GLASS_COLOUR_H
#define SL_GLASS_COLOUR_H
#include "core/shared/language.h"
SL_NAMESPACE_BEGIN

/// Colour of a drawable of glass, and how much of it hides what is behind, each 0 .. 1: a tint of its own.
SL_FUNC vec4 glassColour(uint drawable) {
  uint bits = drawable * 2654435761u;
  return vec4(slFloat((bits >> 24u) & 127u) / 255.0f, slFloat((bits >> 16u) & 127u) / 255.0f + 0.25f, 0.75f,
              0.25f);
}

SL_NAMESPACE_END
#endif
