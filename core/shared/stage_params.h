// Parameters of the sampling stages, as the device sees them (thesis 6.2.2, with relative thresholds).
#ifndef SL_STAGE_PARAMS_H
#define SL_STAGE_PARAMS_H
#include "core/shared/types.h"
SL_NAMESPACE_BEGIN

/// Constant for a view cell.
SL_STRUCT(StageParams) {
  uvec4 counts;   ///< x: n_ABSEdge, y: n_RSEdge, z: n_RSArea, w: number of faces
  uvec4 shifts;   ///< random shifts (Cranley-Patterson) for the bases 2, 3, 5, 7: of random sampling
  vec4 distances; ///< x: delta_ABS relative to the distance, y: delta_ABS in world units,
                  ///< z: delta_RS relative, w: delta_RS in world units; relative and absolute parts add up
};

/// A run of random rays from one face. Slot s of the run is a work item; to trace coherent rays together,
/// slots walk the strata of the directions (2^a by 3^b of them, see random_ray.h), not the sequence.
SL_STRUCT(RandomSegment) {
  uvec4 range;   ///< x: face, y: low and z: high half of the first Halton index, w: number of rays
  uvec4 strata;  ///< x: a, y: b, z: index of the segment's first ray in its batch (1 or more), w: unused
};

SL_NAMESPACE_END
#endif
