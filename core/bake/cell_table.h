#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/pvs/cell_summary.h"
#include "core/scene/cell_check.h"

namespace sightline {

/// The names of the warnings' verdicts, with commas between them.
std::string verdictNames(std::span<const CellWarning> warnings);

/// A line a cell: triangles, share of the scene, rays, Mrays/s, iterations, missing-ray share with the upper
/// end of its 95 % interval, seconds, verdicts of its warnings (a list a cell; without lists: none). Ends
/// with a newline.
std::string cellTable(std::span<const CellSummary> cells, uint32_t triangle_count,
                      std::span<const std::vector<CellWarning>> warnings = {});

}  // namespace sightline
