#pragma once
#include <filesystem>
#include <optional>
#include <string>

namespace sightline {

/// Where a file lies that a scene names, which need not be there: in the scene's folder or below it. Nothing
/// for an absolute name, one that climbs out by "..", and one that a link leads out: who loads a foreign
/// scene does not let it read the rest of the disk. allow_external: any place is fine (SceneLoadOptions).
std::optional<std::filesystem::path> besideScene(const std::filesystem::path& scene, const std::string& name,
                                                 bool allow_external = false);

}  // namespace sightline
