#pragma once
#include <string>
#include <vector>

#include "core/scene/view_cell.h"

namespace sightline {

/// The text of a cells file that loadCells reads back exactly. Throws Error that begins with `file`.
std::string cellsText(const std::vector<ViewCell>& cells, const std::string& file);

}  // namespace sightline
