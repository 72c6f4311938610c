#include "core/formats/load_scene.h"

#include <fmt/format.h>

#include <map>

#include "core/base/error.h"
#include "core/formats/loaders.h"

namespace sightline {

Scene loadScene(const std::filesystem::path& file, const SceneLoadOptions& options) {
  using Loader = Scene (*)(FileBytes, const std::filesystem::path&, const SceneLoadOptions&);
  static const std::map<std::string, Loader> loaders = {
      {".obj", loadObj}, {".gltf", loadGltf}, {".glb", loadGlb}, {".ply", loadPly}};
  const std::string extension = lowerExtension(file);
  const auto loader = loaders.find(extension);
  if (loader == loaders.end()) {
    throw Error(fmt::format("{}: unknown extension \"{}\", expected .obj, .gltf, .glb or .ply", file.string(),
                            extension));
  }
  FileBytes bytes = readFile(file);
  if (bytes.size == 0) throw Error(fmt::format("{}: is empty", file.string()));
  try {
    return loader->second(std::move(bytes), file, options);
  } catch (const std::bad_alloc&) {
    throw Error(fmt::format("{}: does not fit into memory", file.string()));
  }
}

}  // namespace sightline
