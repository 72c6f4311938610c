#include "core/generate/scene_parts.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <numeric>

#include "core/base/error.h"
#include "core/generate/generator_random.h"

namespace sightline {
namespace {

struct Size {
  uint64_t vertices = 0, triangles = 0;
};

constexpr Size kNone{~uint64_t(0), ~uint64_t(0)};

Size sizeOf(const ScenePart& part, uint32_t level) {
  MeshBuilder counter(MeshBuilder::Mode::kCount);
  part.make(counter, level);
  return {counter.vertexCount(), counter.triangleCount()};
}

/// Sizes of all parts at one level (or their highest, where that is less).
std::vector<Size> sizesAt(const std::vector<ScenePart>& parts, uint32_t level) {
  std::vector<Size> sizes(parts.size());
  tbb::parallel_for(size_t(0), parts.size(),
                    [&](size_t i) { sizes[i] = sizeOf(parts[i], std::min(level, parts[i].max_level)); });
  return sizes;
}

uint64_t totalTriangles(const std::vector<Size>& sizes) {
  return std::accumulate(sizes.begin(), sizes.end(), uint64_t(0),
                         [](uint64_t sum, const Size& s) { return sum + s.triangles; });
}

struct Plan {
  std::vector<uint32_t> levels;
  std::vector<Size> sizes;
};

Plan planLevels(const std::vector<ScenePart>& parts, uint64_t triangles, uint64_t seed) {
  uint32_t highest = 0;
  for (const ScenePart& part : parts) highest = std::max(highest, part.max_level);

  uint32_t level = 0;
  std::vector<Size> sizes = sizesAt(parts, 0);
  uint64_t total = totalTriangles(sizes);
  if (total > triangles) {
    throw Error("generated scene: the coarsest has " + std::to_string(total) + " triangles, more than the " +
                std::to_string(triangles) + " asked for");
  }
  while (level < highest) {
    std::vector<Size> finer = sizesAt(parts, level + 1);
    const uint64_t finer_total = totalTriangles(finer);
    if (finer_total > triangles) break;
    sizes = std::move(finer);
    total = finer_total;
    level++;
  }
  Plan plan;
  for (const ScenePart& part : parts) plan.levels.push_back(std::min(level, part.max_level));

  std::vector<size_t> order(parts.size());
  std::iota(order.begin(), order.end(), size_t(0));
  GeneratorRandom random(seed, 0x9a27, 0);
  for (size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.below(uint32_t(i))]);

  // What each part would have one level higher; none where it is as high as it gets.
  std::vector<Size> next(parts.size());
  const auto lookAhead = [&](size_t i) {
    next[i] = plan.levels[i] < parts[i].max_level ? sizeOf(parts[i], plan.levels[i] + 1) : kNone;
  };
  tbb::parallel_for(size_t(0), parts.size(), lookAhead);
  for (bool raised = true; raised;) {
    raised = false;
    for (const size_t i : order) {
      if (next[i].triangles == kNone.triangles || total - sizes[i].triangles + next[i].triangles > triangles)
        continue;
      total = total - sizes[i].triangles + next[i].triangles;
      sizes[i] = next[i];
      plan.levels[i]++;
      lookAhead(i);
      raised = true;
    }
  }
  plan.sizes = std::move(sizes);
  return plan;
}

}  // namespace

Scene assembleScene(const std::vector<ScenePart>& parts, uint64_t triangles, uint64_t seed) {
  const Plan plan = planLevels(parts, triangles, seed);
  std::vector<Size> starts(parts.size() + 1);
  for (size_t i = 0; i < parts.size(); ++i) {
    starts[i + 1] = {starts[i].vertices + plan.sizes[i].vertices,
                     starts[i].triangles + plan.sizes[i].triangles};
  }
  Scene scene;
  scene.positions.resize(starts.back().vertices);
  scene.triangles.resize(starts.back().triangles);
  for (size_t i = 0; i < parts.size(); ++i) {
    if (plan.sizes[i].triangles == 0) continue;
    scene.objects.push_back(
        {parts[i].name, uint32_t(starts[i].triangles), uint32_t(plan.sizes[i].triangles)});
  }
  tbb::enumerable_thread_specific<MeshBuilder> builders;
  tbb::parallel_for(size_t(0), parts.size(), [&](size_t i) {
    MeshBuilder& mesh = builders.local();
    mesh.clear();
    parts[i].make(mesh, plan.levels[i]);
    std::copy(mesh.positions().begin(), mesh.positions().end(),
              scene.positions.begin() + int64_t(starts[i].vertices));
    const glm::uvec3 first(uint32_t(starts[i].vertices));
    std::transform(mesh.triangles().begin(), mesh.triangles().end(),
                   scene.triangles.begin() + int64_t(starts[i].triangles),
                   [first](glm::uvec3 t) { return t + first; });
  });
  return scene;
}

}  // namespace sightline
