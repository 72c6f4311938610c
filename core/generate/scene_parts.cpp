#include "core/generate/scene_parts.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <optional>

#include "core/base/error.h"
#include "core/generate/generator_random.h"
#include "core/generate/leaf_mask.h"
#include "core/scene/instances.h"
#include "core/scene/masked_triangle.h"

namespace sightline {
namespace {

/// What the objects of each matter of a part are called after it.
constexpr std::array<std::pair<Matter, const char*>, 3> kMatters = {
    {{Matter::kSolid, ""}, {Matter::kPane, "-panes"}, {Matter::kLeaf, "-leaves"}}};

/// Of one copy.
MeshSize sizeOf(const ScenePart& part, uint32_t level, const MeshOptions& options) {
  MeshBuilder counter(MeshBuilder::Mode::kCount, options);
  part.make(counter, level);
  return counter.size();
}

/// Sizes of all parts at one level (or their highest, where that is less).
std::vector<MeshSize> sizesAt(const std::vector<ScenePart>& parts, uint32_t level,
                              const MeshOptions& options) {
  std::vector<MeshSize> sizes(parts.size());
  tbb::parallel_for(size_t(0), parts.size(), [&](size_t i) {
    sizes[i] = sizeOf(parts[i], std::min(level, parts[i].max_level), options);
  });
  return sizes;
}

/// Of all copies.
uint64_t trianglesOf(const ScenePart& part, const MeshSize& size) {
  return part.copies * size.allTriangles();
}

uint64_t totalTriangles(const std::vector<ScenePart>& parts, const std::vector<MeshSize>& sizes) {
  uint64_t sum = 0;
  for (size_t i = 0; i < parts.size(); ++i) sum += trianglesOf(parts[i], sizes[i]);
  return sum;
}

/// Of each part.
struct Plan {
  std::vector<uint32_t> levels;
  std::vector<MeshSize> sizes;
};

Plan planLevels(const std::vector<ScenePart>& parts, uint64_t triangles, uint64_t seed,
                const MeshOptions& options) {
  uint32_t highest = 0;
  for (const ScenePart& part : parts) highest = std::max(highest, part.max_level);

  uint32_t level = 0;
  std::vector<MeshSize> sizes = sizesAt(parts, 0, options);
  uint64_t total = totalTriangles(parts, sizes);
  if (total > triangles) {
    throw Error("generated scene: the coarsest has " + std::to_string(total) + " triangles, more than the " +
                std::to_string(triangles) + " asked for");
  }
  while (level < highest) {
    std::vector<MeshSize> finer = sizesAt(parts, level + 1, options);
    const uint64_t finer_total = totalTriangles(parts, finer);
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
  std::vector<std::optional<MeshSize>> next(parts.size());
  const auto lookAhead = [&](size_t i) {
    next[i].reset();
    if (plan.levels[i] < parts[i].max_level) next[i] = sizeOf(parts[i], plan.levels[i] + 1, options);
  };
  tbb::parallel_for(size_t(0), parts.size(), lookAhead);
  for (bool raised = true; raised;) {
    raised = false;
    for (const size_t i : order) {
      if (!next[i]) continue;
      const uint64_t with_next = total - trianglesOf(parts[i], sizes[i]) + trianglesOf(parts[i], *next[i]);
      if (with_next > triangles) continue;
      total = with_next;
      sizes[i] = *next[i];
      plan.levels[i]++;
      lookAhead(i);
      raised = true;
    }
  }
  plan.sizes = std::move(sizes);
  return plan;
}

/// What lies before each part, and behind the last.
std::vector<MeshSize> startsOf(const std::vector<MeshSize>& sizes) {
  std::vector<MeshSize> starts(sizes.size() + 1);
  for (size_t i = 0; i < sizes.size(); ++i) {
    starts[i + 1] = starts[i];
    starts[i + 1].vertices += sizes[i].vertices;
    starts[i + 1].leaf_vertices += sizes[i].leaf_vertices;
    for (size_t m = 0; m < kMatters.size(); ++m) starts[i + 1].triangles[m] += sizes[i].triangles[m];
  }
  return starts;
}

/// An object for each matter that a part has.
void addObjects(const std::string& name, const MeshSize& size, Scene& scene, uint32_t first) {
  for (const auto& [matter, suffix] : kMatters) {
    const auto count = uint32_t(size.of(matter));
    if (count != 0) scene.objects.push_back({name + suffix, first, count});
    first += count;
  }
}

/// Copies a part into its place in a scene. start: what lies before it; all: the whole.
void placePart(const MeshBuilder& mesh, const MeshSize& start, const MeshSize& all, Scene& scene) {
  const auto& places = mesh.places();
  const auto isLeaf = [&](size_t vertex) {
    return vertex < places.size() && places[vertex] != MeshBuilder::kNoPlace;
  };
  std::vector<uint32_t> numbers(mesh.positions().size());
  uint64_t solid = start.vertices - start.leaf_vertices;
  uint64_t leaf = all.vertices - all.leaf_vertices + start.leaf_vertices;
  for (size_t v = 0; v < numbers.size(); ++v) {
    numbers[v] = uint32_t(isLeaf(v) ? leaf++ : solid++);
    scene.positions[numbers[v]] = mesh.positions()[v];
  }
  std::array<uint64_t, 3> next{};  // triangle of each matter
  uint64_t first = start.allTriangles();
  for (size_t m = 0; m < kMatters.size(); ++m) {
    next[m] = first;
    first += mesh.size().triangles[m];
  }
  uint64_t masked = start.of(Matter::kLeaf);
  for (size_t i = 0; i < mesh.triangles().size(); ++i) {
    const glm::uvec3 t = mesh.triangles()[i];
    const Matter matter = mesh.matters().empty() ? Matter::kSolid : mesh.matters()[i];
    const uint64_t id = next[size_t(matter)]++;
    scene.triangles[id] = {numbers[t.x], numbers[t.y], numbers[t.z]};
    if (matter == Matter::kPane) scene.surfaces.words[id] = kSurfaceGlass;
    if (matter != Matter::kLeaf) continue;
    const auto at = [&](uint32_t vertex) { return glm::dvec2(places[vertex]) * double(kLeafTexels); };
    scene.surfaces.masked[masked] = *maskedTriangle(scene.surfaces, 0, {at(t.x), at(t.y), at(t.z)});
    scene.surfaces.words[id] = kSurfaceMasked | uint32_t(masked++);
  }
}

/// All parts at the levels of the plan, once each.
Scene makeParts(const std::vector<ScenePart>& parts, const Plan& plan, const MeshOptions& options) {
  const std::vector<MeshSize> starts = startsOf(plan.sizes);
  const MeshSize& all = starts.back();
  Scene scene;
  scene.positions.resize(all.vertices);
  scene.triangles.resize(all.allTriangles());
  scene.alpha_triangles = all.of(Matter::kPane) + all.of(Matter::kLeaf);
  if (scene.alpha_triangles != 0) scene.surfaces.words.resize(all.allTriangles(), 0);
  scene.surfaces.masked.resize(all.of(Matter::kLeaf));
  if (all.of(Matter::kLeaf) != 0) addLeafMask(scene.surfaces);
  for (size_t i = 0; i < parts.size(); ++i) {
    addObjects(parts[i].name, plan.sizes[i], scene, uint32_t(starts[i].allTriangles()));
  }
  tbb::enumerable_thread_specific<MeshBuilder> builders(MeshBuilder::Mode::kStore, options);
  tbb::parallel_for(size_t(0), parts.size(), [&](size_t i) {
    MeshBuilder& mesh = builders.local();
    mesh.clear();
    parts[i].make(mesh, plan.levels[i]);
    placePart(mesh, starts[i], all, scene);
  });
  return scene;
}

}  // namespace

Scene assembleScene(const std::vector<ScenePart>& parts, uint64_t triangles, uint64_t seed,
                    const MeshOptions& options) {
  return makeParts(parts, planLevels(parts, triangles, seed, options), options);
}

Scene assembleModules(RepeatedScene repeated, uint64_t triangles, uint64_t seed, const MeshOptions& options) {
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
  const Plan plan = planLevels(parts, triangles, seed, options);
  const std::vector<MeshSize> starts = startsOf(plan.sizes);
  Scene scene = makeParts(parts, plan, options);
  MeshSize start = starts[plain_parts];
  uint64_t next_id = start.allTriangles();
  std::erase_if(scene.objects, [&](const SceneObject& o) { return o.first_triangle >= next_id; });
  for (size_t m = 0; m < ends.size(); ++m) {
    const MeshSize& end = starts[ends[m]];
    const auto first = uint32_t(start.allTriangles());
    const auto count = uint32_t(end.allTriangles() - first);
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
      scene.meshes.push_back(
          {uint32_t(start.vertices), uint32_t(end.vertices - start.vertices), first, count});
    }
    start = end;
  }
  countInstances(scene);
  return scene;
}

}  // namespace sightline
