// Based on: Perlin, An Image Synthesizer, SIGGRAPH 1985, and the quintic of Improving Noise, SIGGRAPH 2002;
// with values instead of gradients at the lattice.
#include "core/generate/noise.h"

#include <cmath>

#include "core/generate/generator_random.h"

namespace sightline {
namespace {

float latticeValue(int64_t x, int64_t y, int64_t z, uint64_t seed) {
  const uint64_t key = seed + uint64_t(x) * 0x9e3779b97f4a7c15ull + uint64_t(y) * 0xc2b2ae3d27d4eb4full +
                       uint64_t(z) * 0x165667b19e3779f9ull;
  return float(mixBits(key) >> 40) * 0x1p-23f - 1.0f;
}

float blend(float t) {
  return t * t * t * (t * (t * 6 - 15) + 10);
}

float mix(float a, float b, float t) {
  return a + (b - a) * t;
}

}  // namespace

float noise1(float x, uint64_t seed) {
  const float fx = std::floor(x);
  const int64_t i = int64_t(fx);
  return mix(latticeValue(i, 0, 0, seed), latticeValue(i + 1, 0, 0, seed), blend(x - fx));
}

float noise2(glm::vec2 p, uint64_t seed) {
  const float fx = std::floor(p.x), fy = std::floor(p.y);
  const int64_t i = int64_t(fx), j = int64_t(fy);
  const float u = blend(p.x - fx), v = blend(p.y - fy);
  return mix(mix(latticeValue(i, j, 0, seed), latticeValue(i + 1, j, 0, seed), u),
             mix(latticeValue(i, j + 1, 0, seed), latticeValue(i + 1, j + 1, 0, seed), u), v);
}

float noise3(glm::vec3 p, uint64_t seed) {
  const float fx = std::floor(p.x), fy = std::floor(p.y), fz = std::floor(p.z);
  const int64_t i = int64_t(fx), j = int64_t(fy), k = int64_t(fz);
  const float u = blend(p.x - fx), v = blend(p.y - fy);
  const auto layer = [&](int64_t z) {
    return mix(mix(latticeValue(i, j, z, seed), latticeValue(i + 1, j, z, seed), u),
               mix(latticeValue(i, j + 1, z, seed), latticeValue(i + 1, j + 1, z, seed), u), v);
  };
  return mix(layer(k), layer(k + 1), blend(p.z - fz));
}

float fractal2(glm::vec2 p, uint32_t octaves, uint64_t seed) {
  float sum = 0, height = 1;
  for (uint32_t i = 0; i < octaves; ++i, p *= 2.0f, height *= 0.5f) sum += height * noise2(p, seed + i);
  return sum;
}

float fractal3(glm::vec3 p, uint32_t octaves, uint64_t seed) {
  float sum = 0, height = 1;
  for (uint32_t i = 0; i < octaves; ++i, p *= 2.0f, height *= 0.5f) sum += height * noise3(p, seed + i);
  return sum;
}

}  // namespace sightline
