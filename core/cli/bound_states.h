#pragma once
#include <fmt/core.h>

#include <algorithm>
#include <cstdint>
#include <string>

#include "core/pvs/pvs_file.h"

namespace sightline {

/// The cell of that name, which must be there.
inline const CellPvs& findCell(const PvsFile& pvs, const std::string& name) {
  return *std::find_if(pvs.cells.begin(), pvs.cells.end(),
                       [&](const CellPvs& cell) { return cell.cell.name == name; });
}

/// "15348 seen, 55389 open, 129263 hidden: 70.0 % of what is not seen is proved hidden". seen: in the set;
/// bound: not proved hidden.
inline std::string statesText(uint64_t seen, uint64_t bound, uint64_t all) {
  const uint64_t hidden = all - bound, open = bound - std::min(bound, seen);
  const double share = hidden + open == 0 ? 0 : 100 * double(hidden) / double(hidden + open);
  return fmt::format("{} seen, {} open, {} hidden: {:.1f} % of what is not seen is proved hidden", seen, open,
                     hidden, share);
}

}  // namespace sightline
