#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/strip/strip_scene.h"

namespace sightline {

/// A file to write.
struct StrippedFile {
  std::filesystem::path path;
  std::string bytes;
};

/// What stripping a file gives, before anything is written; the scene file is the last of `files`.
struct Stripped {
  std::vector<StrippedFile> files;
  StripReport report;
};

/// What to strip: the file's bytes, its scene, and what of that is seen.
struct StripInput {
  std::string_view bytes;
  const std::filesystem::path& file;
  const Scene& scene;
  const std::vector<bool>& seen;
  const StripOptions& options;
  const std::filesystem::path& out;
};

/// One a format, for stripScene.
Stripped stripObj(const StripInput& input);
Stripped stripPly(const StripInput& input);
Stripped stripGltf(const StripInput& input);

/// Of OBJ and PLY: which faces stay, by their numbers in the file. Fills in what the report keeps, and its
/// objects.
std::vector<bool> keptFaces(const StripInput& input, StripReport& report);

}  // namespace sightline
