#include "core/measure/missing_rays.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "core/base/error.h"
#include "core/sampling/numbered_rays.h"
#include "core/trace/sights.h"

namespace sightline {
namespace {

/// Rays that are traced at once: bounds the memory.
constexpr uint32_t kChunk = 1u << 21;

}  // namespace

std::vector<std::vector<uint64_t>> countMissingRays(Tracer& tracer, const ViewCell& cell, uint32_t cell_index,
                                                    uint64_t seed, uint32_t rays,
                                                    std::span<const RankedSet> sets) {
  if (rays < 1 || rays > kMostMissingRays) {
    throw Error(fmt::format("missing rays must be 1 .. {}", kMostMissingRays), kExitUsage);
  }
  const NumberedRays numbered(cellFaces(cell), haltonShifts(seed, cell_index, RandomUse::kValidation), rays);
  std::vector<std::vector<uint16_t>> levels(sets.size());
  std::vector<std::vector<uint64_t>> by_level(sets.size());  // rays that the first so many prefixes miss
  tbb::parallel_for(size_t(0), sets.size(), [&](size_t s) {
    levels[s] = missingLevels(sets[s]);
    by_level[s].assign(sets[s].prefixes.size() + 1, 0);
  });
  std::vector<Ray> batch(std::min(rays, kChunk));
  Sights sights;
  for (uint32_t first = 0; first < rays; first += kChunk) {
    const uint32_t count = std::min(rays - first, kChunk);
    tbb::parallel_for(0u, count, [&](uint32_t i) { batch[i] = numbered.at(first + i); });
    sights.trace(tracer, std::span(batch).first(count));
    tbb::parallel_for(size_t(0), sets.size(), [&](size_t s) {
      for (uint32_t i = 0; i < count; ++i) {
        // A ray is missed by the prefixes that miss anything that it sees.
        uint16_t level = 0;
        bool sees = false;
        sights.visit(i, [&](uint32_t triangle) {
          level = std::max(level, levels[s][triangle]);
          sees = true;
        });
        if (sees) ++by_level[s][level];
      }
    });
  }

  std::vector<std::vector<uint64_t>> missing(sets.size());
  for (size_t s = 0; s < sets.size(); ++s) {
    missing[s].resize(sets[s].prefixes.size());
    uint64_t sum = 0;
    for (size_t p = missing[s].size(); p-- > 0;) missing[s][p] = sum += by_level[s][p + 1];
  }
  return missing;
}

}  // namespace sightline
