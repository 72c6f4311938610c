#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/pvs/pvs_file.h"

namespace sightline {

/// A thing that two bakes, A and B, have different values of; "none" where one has none.
struct ValueDifference {
  std::string name;
  std::array<std::string, 2> values;
};

/// Ids in ascending order: how many there are, and the first of them.
struct SomeIds {
  uint64_t count = 0;
  std::vector<uint32_t> first;  ///< kListedIds at most
};
inline constexpr size_t kListedIds = 5;

/// In what a cell that both have baked differs.
struct CellDiff {
  std::string name;
  std::array<SomeIds, 2> only;              ///< triangles of A's set alone, of B's alone
  std::array<SomeIds, 2> only_open;         ///< the same of what the open doors add
  SomeIds witnesses;                        ///< triangles of both whose rays differ in a bit
  std::vector<ValueDifference> statistics;  ///< counts; those that cost only (seconds, bytes) are left out

  bool same() const {
    return only[0].count + only[1].count + only_open[0].count + only_open[1].count + witnesses.count == 0 &&
           statistics.empty();
  }
};

/// Where two bakes differ. What may differ between two runs of the same bake is not compared: times, memory,
/// devices; nor what says nothing about it: the scene's file name, and the version of the format.
struct PvsDiff {
  std::vector<ValueDifference> inputs;  ///< revision, intersection test, scene, parameters, cells
  std::vector<std::string> unmatched;   ///< a line each: a cell that only one of the two has baked
  std::vector<CellDiff> cells;          ///< only those that differ
  uint64_t compared_cells = 0;          ///< that both have baked; 0 where the scenes differ
  uint64_t compared_triangles = 0;      ///< in both sets, over the cells compared

  bool same() const { return inputs.empty() && unmatched.empty() && cells.empty(); }
};

/// Cells are matched by name. Of other scenes (hash or number of triangles) the sets are not compared, for
/// their ids mean other triangles.
PvsDiff diffPvs(const PvsFile& a, const PvsFile& b);

}  // namespace sightline
