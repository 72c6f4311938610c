#pragma once
#include <cstdint>
#include <vector>

#include "core/shared/surface.h"

namespace sightline {

/// Which kinds of surfaces a scene has besides what is opaque from both sides.
struct SurfaceFeatures {
  bool masks = false;  ///< triangles with holes
  bool glass = false;  ///< triangles that are seen and seen through
  bool sides = false;  ///< triangles that are not there from behind

  bool any() const { return masks || glass || sides; }
};

/// What rays meet at the triangles of a scene (core/shared/surface.h). A scene whose triangles are all opaque
/// from both sides has no words, and costs nothing.
struct Surfaces {
  std::vector<uint32_t> words;         ///< of each stored triangle; empty: all are opaque from both sides
  std::vector<MaskedTriangle> masked;  ///< by index of the words
  std::vector<AlphaMask> masks;
  std::vector<uint32_t> texels;  ///< of all masks

  bool empty() const { return words.empty(); }
  /// Of a stored triangle; Scene::surfaceOf asks by id.
  uint32_t of(uint32_t triangle) const { return words.empty() ? 0u : words[triangle]; }
};

/// Most texels of a mask: their number and their bits' place are 32 bit.
inline constexpr uint64_t kMostTexels = uint64_t(1) << 28;
/// Largest width or height of a mask.
inline constexpr uint32_t kMostTexelsASide = 1u << 16;

SurfaceFeatures featuresOf(const Surfaces& surfaces);

/// How many triangles of each kind there are.
struct SurfaceCounts {
  uint64_t masked = 0, glass = 0, front_only = 0;
};
/// Adds a triangle with this surface, so often.
void countSurface(SurfaceCounts& counts, uint32_t word, uint64_t times = 1);

/// All surfaces as devices read them. order: the triangles of the tree's leaves (Bvh::references).
std::vector<uint32_t> packSurfaces(const Surfaces& surfaces, const std::vector<uint32_t>& order);

}  // namespace sightline
