#include "core/scene/masked_triangle.h"

#include <algorithm>
#include <cmath>

namespace sightline {
namespace {

constexpr uint32_t kMostFractionBits = 16;
/// Places beyond this many units, rounded, are none of MaskedTriangle.
constexpr double kFarthest = double(kTexelOffset) - 1.0;

/// The three places along an axis without the image's repetitions before the first of them.
glm::dvec3 withoutRepetitions(const glm::dvec3& places, uint32_t size, uint32_t wrap) {
  if (wrap == kWrapClamp) return places;
  const double period = wrap == kWrapMirror ? 2.0 * size : double(size);
  const double first = std::min({places.x, places.y, places.z});
  return glm::max(places - std::floor(first / period) * period, glm::dvec3(0.0));
}

uint32_t inUnits(double place, uint32_t fraction_bits) {
  return uint32_t(int64_t(std::floor(std::ldexp(place, int(fraction_bits)) + 0.5)) + int64_t(kTexelOffset));
}

}  // namespace

uint32_t addMask(Surfaces& surfaces, uint32_t width, uint32_t height, glm::uvec2 wraps,
                 const std::function<bool(uint64_t texel)>& holds) {
  const size_t first = surfaces.texels.size();
  const uint64_t count = uint64_t(width) * height;
  surfaces.texels.resize(first + (count + 31) / 32, 0u);
  for (uint64_t i = 0; i < count; ++i) {
    if (holds(i)) surfaces.texels[first + i / 32] |= 1u << (i % 32);
  }
  surfaces.masks.push_back({uvec4(width, height, wraps.x + 4 * wraps.y, uint32_t(first))});
  return uint32_t(surfaces.masks.size() - 1);
}

std::optional<MaskedTriangle> maskedTriangle(const Surfaces& surfaces, uint32_t mask,
                                             const glm::dvec2 (&places)[3]) {
  const uvec4 size = surfaces.masks[mask].size_wrap_first;
  const glm::dvec3 x = withoutRepetitions({places[0].x, places[1].x, places[2].x}, size.x, size.z & 3u);
  const glm::dvec3 y = withoutRepetitions({places[0].y, places[1].y, places[2].y}, size.y, size.z >> 2);
  double reach = 0.0;
  for (int i = 0; i < 3; ++i) {
    if (!std::isfinite(x[i]) || !std::isfinite(y[i])) return std::nullopt;
    reach = std::max({reach, std::fabs(x[i]), std::fabs(y[i])});
  }
  if (reach > kFarthest) return std::nullopt;
  uint32_t bits = kMostFractionBits;
  while (std::ldexp(reach, int(bits)) > kFarthest) --bits;
  return MaskedTriangle{
      uvec4(inUnits(x[0], bits), inUnits(y[0], bits), inUnits(x[1], bits), inUnits(y[1], bits)),
      uvec4(inUnits(x[2], bits), inUnits(y[2], bits), mask, bits)};
}

MaskedTriangle mirrored(const MaskedTriangle& triangle) {
  const uvec4 &ab = triangle.corners_ab, &c = triangle.corner_c_mask;
  return {uvec4(ab.x, ab.y, c.x, c.y), uvec4(ab.z, ab.w, c.z, c.w)};
}

}  // namespace sightline
