#include "core/formats/saved_runs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "core/base/error.h"
#include "core/formats/scene_builder.h"

namespace sightline {
namespace {

/// A vertex of the scene with a place in an image.
using PlacedVertex = std::tuple<uint32_t, float, float>;

bool isMasked(const Scene& scene, uint32_t triangle) {
  return (scene.surfaces.of(triangle) & kSurfaceMasked) != 0;
}

SavedMaterial materialOf(const Scene& scene, const SceneObject& object, uint32_t triangle) {
  const uint32_t word = scene.surfaces.of(triangle);
  SavedMaterial material;
  material.double_sided = !object.single_sided && (word & kSurfaceFrontOnly) == 0;
  material.glass = (word & kSurfaceGlass) != 0;
  if ((word & kSurfaceMasked) != 0) {
    material.mask = scene.surfaces.masked[word & kSurfaceIndex].corner_c_mask.z;
  }
  return material;
}

size_t numberOf(std::vector<SavedMaterial>& materials, const SavedMaterial& material) {
  const auto found = std::ranges::find(materials, material);
  if (found != materials.end()) return size_t(found - materials.begin());
  materials.push_back(material);
  return materials.size() - 1;
}

/// The floats that glTF has; loading makes the record's whole numbers of them again, where 24 bits hold
/// these.
glm::vec2 placeIn(const Scene& scene, uint32_t triangle, int corner) {
  const MaskedTriangle& record = scene.surfaces.masked[scene.surfaces.of(triangle) & kSurfaceIndex];
  const uvec4 &ab = record.corners_ab, &c = record.corner_c_mask;
  const glm::uvec2 units[3] = {{ab.x, ab.y}, {ab.z, ab.w}, {c.x, c.y}};
  const uvec4 size = scene.surfaces.masks[c.z].size_wrap_first;
  const auto share = [&](uint32_t place, uint32_t texels) {
    return float(std::ldexp(double(int64_t(place) - int64_t(kTexelOffset)), -int(c.w)) / double(texels));
  };
  return {share(units[corner].x, size.x), share(units[corner].y, size.y)};
}

/// Gives a masked run vertices of its own, in the scene's order.
void ownVertices(const Scene& scene, SavedRuns& saved, SavedRun& run) {
  std::map<PlacedVertex, uint32_t> numbers;
  const auto vertexOf = [&](uint32_t triangle, int corner) {
    const glm::vec2 place = placeIn(scene, triangle, corner);
    return PlacedVertex{scene.triangles[triangle][corner], place.x, place.y};
  };
  const uint32_t end = run.first_triangle + run.triangle_count;
  for (uint32_t t = run.first_triangle; t < end; ++t) {
    for (int corner = 0; corner < 3; ++corner) numbers.emplace(vertexOf(t, corner), 0);
  }
  run.first_position = uint32_t(saved.positions.size());
  for (auto& [vertex, number] : numbers) {
    number = run.position_count++;
    saved.positions.push_back(scene.positions[std::get<0>(vertex)]);
    saved.places.emplace_back(std::get<1>(vertex), std::get<2>(vertex));
  }
  for (uint32_t t = run.first_triangle; t < end; ++t) {
    for (int corner = 0; corner < 3; ++corner) saved.triangles[t][corner] = numbers.at(vertexOf(t, corner));
  }
}

/// The vertices that others use, or none, in order; then those of masked runs.
void splitVertices(const Scene& scene, SavedRuns& saved) {
  std::vector<bool> masked(scene.positions.size(), false), other(scene.positions.size(), false);
  for (uint32_t t = 0; t < scene.triangles.size(); ++t) {
    std::vector<bool>& uses = isMasked(scene, t) ? masked : other;
    for (int corner = 0; corner < 3; ++corner) uses[scene.triangles[t][corner]] = true;
  }
  std::vector<uint32_t> numbers(scene.positions.size(), 0);
  for (size_t i = 0; i < numbers.size(); ++i) {
    if (masked[i] && !other[i]) continue;
    numbers[i] = uint32_t(saved.positions.size());
    saved.positions.push_back(scene.positions[i]);
  }
  saved.shared_positions = uint32_t(saved.positions.size());
  saved.triangles.reserve(scene.triangles.size());
  for (const glm::uvec3& t : scene.triangles) {
    saved.triangles.emplace_back(numbers[t.x], numbers[t.y], numbers[t.z]);
  }
  for (SavedRun& run : saved.runs) {
    if (saved.materials[run.material].mask) ownVertices(scene, saved, run);
  }
}

}  // namespace

SavedRuns splitIntoRuns(const Scene& scene) {
  SavedRuns saved;
  for (uint32_t i = 0; i < scene.objects.size(); ++i) {
    const SceneObject& object = scene.objects[i];
    const uint32_t first =
        scene.hasInstances() ? scene.stored(object.first_triangle).triangle : object.first_triangle;
    uint32_t begin = 0;
    while (begin < object.triangle_count) {
      const SavedMaterial material = materialOf(scene, object, first + begin);
      uint32_t end = scene.surfaces.empty() ? object.triangle_count : begin + 1;
      while (end < object.triangle_count && materialOf(scene, object, first + end) == material) ++end;
      saved.runs.push_back({i, first + begin, end - begin, numberOf(saved.materials, material)});
      begin = end;
    }
  }
  for (const SavedMaterial& material : saved.materials) {
    if (material.mask && std::ranges::count(saved.masks, *material.mask) == 0) {
      saved.masks.push_back(*material.mask);
    }
  }
  if (!saved.masks.empty()) splitVertices(scene, saved);
  return saved;
}

void checkWritable(const Scene& scene, const std::string& file) {
  if (scene.triangles.empty()) throw Error(fmt::format("{}: the scene holds no triangles", file));
  for (size_t i = 0; i < scene.objects.size(); ++i) {
    const std::string& name = scene.objects[i].name;
    if (!name.empty() && cleanName(name) == name) continue;
    throw Error(
        fmt::format("{}: object {} has a name that a file cannot hold: it is empty, not UTF-8, or has "
                    "control characters or blanks at an end",
                    file, i));
  }
}

}  // namespace sightline
