#pragma once
#include <functional>
#include <glm/glm.hpp>
#include <optional>

#include "core/scene/surfaces.h"

namespace sightline {

/// Adds a mask of width * height texels to the surfaces and returns its index. holds(i) of texel i, row after
/// row from the top. wraps: kWrap... of x and of y. The size is within kMostTexelsASide and kMostTexels.
uint32_t addMask(Surfaces& surfaces, uint32_t width, uint32_t height, glm::uvec2 wraps,
                 const std::function<bool(uint64_t texel)>& holds);

/// The record of a triangle whose corners lie at these places of a mask's image, in texels from its upper
/// left corner, x to the right and y down: rounded to 2^-16 texel, or, for a triangle that spans more than
/// 2^14 texels, to as much less as it spans more. Whole repetitions of the image are taken off. Nothing where
/// a place is not finite or 2^30 texels away.
std::optional<MaskedTriangle> maskedTriangle(const Surfaces& surfaces, uint32_t mask,
                                             const glm::dvec2 (&places)[3]);

/// The record of the same triangle with its second and third corner in each other's place.
MaskedTriangle mirrored(const MaskedTriangle& triangle);

}  // namespace sightline
