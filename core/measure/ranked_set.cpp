#include "core/measure/ranked_set.h"

#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "core/base/error.h"

namespace sightline {
namespace {

void setRank(RankedSet& set, uint32_t triangle, uint32_t rank) {
  if (triangle >= set.rank.size()) {
    throw Error(
        fmt::format("measure: the set holds triangle {}, the scene has only {}", triangle, set.rank.size()));
  }
  set.rank[triangle] = rank;
}

}  // namespace

RankedSet rankedSet(std::span<const uint32_t> triangles, uint32_t triangle_count) {
  RankedSet set{std::vector<uint32_t>(triangle_count, kNoRank), {1}};
  for (const uint32_t triangle : triangles) setRank(set, triangle, 0);
  return set;
}

RankedSet rankedSet(std::span<const PvsEntry> entries, uint32_t triangle_count,
                    std::vector<uint32_t> prefixes) {
  RankedSet set{std::vector<uint32_t>(triangle_count, kNoRank), std::move(prefixes)};
  uint32_t next = 0;
  for (const PvsEntry& entry : entries) {
    const bool contained = entry.direction_stage.w == kStageContained;
    setRank(set, entry.origin_triangle.w, contained ? 0 : next++);
  }
  return set;
}

std::vector<uint16_t> missingLevels(const RankedSet& set) {
  const auto& sizes = set.prefixes;
  if (sizes.empty() || sizes.size() > 0xffff || !std::is_sorted(sizes.begin(), sizes.end())) {
    throw Error(fmt::format("measure: expected 1 .. 65535 ascending sizes of a set, not {}", sizes.size()));
  }
  std::vector<uint16_t> levels(set.rank.size());
  tbb::parallel_for(size_t(0), levels.size(), [&](size_t i) {
    levels[i] = uint16_t(std::upper_bound(sizes.begin(), sizes.end(), set.rank[i]) - sizes.begin());
  });
  return levels;
}

}  // namespace sightline
