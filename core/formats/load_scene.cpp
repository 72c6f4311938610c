#include "core/formats/load_scene.h"

#include <fmt/format.h>

#include "core/base/error.h"
#include "core/formats/loaders.h"
#include "core/formats/scene_builder.h"
#include "core/formats/scene_format.h"
#include "core/formats/utf16.h"

namespace sightline {
namespace {

SceneLoader* loaderOf(std::string_view bytes, const std::filesystem::path& file) {
  switch (formatOf(bytes, file)) {
    case SceneFormat::kObj:
      return loadObj;
    case SceneFormat::kGltf:
      return loadGltf;
    case SceneFormat::kGlb:
      return loadGlb;
    case SceneFormat::kPly:
      return loadPly;
    case SceneFormat::kB3dm:
      return loadB3dm;
  }
  return loadObj;
}

}  // namespace

Scene parseScene(FileBytes bytes, const std::filesystem::path& file, const SceneLoadOptions& options) {
  if (bytes.size == 0) throw Error(fmt::format("{}: is empty", file.string()));
  try {
    const std::string foreign = foreignContent(bytes.view());
    if (!foreign.empty()) throw Error(fmt::format("{}: {}", file.string(), foreign));
    if (std::optional<FileBytes> text = fromUtf16(bytes.view())) bytes = std::move(*text);
    SceneLoader* load = loaderOf(bytes.view(), file);
    try {
      return load(bytes.view(), file, options, options.offset.value_or(glm::dvec3(0.0)));
    } catch (const NeedsOffset& needs) {
      // Read again, rather than moved, so that each coordinate is rounded once, from all of its digits.
      return load(bytes.view(), file, options, needs.offset);
    }
  } catch (const std::bad_alloc&) {
    throw Error(fmt::format("{}: does not fit into memory", file.string()));
  }
}

Scene loadScene(const std::filesystem::path& file, const SceneLoadOptions& options) {
  return parseScene(readFile(file), file, options);
}

}  // namespace sightline
