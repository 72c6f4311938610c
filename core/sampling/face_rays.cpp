#include "core/sampling/face_rays.h"

#include <algorithm>
#include <numeric>

#include "core/base/splitmix.h"
#include "core/shared/halton.h"
#include "core/shared/vector.h"

namespace sightline {

uvec4 haltonShifts(uint64_t seed, uint32_t cell_index, RandomUse use) {
  const uint64_t key = splitmix(splitmix(splitmix(seed) ^ cell_index) ^ uint64_t(use));
  const auto shift = [&](uint32_t base, uint64_t period) {
    return static_cast<uint32_t>(splitmix(key ^ base) % period);
  };
  return {shift(2, uint64_t(1) << 32), shift(3, kHaltonPeriod3), shift(5, kHaltonPeriod5),
          shift(7, kHaltonPeriod7)};
}

std::vector<uint32_t> raysByArea(std::span<const Face> faces, uint32_t total) {
  std::vector<double> areas;
  for (const Face& face : faces) {
    areas.push_back(double(length3(xyz3(face.edge_u))) * double(length3(xyz3(face.edge_v))));
  }
  const double whole = std::accumulate(areas.begin(), areas.end(), 0.0);
  std::vector<uint32_t> counts;
  std::vector<std::pair<double, size_t>> remainders;
  uint32_t assigned = 0;
  for (size_t f = 0; f < faces.size(); ++f) {
    const double exact = total * (areas[f] / whole);
    counts.push_back(static_cast<uint32_t>(exact));
    assigned += counts.back();
    remainders.push_back({counts.back() - exact, f});
  }
  std::sort(remainders.begin(), remainders.end());
  for (size_t i = 0; assigned < total; ++i, ++assigned) ++counts[remainders[i % faces.size()].second];
  return counts;
}

}  // namespace sightline
