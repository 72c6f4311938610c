#include "core/generate/scene_parts.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <numeric>

#include "core/base/error.h"
#include "core/generate/generator_random.h"
#include "core/scene/instances.h"

namespace sightline {
namespace {

struct Size {
  uint64_t vertices = 0, triangles = 0;
};

constexpr Size kNone{~uint64_t(0), ~uint64_t(0)};

/// Of all copies.
Size sizeOf(const ScenePart& part, uint32_t level) {
  MeshBuilder counter(MeshBuilder::Mode::kCount);
  part.make(counter, level);
  return {part.copies * counter.vertexCount(), part.copies * counter.triangleCount()};
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

namespace {

/// All parts at the levels of the plan, once each.
Scene makeParts(const std::vector<ScenePart>& parts, Plan plan) {
  for (size_t i = 0; i < parts.size(); ++i) {
    plan.sizes[i].vertices /= parts[i].copies;
    plan.sizes[i].triangles /= parts[i].copies;
  }
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

}  // namespace

Scene assembleScene(const std::vector<ScenePart>& parts, uint64_t triangles, uint64_t seed) {
  return makeParts(parts, planLevels(parts, triangles, seed));
}

Scene assembleModules(RepeatedScene repeated, uint64_t triangles, uint64_t seed) {
  std::vector<ScenePart>& parts = repeated.parts;
  std::vector<size_t> ends;  // of the modules' parts
  const size_t plain_parts = parts.size();
  for (SceneModule& module : repeated.modules) {
    for (ScenePart& part : module.parts) {
      part.copies = module.places.size();
      parts.push_back(std::move(part));
    }
    ends.push_back(parts.size());
  }
  const Plan plan = planLevels(parts, triangles, seed);
  const auto sizeBefore = [&](size_t end) {
    Size sum;
    for (size_t i = 0; i < end; ++i) {
      sum.vertices += plan.sizes[i].vertices / parts[i].copies;
      sum.triangles += plan.sizes[i].triangles / parts[i].copies;
    }
    return sum;
  };
  Scene scene = makeParts(parts, plan);
  Size start = sizeBefore(plain_parts);
  std::erase_if(scene.objects, [&](const SceneObject& o) { return o.first_triangle >= start.triangles; });
  uint64_t next_id = start.triangles;
  for (size_t m = 0; m < ends.size(); ++m) {
    const Size end = sizeBefore(ends[m]);
    const auto count = uint32_t(end.triangles - start.triangles);
    if (count != 0) {
      for (const SceneModule::Place& place : repeated.modules[m].places) {
        SceneInstance instance;
        instance.mesh = uint32_t(scene.meshes.size());
        instance.first_id = uint32_t(next_id);
        instance.place = place.place;
        scene.instances.push_back(instance);
        scene.objects.push_back({place.name, uint32_t(next_id), count});
        next_id += count;
      }
      scene.meshes.push_back({uint32_t(start.vertices), uint32_t(end.vertices - start.vertices),
                              uint32_t(start.triangles), count});
    }
    start = end;
  }
  countInstances(scene);
  return scene;
}

}  // namespace sightline
