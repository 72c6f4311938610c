#pragma once
#include <filesystem>

#include "core/pvs/pvs_file.h"
#include "core/scene/scene.h"

namespace sightline {

/// Throws Error unless `pvs`, read from `file`, was baked of this scene (hash and number of triangles).
void requireScene(const PvsFile& pvs, const Scene& scene, const std::filesystem::path& file);

}  // namespace sightline
