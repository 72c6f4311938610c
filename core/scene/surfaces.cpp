#include "core/scene/surfaces.h"

#include <cstring>

#include "core/base/error.h"

namespace sightline {
namespace {

template <typename T>
void appendWords(const std::vector<T>& from, std::vector<uint32_t>& to) {
  static_assert(sizeof(T) % sizeof(uint32_t) == 0);
  const size_t before = to.size();
  to.resize(before + from.size() * (sizeof(T) / sizeof(uint32_t)));
  if (!from.empty()) std::memcpy(to.data() + before, from.data(), from.size() * sizeof(T));
}

static_assert(sizeof(MaskedTriangle) == kMaskedTriangleWords * 4 && sizeof(AlphaMask) == kAlphaMaskWords * 4);

}  // namespace

SurfaceFeatures featuresOf(const Surfaces& surfaces) {
  uint32_t all = 0;
  for (const uint32_t word : surfaces.words) all |= word;
  return {(all & kSurfaceMasked) != 0, (all & kSurfaceGlass) != 0, (all & kSurfaceFrontOnly) != 0};
}

void countSurface(SurfaceCounts& counts, uint32_t word, uint64_t times) {
  counts.masked += (word & kSurfaceMasked) != 0 ? times : 0;
  counts.glass += (word & kSurfaceGlass) != 0 ? times : 0;
  counts.front_only += (word & kSurfaceFrontOnly) != 0 ? times : 0;
}

std::vector<uint32_t> packSurfaces(const Surfaces& surfaces, const std::vector<uint32_t>& order) {
  const uint64_t masked = kSurfaceHeaderWords + uint64_t(order.size());
  const uint64_t masks = masked + surfaces.masked.size() * kMaskedTriangleWords;
  const uint64_t texels = masks + surfaces.masks.size() * kAlphaMaskWords;
  if (texels + surfaces.texels.size() > 0xffffffffu) {
    throw Error("the scene's alpha masks take more than 16 GiB: use smaller textures, or --opaque-masks");
  }
  std::vector<uint32_t> packed;
  packed.reserve(texels + surfaces.texels.size());
  packed = {uint32_t(masked), uint32_t(masks), uint32_t(texels), 0u};
  for (const uint32_t triangle : order) packed.push_back(surfaces.of(triangle));
  appendWords(surfaces.masked, packed);
  appendWords(surfaces.masks, packed);
  appendWords(surfaces.texels, packed);
  return packed;
}

}  // namespace sightline
