#pragma once
#include <optional>
#include <string_view>

#include "core/io/file_io.h"

namespace sightline {

/// Text in UTF-16, which a byte order mark of either order starts, as UTF-8 without the mark. Nothing if no
/// mark starts the bytes. Half a pair, and a last byte alone, become U+FFFD.
std::optional<FileBytes> fromUtf16(std::string_view bytes);

}  // namespace sightline
