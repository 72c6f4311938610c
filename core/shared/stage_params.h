// Parameters of the sampling stages, as the device sees them (thesis 6.2.2, with relative thresholds).
#ifndef SL_STAGE_PARAMS_H
#define SL_STAGE_PARAMS_H
#include "core/shared/types.h"
SL_NAMESPACE_BEGIN

/// Which border and reverse rays are traced: those of gvs++ (border.h, reverse.h), or of the original gvs
/// (gvs_border.h, gvs_reverse.h).
SL_CONST uint kSampleGvspp = 0u;
SL_CONST uint kSampleGvs = 1u;
/// Places on the border polygon that the original method may sample.
SL_CONST uint kGvsPositions = 72u;

/// Constant for a view cell.
SL_STRUCT(StageParams) {
  uvec4 counts;    ///< x: n_ABSEdge (at most), y: n_RSEdge, z: n_RSArea, w: number of faces
  uvec4 shifts;    ///< random shifts (Cranley-Patterson) for the bases 2, 3, 5, 7: of random sampling
  vec4 distances;  ///< x: delta_ABS relative to the distance, y: delta_ABS in world units,
                   ///< z: delta_RS relative, w: delta_RS in world units; relative and absolute parts add up
  uvec4 method;    ///< x: kSample..., y: reverse stride, 1 or more (keepsDiscontinuity)
  vec4 spacing;    ///< x: of border samples, seen from the ray's origin (borderSamples); 0: always n_ABSEdge
  vec4 look;       ///< xyz: normal of a flat cell, which looks that way only; 0: looks all around (look.h)
};

SL_FUNC bool isGvs(StageParams params) {
  return params.method.x == kSampleGvs;
}

/// A run of random rays from one face: the points first .. first + count - 1 of the Halton sequence. Work
/// items do not walk the sequence itself but its strata, so that neighbouring items trace coherent rays: see
/// random_ray.h. Filled by makeRandomSegment (core/sampling/random_segment.h).
SL_STRUCT(RandomSegment) {
  uvec4 range;         ///< x: face, y: low and z: high half of first, w: count
  uvec4 batch;         ///< x: index of the first ray in its batch (1 or more), y: number of strata M,
                       ///< z: slots a stratum (so there are y * z slots), w: first modulo M
  uvec4 digits;        ///< exponents a, b, c, d: M = 2^a 3^b 5^c 7^d
  uvec4 coefficients;  ///< of the Chinese remainder theorem for the moduli 2^a, 3^b, 5^c, 7^d
};

SL_NAMESPACE_END
#endif
