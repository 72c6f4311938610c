#pragma once
#include <cstdint>
#include <vector>

#include "core/scene/surfaces.h"

namespace sightline {

/// A mask as the bytes of a PNG of white texels: alpha is 255 where it holds, 0 where there is a hole. Throws
/// Error.
std::vector<uint8_t> maskImage(const Surfaces& surfaces, uint32_t mask);

}  // namespace sightline
