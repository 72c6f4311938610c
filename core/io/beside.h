#pragma once
#include <filesystem>
#include <optional>
#include <string>

namespace sightline {

/// Where a file lies that a scene names: in the scene's folder or below it. Nothing for an absolute name and
/// one that climbs out by "..": who loads a foreign scene does not let it read the rest of the disk. Links
/// are not looked through; they were put there by whoever owns the folder.
std::optional<std::filesystem::path> besideScene(const std::filesystem::path& scene, const std::string& name);

}  // namespace sightline
