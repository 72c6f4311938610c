#pragma once
#include <cstdint>
#include <span>

namespace sightline {

/// What had to be drawn for an image: no method can draw less.
struct OptimalCounts {
  uint64_t drawables = 0;  ///< with a pixel
  uint64_t triangles = 0;  ///< with a pixel
  uint64_t drawable_triangles =
      0;  ///< all of those drawables: what a method that draws them whole draws at least
  bool operator==(const OptimalCounts&) const = default;
};

/// ids: of the triangle that each pixel shows, kNoTriangle for none. owner: drawableOfTriangles.
/// triangle_counts: of each drawable. Ids and owners must be in range.
OptimalCounts countOptimal(std::span<const uint32_t> ids, std::span<const uint32_t> owner,
                           std::span<const uint32_t> triangle_counts);

}  // namespace sightline
