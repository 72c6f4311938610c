#include "core/export/export.h"

#include <fmt/format.h>

#include <iterator>

#include "core/bake/cell_json.h"
#include "core/base/error.h"
#include "core/base/text.h"

namespace sightline {
namespace {

Json objectsJson(const Scene& scene, const CellPvs& cell) {
  Json objects = Json::array();
  auto id = cell.triangles.begin();
  for (const SceneObject& object : scene.objects) {
    const auto first = id;
    while (id != cell.triangles.end() && *id - object.first_triangle < object.triangle_count) ++id;
    objects.push_back({{"name", object.name},
                       {"first_triangle", object.first_triangle},
                       {"triangles", object.triangle_count},
                       {"visible", uint64_t(id - first)}});
  }
  return objects;
}

void copySurface(const Scene& from, uint32_t triangle, Surfaces& to) {
  uint32_t word = from.surfaceOf(triangle);
  if ((word & kSurfaceMasked) != 0) {
    to.masked.push_back(from.maskPlaces(triangle));
    word = (word & ~kSurfaceIndex) | uint32_t(to.masked.size() - 1);
  }
  to.words.push_back(word);
}

/// Copies the object's visible triangles, from `id` on; new_index: of each vertex, or kNoTriangle.
void copyObject(const Scene& scene, const SceneObject& object, const CellPvs& cell, size_t& id,
                std::vector<uint32_t>& new_index, Scene& visible) {
  const auto first = uint32_t(visible.triangles.size());
  for (; id < cell.triangles.size(); ++id) {
    const uint32_t triangle = cell.triangles[id];
    if (triangle - object.first_triangle >= object.triangle_count) break;
    const auto positions = scene.corners(triangle);
    glm::uvec3 corners = scene.vertexNumbers(triangle);
    for (int corner = 0; corner < 3; ++corner) {
      uint32_t& index = new_index[corners[corner]];
      if (index == kNoTriangle) {
        index = uint32_t(visible.positions.size());
        visible.positions.push_back(positions[size_t(corner)]);
      }
      corners[corner] = index;
    }
    visible.triangles.push_back(corners);
    if (!scene.surfaces.empty()) copySurface(scene, triangle, visible.surfaces);
  }
  const auto count = uint32_t(visible.triangles.size()) - first;
  if (count == 0) return;
  visible.objects.push_back({object.name, first, count});
  visible.objects.back().single_sided = object.single_sided;
}

}  // namespace

std::string idsText(const CellPvs& cell) {
  fmt::memory_buffer text;
  for (uint32_t id : cell.triangles) fmt::format_to(std::back_inserter(text), "{}\n", id);
  return fmt::to_string(text);
}

std::string cellJson(const PvsFile& pvs, const CellPvs& cell, const Scene* scene) {
  Json json = {{"scene", pvs.scene_name},
               {"scene_hash", hashText(pvs.scene_hash)},
               {"scene_triangles", pvs.triangle_count},
               {"cell", cellToJson(cell.cell, pvs.offset)}};
  json["statistics"] = Json::object();
  addCellStatistics(json["statistics"], summarize(cell), pvs.triangle_count);
  if (scene) json["objects"] = objectsJson(*scene, cell);
  json["ids"] = cell.triangles;
  return jsonText(json, -1);
}

Scene visibleScene(const Scene& scene, const CellPvs& cell) {
  if (cell.triangles.empty()) {
    throw Error(fmt::format("cell {} sees no triangle: there is nothing to export", cell.cell.name));
  }
  Scene visible;
  visible.offset = scene.offset;
  visible.surfaces.masks = scene.surfaces.masks;
  visible.surfaces.texels = scene.surfaces.texels;
  std::vector<uint32_t> new_index(scene.vertexCount(), kNoTriangle);
  size_t id = 0;
  for (const SceneObject& object : scene.objects) copyObject(scene, object, cell, id, new_index, visible);
  return visible;
}

}  // namespace sightline
