#pragma once
#include <array>
#include <span>

#include "core/scene/scene.h"
#include "core/shared/hemicube.h"
#include "core/shared/view_ray.h"

namespace sightline {

/// The images of a hemicube: see core/shared/hemicube.h.
using Hemicube = std::array<ViewFrame, kHemicubeViews>;

/// The hemicube at a point of the face.
Hemicube hemicubeAt(const Face& face, glm::vec3 point);

/// Hemicube number `index` (0, 1, ...) of a cell: uniform over the faces by area, at shifted Halton points
/// (base 2: which face, 3 and 5: where on it). shifts: StageParams::shifts.
Hemicube placeHemicube(std::span<const Face> faces, uint64_t index, uvec4 shifts);

/// Distance of the near plane, in front of each of the five images: geometry that is nearer is not seen. As
/// near as a 32-bit depth buffer with reversed z stands without mixing up what is far: 2^-16 of the diagonal
/// of all there is, or, where that is less, 2^-8 of the cell's shortest edge.
float hemicubeNear(const Scene& scene, std::span<const Face> faces);

}  // namespace sightline
