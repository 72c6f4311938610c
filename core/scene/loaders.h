#pragma once
#include "core/scene/file_io.h"
#include "core/scene/scene.h"

namespace sightline {

/// One loader a format, for loadScene. `bytes` is the whole file and may be changed; `name` is the file's
/// name in messages. All throw Error.
Scene loadObj(FileBytes bytes, const std::string& name, const SceneLoadOptions& options);

}  // namespace sightline
