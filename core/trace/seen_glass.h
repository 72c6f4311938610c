#pragma once
#include <compare>
#include <cstdint>

namespace sightline {

/// A triangle of glass that a ray meets before or where it ends: it is seen, and seen through.
struct SeenThrough {
  uint32_t ray;  ///< its index
  uint32_t triangle;
  auto operator<=>(const SeenThrough&) const = default;
};

}  // namespace sightline
