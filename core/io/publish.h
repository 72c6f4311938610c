#pragma once
#include <cstdint>
#include <filesystem>
#include <span>

namespace sightline {

/// Writes all bytes. Throws Error that names `file`.
void writeAll(int descriptor, std::span<const uint8_t> bytes, const std::filesystem::path& file);

/// Flushes the file to the disk, renames it to `to` and flushes the folder. Throws Error.
void publish(int descriptor, const std::filesystem::path& from, const std::filesystem::path& to);

}  // namespace sightline
