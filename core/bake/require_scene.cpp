#include "core/bake/require_scene.h"

#include <fmt/core.h>

#include "core/base/error.h"

namespace sightline {

void requireScene(const PvsFile& pvs, const Scene& scene, const std::filesystem::path& file) {
  if (pvs.triangle_count == scene.triangleCount() && pvs.scene_hash == hashScene(scene)) return;
  throw Error(
      fmt::format("{}: was baked of another scene ({}, {} triangles; this one has {}{}); bake again, or "
                  "load the scene as that bake did (--repair, --opaque-masks, --cull-back-faces)",
                  file.string(), pvs.scene_name, pvs.triangle_count, scene.triangleCount(),
                  pvs.triangle_count == scene.triangleCount() ? ", but others" : ""));
}

}  // namespace sightline
