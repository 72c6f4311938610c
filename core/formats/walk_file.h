#pragma once
#include <filesystem>
#include <string>
#include <string_view>

#include "core/path/camera_path.h"

namespace sightline {

/// Reads and checks a walk file (walk.json). "fov" and "cuts" may be missing: kDefaultPathFov, none. Unknown
/// keys (but x-...), missing ones and what pathProblem finds are errors that name file and place. Throws
/// Error, with exit code 2 for what is in the file.
CameraPath loadWalk(const std::filesystem::path& file);

/// The same for a file's content; `file` is its name, with which errors begin.
CameraPath parseWalk(std::string_view text, const std::string& file);

/// The text of a walk file that loadWalk reads back exactly. Throws Error that begins with `file`.
std::string walkText(const CameraPath& path, const std::string& file);

}  // namespace sightline
