#include "core/gvs/fill_set.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

#include "core/sampling/stage_rays.h"

namespace sightline {

void fillSet(std::span<const PvsEntry> entries, CellPvs& pvs) {
  std::vector<uint32_t> order(entries.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
    return entries[a].origin_triangle.w < entries[b].origin_triangle.w;
  });
  pvs.triangles.reserve(order.size());
  pvs.witnesses.reserve(order.size());
  for (const uint32_t i : order) {
    const Ray ray = entryRay(entries[i]);
    pvs.triangles.push_back(entries[i].origin_triangle.w);
    pvs.witnesses.push_back({xyz3(ray.origin), xyz3(ray.direction), entries[i].direction_stage.w});
  }
}

}  // namespace sightline
