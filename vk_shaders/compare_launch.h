// What compare_depth.comp reads and counts. C++ and GLSL (scalar layout).
#ifndef SL_COMPARE_LAUNCH_H
#define SL_COMPARE_LAUNCH_H
#include "core/shared/language.h"
SL_NAMESPACE_BEGIN

SL_STRUCT(CompareLaunch) {
  uint64 reference;  ///< float[] a pixel
  uint64 tested;     ///< float[] a pixel
  uint64 ids;        ///< uint[] a pixel: which drawable the reference shows
  uint64 counts;     ///< uint[], as follows
};

SL_CONST uint kFalsePixels = 0u;
SL_CONST uint kTooNearPixels = 1u;
SL_CONST uint kDrawableCounts = 2u;  ///< of each drawable: pixels that are false, pixels that show it

SL_NAMESPACE_END
#endif
