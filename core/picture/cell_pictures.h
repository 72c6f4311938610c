#pragma once
#include <filesystem>
#include <string>

#include "core/picture/picture.h"

namespace sightline {

/// Renders the cell from outside and from inside to FOLDER/NNN-NAME-outside.png and -inside.png, where NNN is
/// the index and characters of the name that do not belong into a file name become "_". Makes the folder.
/// Returns the share of the pixels from inside that show a missing triangle. Throws Error.
double saveCellPictures(const TraceRays& trace, const Scene& scene, const CellPvs& cell, uint32_t index,
                        const std::filesystem::path& folder, const TraceGlass& glass = {});

/// "002-street_1" for the cell "street/1" with index 2.
std::string pictureName(const std::string& cell_name, uint32_t index);

}  // namespace sightline
