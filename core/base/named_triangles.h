#pragma once
#include <cstdint>
#include <string>

namespace sightline {

/// A run of a scene's triangles and what it is called there.
struct NamedTriangles {
  std::string name;
  uint32_t first = 0;
  uint32_t count = 0;  ///< at least 1
  bool operator==(const NamedTriangles&) const = default;
};

}  // namespace sightline
