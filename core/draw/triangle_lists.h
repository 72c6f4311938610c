#pragma once
#include <cstdint>
#include <vector>

namespace sightline {

/// What QueryBackend::submitList draws: lists of triangle ids, each ascending. Of a set (.pvs) a list a cell.
struct TriangleLists {
  std::vector<std::vector<uint32_t>> lists;
};

}  // namespace sightline
