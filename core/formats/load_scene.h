#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

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
  /// Extensions that a glTF file may require although they are unknown: it is loaded without what they add.
  std::vector<std::string> ignored_extensions = {};
  /// Read what the scene names (buffers, materials, pictures) wherever it lies, not only in the scene's
  /// folder and those below it.
  bool allow_external = false;
  /// What is taken off the coordinates (Scene::offset), whatever the scene needs: for scenes that are looked
  /// at together.
  std::optional<glm::dvec3> offset = {};
};

/// Loads OBJ, glTF 2.0 (.gltf, .glb), PLY, or a 3D Tile (.b3dm): by what the file holds, and where that does
/// not show (OBJ), by extension, any case. Polygons are triangulated, concave ones too. glTF: the default
/// scene with its nodes' transforms; skins in the pose of their joints, morph targets with their default
/// weights; mirrored nodes keep their front (the corners' order is turned). Of textures only
/// those of alpha masks are read. A mesh that several nodes show is stored once, where that pays
/// (instancesPay) and the file has no surfaces: nothing that one sees through, and no sides. Coordinates are
/// read in double; where floats would not hold them, Scene::offset is taken off. Throws Error with file and
/// place. The largest files: 20 million triangles take about 1.7 GiB in all as OBJ, half of it as GLB or PLY,
/// and a sixth of OBJ's time.
Scene loadScene(const std::filesystem::path& file, const SceneLoadOptions& options = {});

}  // namespace sightline
