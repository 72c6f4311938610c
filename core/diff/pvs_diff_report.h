#pragma once
#include <string>
#include <vector>

#include "core/bake/cell_json.h"
#include "core/diff/pvs_diff.h"

namespace sightline {

/// A line a difference, inputs first; none for bakes that are the same.
std::vector<std::string> diffLines(const PvsDiff& diff);

/// "the same: 3 cells, 120 triangles", or in how many places they differ.
std::string diffVerdict(const PvsDiff& diff);

/// Everything, keys as docs/report.md says.
Json diffJson(const PvsDiff& diff);

}  // namespace sightline
