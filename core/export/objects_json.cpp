#include "core/export/objects_json.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <utility>

#include "core/bake/cell_json.h"
#include "core/base/text.h"
#include "core/sampling/numbered_rays.h"
#include "core/trace/sights.h"

namespace sightline {
namespace {

/// Rays that are traced at once: bounds the memory.
constexpr uint32_t kHitChunk = 1u << 20;

/// How many triangles of each object the set holds.
std::vector<uint64_t> visibleOf(const Scene& scene, const CellPvs& cell) {
  std::vector<uint64_t> visible;
  auto id = cell.triangles.begin();
  for (const SceneObject& object : scene.objects) {
    const auto first = id;
    while (id != cell.triangles.end() && *id - object.first_triangle < object.triangle_count) ++id;
    visible.push_back(uint64_t(id - first));
  }
  return visible;
}

Json objectJson(const SceneObject& object, size_t index) {
  Json json = {{"object", index}, {"name", object.name}};
  if (object.part) {
    json["node"] = object.part->node;
    json["mesh"] = object.part->mesh;
    json["primitive"] = object.part->primitive;
  }
  return json;
}

Json cellObjects(const Scene& scene, const CellPvs& cell, const ObjectHits& hits, double least) {
  const std::vector<uint64_t> visible = visibleOf(scene, cell);
  Json objects = Json::array();
  for (size_t i = 0; i < scene.objects.size(); ++i) {
    const double share = hits.hits == 0 ? 0.0 : double(hits.of_object[i]) / double(hits.hits);
    if (visible[i] == 0 || share < least) continue;
    Json object = objectJson(scene.objects[i], i);
    object["triangles"] = scene.objects[i].triangle_count;
    object["visible"] = visible[i];
    object["hits"] = hits.of_object[i];
    object["share"] = share;
    objects.push_back(std::move(object));
  }
  return objects;
}

}  // namespace

ObjectHits countObjectHits(Tracer& tracer, const Scene& scene, const ViewCell& cell, uint32_t cell_index,
                           uint64_t seed, uint32_t rays) {
  const NumberedRays numbered(cellFaces(cell), haltonShifts(seed, cell_index, RandomUse::kCounting), rays);
  ObjectHits result{0, std::vector<uint64_t>(scene.objects.size(), 0)};
  std::vector<Ray> batch(std::min(rays, kHitChunk));
  Sights sights;
  std::vector<uint64_t> last(scene.objects.size(),
                             0);  // by object: number of the last ray that saw it, from 1
  for (uint32_t first = 0; first < rays; first += kHitChunk) {
    const uint32_t count = std::min(rays - first, kHitChunk);
    tbb::parallel_for(0u, count, [&](uint32_t i) { batch[i] = numbered.at(first + i); });
    sights.trace(tracer, std::span(batch).first(count));
    for (uint32_t i = 0; i < count; ++i) {
      const uint64_t number = uint64_t(first) + i + 1;
      bool sees = false;
      sights.visit(i, [&](uint32_t id) {
        const auto behind = std::upper_bound(
            scene.objects.begin(), scene.objects.end(), id,
            [](uint32_t triangle, const SceneObject& object) { return triangle < object.first_triangle; });
        const auto object = size_t(behind - scene.objects.begin()) - 1;
        sees = true;
        if (std::exchange(last[object], number) != number) ++result.of_object[object];
      });
      if (sees) ++result.hits;
    }
  }
  return result;
}

std::string objectsJson(const PvsFile& pvs, const Scene& scene, const std::vector<ObjectHits>& hits,
                        uint32_t rays, double least) {
  Json json = {{"scene", pvs.scene_name},
               {"scene_hash", hashText(pvs.scene_hash)},
               {"scene_triangles", pvs.triangle_count},
               {"rays", rays},
               {"least", least},
               {"cells", Json::array()}};
  for (size_t i = 0; i < hits.size(); ++i) {
    const CellPvs& cell = pvs.cells[i];
    Json entry = cellToJson(cell.cell, pvs.offset);
    entry["visible"] = cell.triangles.size();
    entry["hits"] = hits[i].hits;
    entry["objects"] = cellObjects(scene, cell, hits[i], least);
    json["cells"].push_back(std::move(entry));
  }
  return jsonText(json);
}

}  // namespace sightline
