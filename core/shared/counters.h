// What a launch on a GPU counts, and the sizes of the blocks in which it does.
#ifndef SL_COUNTERS_H
#define SL_COUNTERS_H
#include "core/shared/language.h"
SL_NAMESPACE_BEGIN

/// Words of the counters' buffer, which the host reads at once. Rays are counted in many words, so that work
/// items do not fight for one.
SL_CONST uint kRayCounters = 256u;      ///< 0 .. 255: rays
SL_CONST uint kMissingCounter = 256u;   ///< rays that hit something outside the set
SL_CONST uint kOverflowCounter = 257u;  ///< not 0: the hash set was full
SL_CONST uint kListCounter = 258u;      ///< bits or border rays that were summed up last for a list
SL_CONST uint kFreshCounter = 259u;     ///< bits of new triangles
SL_CONST uint kCounterWords = 260u;

/// Words of 32 bits that one work item of the list stages counts and writes.
SL_CONST uint kBlockWords = 64u;

// Macros where OpenCL C and GLSL take no constants: sizes of groups and of arrays.
/// Work items of the one group that sums up the blocks' counts.
#define SL_SUM_ITEMS 64
/// Work items of a group of the list stages. Fixed: PoCL compiles a kernel anew for every size.
#define SL_LIST_GROUP 64

SL_NAMESPACE_END
#endif
