#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/cell/view_cell.h"

namespace sightline {

/// Reads and checks a cells file. Unknown keys (but x-...), missing keys, names twice, non-finite numbers,
/// cells without area are errors that name file and place. Throws Error.
std::vector<ViewCell> loadCells(const std::filesystem::path& file);

/// The same for a file's content; `file` is its name, with which errors begin.
std::vector<ViewCell> parseCells(std::string_view text, const std::string& file);

/// Writes a cells file that loadCells reads back exactly.
void saveCells(const std::vector<ViewCell>& cells, const std::filesystem::path& file);

/// The text of a cells file that loadCells reads back exactly. Throws Error that begins with `file`.
std::string cellsText(const std::vector<ViewCell>& cells, const std::string& file);

}  // namespace sightline
