#pragma once
#include <span>

#include "core/pvs/bake_params.h"
#include "core/shared/stage_params.h"

namespace sightline {

/// The parameters of a bake as the sampling stages want them. faces: of the view cell (cellFaces; a single
/// one is a flat cell's); shifts: of its random sampling (haltonShifts).
inline StageParams makeStageParams(const BakeParams& params, std::span<const Face> faces, uvec4 shifts) {
  StageParams stage{};
  stage.counts = uvec4(params.n_abs_edge, params.n_rs_edge, params.n_rs_area, faces.size());
  stage.shifts = shifts;
  stage.distances =
      vec4(params.delta_abs_relative, params.delta_abs, params.delta_rs_relative, params.delta_rs);
  stage.method =
      uvec4(params.method == Method::kGvs ? kSampleGvs : kSampleGvspp, params.reverse_stride, 0, 0);
  stage.spacing = vec4(params.abs_spacing, 0, 0, 0);
  stage.look = faces.size() == 1 ? faces[0].normal : vec4(0);
  return stage;
}

}  // namespace sightline
