#pragma once
#include <cstdint>
#include <vector>

#include "core/draw/drawables.h"

namespace sightline {

/// A list of triangles that QueryBackend::submitList draws: by kind, in each kind by ascending id.
struct TriangleList {
  std::vector<uint32_t> ids;
  uint32_t masked_begin = 0;   ///< opaque ones are before
  uint32_t blended_begin = 0;  ///< masked ones are before, the rest is blended

  /// Draw calls: one a kind that there is.
  uint32_t draws() const {
    return (masked_begin > 0 ? 1u : 0u) + (blended_begin > masked_begin ? 1u : 0u) +
           (ids.size() > blended_begin ? 1u : 0u);
  }
  bool operator==(const TriangleList&) const = default;
};

/// Of a set (.pvs) a list a cell.
struct TriangleLists {
  std::vector<TriangleList> lists;
};

}  // namespace sightline
