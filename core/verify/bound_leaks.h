#pragma once
#include <string>
#include <vector>

#include "core/bake/cell_json.h"
#include "core/bound/bound_scene.h"
#include "core/judge/judge.h"
#include "core/pvs/pvs_file.h"

namespace sightline {

/// A triangle of a set that is not in the bound, the ray that meets it first, and where that ray first has a
/// point in an opaque voxel before the triangle.
struct BoundLeak {
  uint32_t triangle = 0;
  Witness ray;
  glm::dvec3 place{0.0};
};

/// What of a cell's set is not in its bound.
struct BoundLeaks {
  std::string cell;
  std::vector<BoundLeak> leaks;       ///< ascending in triangle, here and below
  std::vector<uint32_t> unproved;     ///< their witness meets them up to rounding only
  std::vector<uint32_t> unexplained;  ///< an exact ray meets them first and passes no opaque voxel: the
                                      ///< bound, or the set, is wrong
};

/// set: with witnesses. bound: the ids of a bound of its cell by these voxels.
BoundLeaks findBoundLeaks(const Judge& judge, const BoundScene& voxels, const CellPvs& set,
                          const std::vector<uint32_t>& bound);

/// A line for each cell and for its first leaks.
std::string boundLeaksText(const std::vector<BoundLeaks>& cells);
/// As docs/report.md says.
Json boundLeaksJson(const std::vector<BoundLeaks>& cells);

}  // namespace sightline
