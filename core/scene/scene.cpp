#include "core/scene/scene.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>
#include <xxhash.h>

#include <array>
#include <bit>
#include <limits>
#include <map>
#include <memory>

#include "core/error.h"
#include "core/scene/loaders.h"

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

uint64_t hashScene(const Scene& scene) {
  static_assert(std::endian::native == std::endian::little, "the hash is of little-endian bytes");
  static_assert(sizeof(glm::vec3) == 12 && sizeof(glm::uvec3) == 12);
  const std::unique_ptr<XXH3_state_t, XXH_errorcode (*)(XXH3_state_t*)> state(XXH3_createState(),
                                                                              XXH3_freeState);
  if (state == nullptr) throw std::bad_alloc();
  const std::array<uint64_t, 2> counts = {scene.positions.size(), scene.triangles.size()};
  XXH3_64bits_reset(state.get());
  XXH3_64bits_update(state.get(), counts.data(), sizeof(counts));
  XXH3_64bits_update(state.get(), scene.positions.data(), scene.positions.size() * sizeof(glm::vec3));
  XXH3_64bits_update(state.get(), scene.triangles.data(), scene.triangles.size() * sizeof(glm::uvec3));
  return XXH3_64bits_digest(state.get());
}

Bounds sceneBounds(const Scene& scene) {
  if (scene.triangles.empty()) return {};
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const Bounds nothing{glm::vec3(kInfinity), glm::vec3(-kInfinity)};
  return tbb::parallel_reduce(
      tbb::blocked_range<size_t>(0, scene.triangles.size(), 1 << 16), nothing,
      [&](const tbb::blocked_range<size_t>& range, Bounds bounds) {
        for (size_t i = range.begin(); i != range.end(); ++i) {
          for (int corner = 0; corner < 3; ++corner) {
            const glm::vec3& position = scene.positions[scene.triangles[i][corner]];
            bounds.low = glm::min(bounds.low, position);
            bounds.high = glm::max(bounds.high, position);
          }
        }
        return bounds;
      },
      [](const Bounds& a, const Bounds& b) {
        return Bounds{glm::min(a.low, b.low), glm::max(a.high, b.high)};
      });
}

}  // namespace sightline
