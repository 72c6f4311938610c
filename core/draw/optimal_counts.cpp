#include "core/draw/optimal_counts.h"

#include <vector>

#include "core/shared/types.h"

namespace sightline {

OptimalCounts countOptimal(std::span<const uint32_t> ids, std::span<const uint32_t> owner,
                           std::span<const uint32_t> triangle_counts) {
  OptimalCounts counts;
  std::vector<bool> triangle_seen(owner.size()), drawable_seen(triangle_counts.size());
  for (const uint32_t id : ids) {
    if (id == kNoTriangle || triangle_seen[id]) continue;
    triangle_seen[id] = true;
    ++counts.triangles;
    const uint32_t drawable = owner[id];
    if (drawable_seen[drawable]) continue;
    drawable_seen[drawable] = true;
    ++counts.drawables;
    counts.drawable_triangles += triangle_counts[drawable];
  }
  return counts;
}

}  // namespace sightline
