#pragma once
#include <filesystem>

#include "core/scene/scene.h"

namespace sightline {

/// Writes .obj or .glb (by extension) so that loadScene returns the same positions, triangles and objects,
/// bit for bit. Writes to a temporary name and renames. A GLB holds less than 4 GiB. Throws Error.
void saveScene(const Scene& scene, const std::filesystem::path& file);

}  // namespace sightline
