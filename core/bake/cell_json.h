#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include "core/pvs/cell_summary.h"

// JSON shared by the report of a bake and the export of a cell.
namespace sightline {

using Json = nlohmann::ordered_json;

/// name, center, size, rotation, as in a cells file. offset: of the scene, put back.
Json cellToJson(const ViewCell& cell, const glm::dvec3& offset);

/// Adds all statistics of a baked cell; triangles: of the scene.
void addCellStatistics(Json& json, const CellSummary& cell, uint64_t triangles);

/// The text, with a newline at the end. Names need not be UTF-8: bad bytes are replaced, not refused.
std::string jsonText(const Json& json, int indent = 2);

}  // namespace sightline
