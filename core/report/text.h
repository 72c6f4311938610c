#pragma once
#include <cstdint>
#include <span>
#include <string>

#include "core/pvs/cell_summary.h"
#include "core/scene/cell_check.h"

// Numbers and tables for people.
namespace sightline {

/// 950, 12.3k, 4.56M, 7.89G: three digits.
std::string shortCount(uint64_t count);
/// "1 cell", "2 cells": the noun takes an s unless there is one.
std::string counted(uint64_t count, const std::string& noun);
/// 0.4 s, 12 s, 3 min 05 s, 2 h 07 min. Unknown (negative or not finite): "?".
std::string shortDuration(double seconds);
/// "random", "border", "reverse" or "contained".
std::string stageName(uint32_t stage);

/// 16 hexadecimal digits.
std::string hashText(uint64_t hash);

/// The names of the warnings' verdicts, with commas between them.
std::string verdictNames(std::span<const CellWarning> warnings);

/// A line a cell: triangles, share of the scene, rays, Mrays/s, iterations, missing-ray share with the upper
/// end of its 95 % interval, seconds, verdicts of its warnings (a list a cell; without lists: none). Ends
/// with a newline.
std::string cellTable(std::span<const CellSummary> cells, uint32_t triangle_count,
                      std::span<const std::vector<CellWarning>> warnings = {});

}  // namespace sightline
