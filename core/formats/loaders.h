#pragma once
#include "core/formats/load_scene.h"
#include "core/io/file_io.h"

namespace sightline {

/// One loader a format, for loadScene. `bytes` is the whole file, not empty, and may be changed; `file` is
/// its name, for messages and for files beside it. All throw Error.
Scene loadObj(FileBytes bytes, const std::filesystem::path& file, const SceneLoadOptions& options);
Scene loadGltf(FileBytes bytes, const std::filesystem::path& file, const SceneLoadOptions& options);
Scene loadPly(FileBytes bytes, const std::filesystem::path& file, const SceneLoadOptions& options);
Scene loadGlb(FileBytes bytes, const std::filesystem::path& file, const SceneLoadOptions& options);

}  // namespace sightline
