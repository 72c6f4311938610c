#pragma once
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

}  // namespace sightline
