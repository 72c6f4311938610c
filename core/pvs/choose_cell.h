#pragma once
#include <filesystem>
#include <string>

#include "core/pvs/pvs_file.h"

namespace sightline {

/// The baked cell that a person asked for: by its name, else by its index from 0. Throws Error that says
/// which cells `file` has.
const CellPvs& chooseCell(const PvsFile& pvs, const std::string& name_or_index,
                          const std::filesystem::path& file);

}  // namespace sightline
