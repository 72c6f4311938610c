#include "core/scene/scene.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>
#include <xxhash.h>

#include <array>
#include <bit>
#include <limits>
#include <memory>

namespace sightline {

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
  if (scene.offset != glm::dvec3(0.0)) {
    XXH3_64bits_update(state.get(), &scene.offset, sizeof(scene.offset));
  }
  const auto add = [&](const auto& list) {
    const uint64_t size = list.size();
    XXH3_64bits_update(state.get(), &size, sizeof(size));
    XXH3_64bits_update(state.get(), list.data(), size * sizeof(list[0]));
  };
  if (const Surfaces& surfaces = scene.surfaces; !surfaces.empty()) {
    add(surfaces.words);
    add(surfaces.masked);
    add(surfaces.masks);
    add(surfaces.texels);
  }
  return XXH3_64bits_digest(state.get());
}

Bounds sceneBounds(const Scene& scene) {
  if (scene.triangleCount() == 0) return {};
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const Bounds nothing{glm::vec3(kInfinity), glm::vec3(-kInfinity)};
  return tbb::parallel_reduce(
      tbb::blocked_range<uint32_t>(0, scene.triangleCount(), 1 << 16), nothing,
      [&](const tbb::blocked_range<uint32_t>& range, Bounds bounds) {
        for (uint32_t i = range.begin(); i != range.end(); ++i) {
          for (const glm::vec3& position : scene.corners(i)) {
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
