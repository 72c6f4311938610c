#pragma once
#include <cstdint>
#include <span>

#include "core/picture/png.h"

namespace sightline {

/// What shows a triangle that is missing from a set; nothing else in a picture has this colour.
inline constexpr Rgb kMissingColor{255, 0, 0};

/// Colours pixels (their numbers, row by row) as missing; where they are few, each has a ring around it.
void markMissing(Image& image, std::span<const size_t> pixels);

}  // namespace sightline
