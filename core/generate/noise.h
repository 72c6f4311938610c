#pragma once
#include <cstdint>
#include <glm/glm.hpp>

namespace sightline {

/// Smooth random functions of space in [-1, 1]: values at the integer lattice drawn by hash, blended by
/// quintics. Only +, - and *, so the same everywhere.
float noise1(float x, uint64_t seed);
float noise2(glm::vec2 p, uint64_t seed);
float noise3(glm::vec3 p, uint64_t seed);

/// Sum of octaves, each of half the size and half the height of the one before; within [-2, 2].
float fractal2(glm::vec2 p, uint32_t octaves, uint64_t seed);
float fractal3(glm::vec3 p, uint32_t octaves, uint64_t seed);

}  // namespace sightline
