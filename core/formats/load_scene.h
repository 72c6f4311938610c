#pragma once
#include <filesystem>

#include "core/scene/scene.h"

namespace sightline {

struct SceneLoadOptions {
  /// Drop triangles with an index out of range or a coordinate that is not finite or too large instead of
  /// failing.
  bool repair = false;
  /// Take glTF's alpha masks as opaque, without a look at their textures.
  bool opaque_masks = false;
  /// Triangles that only have a front are not there from behind: those of glTF materials that are not
  /// double-sided; of OBJ and PLY, whose files do not say, all.
  bool cull_back_faces = false;
  /// Fill Scene::faces.
  bool faces = false;
  /// Write out meshes that would be instances (instancesPay). Ids, hash and sets are the same either way.
  bool flatten = false;
};

/// Loads .obj, .gltf, .glb or .ply (by extension, any case). Polygons are triangulated, concave ones too.
/// glTF: the default scene with its nodes' transforms; skins in the pose of their joints, morph targets with
/// their default weights; mirrored nodes keep their front (the corners' order is turned). Of textures only
/// those of alpha masks are read. A mesh that several nodes show is stored once, where that pays
/// (instancesPay) and the file has no surfaces: nothing that one sees through, and no sides. Files that the
/// scene names are read only from its own folder and those below. Throws Error with file and place. The
/// largest files: 20 million triangles take about 1.7 GiB in all as OBJ, half of it as GLB or PLY, and a
/// sixth of OBJ's time.
Scene loadScene(const std::filesystem::path& file, const SceneLoadOptions& options = {});

}  // namespace sightline
