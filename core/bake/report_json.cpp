#include "core/bake/report_json.h"

#include "core/base/text.h"
#include "core/pvs/param_table.h"

namespace sightline {

Json toJson(const SceneSummary& scene) {
  return {{"name", scene.name},
          {"hash", hashText(scene.hash)},
          {"triangles", scene.triangles},
          {"vertices", scene.vertices},
          {"objects", scene.objects},
          {"degenerate_triangles", scene.degenerate},
          {"repaired_triangles", scene.repaired},
          {"alpha_triangles", scene.alpha},
          {"glass_triangles", scene.glass},
          {"single_sided_triangles", scene.single_sided},
          {"hidden_nodes", scene.hidden_nodes},
          {"offset", {scene.offset.x, scene.offset.y, scene.offset.z}},
          {"instances", scene.instances},
          {"stored_triangles", scene.stored_triangles},
          {"surfaces",
           {{"masked_triangles", scene.surfaces.masked},
            {"see_through_triangles", scene.surfaces.glass},
            {"front_only_triangles", scene.surfaces.front_only},
            {"opaque_mask_triangles", scene.opaque_masks}}},
          {"warnings", scene.warnings}};
}

Json toJson(const std::optional<DeviceInfo>& device) {
  if (!device) return nullptr;
  return {{"id", device->id},
          {"name", device->name},
          {"driver", device->driver},
          {"layout", device->layout},
          {"exact", device->exact},
          {"memory_bytes", device->memory_bytes},
          {"driver_tree_parts", device->driver_tree_parts},
          {"driver_tree_bytes", device->driver_tree_bytes},
          {"driver_tree_build_seconds", device->driver_tree_build_seconds}};
}

Json toJson(const BakeParams& params) {
  Json json;
  visitParams(params, [&](const Param& param, const auto& value) {
    if constexpr (std::is_enum_v<std::remove_cvref_t<decltype(value)>>) {
      json[param.name] = valueText(param, params);
    } else {
      json[param.name] = value;
    }
  });
  json.erase("seed");  // the reports have it beside the parameters
  return json;
}

}  // namespace sightline
