#include "core/bake/report_json.h"

#include "core/base/text.h"

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
  return {{"method", methodName(params.method)},
          {"n_rand", params.n_rand},
          {"n_abs_edge", params.n_abs_edge},
          {"n_rs_edge", params.n_rs_edge},
          {"n_rs_area", params.n_rs_area},
          {"delta_abs_relative", params.delta_abs_relative},
          {"delta_abs", params.delta_abs},
          {"delta_rs_relative", params.delta_rs_relative},
          {"delta_rs", params.delta_rs},
          {"threshold", params.threshold},
          {"quiet_iterations", params.quiet_iterations},
          {"max_rays", params.max_rays},
          {"max_seconds", params.max_seconds},
          {"batch_rays", params.batch_rays},
          {"validation_rays", params.validation_rays},
          {"raster_resolution", params.raster_resolution},
          {"target_error", params.target_error},
          {"abs_spacing", params.abs_spacing},
          {"reverse_stride", params.reverse_stride},
          {"order", orderName(params.order)}};
}

}  // namespace sightline
