#pragma once
#include "core/formats/glb.h"
#include "core/formats/load_scene.h"
#include "core/io/file_io.h"

namespace sightline {

/// loadScene for a file's content; `file` is its name, for messages and for files beside it.
Scene parseScene(FileBytes bytes, const std::filesystem::path& file, const SceneLoadOptions& options);

/// One loader a format, for parseScene. `bytes` is the whole file, not empty; `offset` is taken off all
/// coordinates before they are rounded to floats. All throw Error.
using SceneLoader = Scene(std::string_view bytes, const std::filesystem::path& file,
                          const SceneLoadOptions& options, const glm::dvec3& offset);
SceneLoader loadObj, loadGltf, loadPly, loadGlb, loadB3dm;

/// Where a glTF document stands.
struct GltfWorld {
  glm::dmat4 parent{1.0};  ///< of its roots, to the world
  glm::dvec3 offset{0.0};  ///< taken off the world's coordinates
};

/// The scene of a document. Throws Error, NeedsOffset.
Scene loadGltfDocument(const Glb& chunks, const std::filesystem::path& file, const SceneLoadOptions& options,
                       const GltfWorld& world);

}  // namespace sightline
