// The pyramid over a depth image: which numbers lie where.
//
// Level 0 is the image; each further level has half as many columns and rows, rounded up, down to a single
// texel. A texel (x, y) of level k covers the pixels from (x, y) << k on, 2^k a side, as far as there are
// any: so a shift finds the texel of a pixel at every size, and the texel of an odd size's last column covers
// one column, not none. It holds the least depth of all pixels that it covers (the farthest: depth is
// reversed).
#ifndef SL_PYRAMID_H
#define SL_PYRAMID_H
#include "core/shared/language.h"
SL_NAMESPACE_BEGIN

/// Columns or rows of a level of an image with `pixels` of them.
SL_FUNC uint levelSize(uint pixels, uint level) {
  return (pixels + ((1u << level) - 1u)) >> level;
}

/// Levels of the pyramid, the image included.
SL_FUNC uint pyramidLevels(uint width, uint height) {
  uint levels = 1u;
  for (uint side = max(width, height); side > 1u; side = (side + 1u) >> 1u) ++levels;
  return levels;
}

/// Texels of the levels before this one: where it begins.
SL_FUNC uint levelStart(uint width, uint height, uint level) {
  uint start = 0u;
  for (uint k = 0u; k < level; ++k) start += levelSize(width, k) * levelSize(height, k);
  return start;
}

/// The finest level on which a run of pixels touches at most four texels.
SL_FUNC uint levelOfRun(uint first, uint last) {
  uint level = 0u;
  while ((last >> level) - (first >> level) > 3u) ++level;
  return level;
}

SL_NAMESPACE_END
#endif
