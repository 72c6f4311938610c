#pragma once
#include <optional>
#include <span>
#include <string>

#include "core/cell/view_cell.h"

namespace sightline {

/// What is wrong with a cell, and where: "size[1]", "-2 is negative".
struct CellProblem {
  std::string place;  ///< empty: the cell as a whole
  std::string what;
  std::string text() const { return place.empty() ? what : place + ": " + what; }
};

/// The first thing that makes a cell unfit to bake or to measure: a name that is empty or has control
/// characters, numbers that are not finite, no area, too small or too far away. Nothing: it is sound.
std::optional<CellProblem> cellProblem(const ViewCell& cell);

/// The same for all cells of a bake, "cells[3].size[1]": there must be some, and no name occurs twice.
std::optional<CellProblem> cellProblem(std::span<const ViewCell> cells);

}  // namespace sightline
