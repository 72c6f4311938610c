#include "core/bake/cell_json.h"

#include "core/base/text.h"

namespace sightline {
namespace {

Json toJson(const glm::dvec3& vector) {
  return {vector.x, vector.y, vector.z};
}

Json toJson(const StageStats& stage) {
  return {{"rays", stage.rays}, {"new_triangles", stage.new_triangles}, {"seconds", stage.seconds}};
}

}  // namespace

Json cellToJson(const ViewCell& cell, const glm::dvec3& offset) {
  return {{"name", cell.name},
          {"center", toJson(cell.center + offset)},
          {"size", toJson(cell.size)},
          {"rotation", toJson(cell.rotation)}};
}

void addCellStatistics(Json& json, const CellSummary& cell, uint64_t triangles) {
  const CellStats& stats = cell.stats;
  json["pvs_size"] = cell.pvs_size;
  json["pvs_share"] = triangles == 0 ? 0.0 : double(cell.pvs_size) / double(triangles);
  json["set_hash"] = hashText(cell.set_hash);
  json["iterations"] = stats.iterations;
  json["stop_reason"] = stopReasonName(stats.stop);
  json["rays"] = cell.rays();
  json["mrays_per_s"] = cell.mraysPerSecond();
  json["seconds"] = stats.seconds;
  json["stages"] = {
      {"random", toJson(stats.random)}, {"border", toJson(stats.border)}, {"reverse", toJson(stats.reverse)}};
  json["contained_triangles"] = stats.contained_triangles;
  json["validation_rays"] = stats.validation_rays;
  json["missing_rays"] = stats.missing_rays;
  json["missing_share"] = cell.missingShare();
  json["missing_upper_bound_95"] = cell.missingBound();
  json["error_bound_95"] = stats.error_bound;
  json["error_bound_rays"] = stats.bound_rays;
  json["error_bound_tests"] = stats.bound_tests;
  json["peak_device_bytes"] = stats.peak_device_bytes;
  json["device"] = cell.device;
  if (!cell.open_stats) return;
  const CellStats& open = *cell.open_stats;
  json["open"] = {{"added", cell.open_added},
                  {"set_hash", hashText(cell.open_hash)},
                  {"rays", open.random.rays + open.border.rays + open.reverse.rays},
                  {"iterations", open.iterations},
                  {"stop_reason", stopReasonName(open.stop)},
                  {"validation_rays", open.validation_rays},
                  {"missing_rays", open.missing_rays},
                  {"seconds", open.seconds}};
}

std::string jsonText(const Json& json, int indent) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace sightline
