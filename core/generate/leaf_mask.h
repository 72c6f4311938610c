#pragma once
#include <cstdint>

#include "core/scene/surfaces.h"

namespace sightline {

/// Width and height of the picture on cards of leaves, texels: a power of two, so that places in it are
/// exact.
inline constexpr uint32_t kLeafTexels = 64;

/// Adds the mask of a twig: a stem from the middle of the lower edge, with leaves on both sides.
void addLeafMask(Surfaces& surfaces);

}  // namespace sightline
