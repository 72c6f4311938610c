#pragma once
#include <fmt/core.h>

#include <filesystem>

#include "core/base/error.h"
#include "core/cli/text_outputs.h"
#include "core/io/file_io.h"

namespace sightline {

/// Throws Error if something has the name of a result: scenes, cells and sets may have cost work or hours,
/// and are replaced only where --overwrite is given. Pictures, pages, exports and reports are made of them
/// and are replaced.
inline void requireNew(const std::filesystem::path& file, bool overwrite) {
  std::error_code ignored;
  if (overwrite || isStandardOutput(file) || !std::filesystem::exists(file, ignored)) return;
  requireReplaceable(file);
  throw Error(fmt::format("{}: is there already; name another file, or --overwrite it", file.string()));
}

}  // namespace sightline
