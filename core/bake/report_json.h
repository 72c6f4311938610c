#pragma once
#include <optional>

#include "core/bake/cell_json.h"
#include "core/bake/report.h"

// What the JSON reports of several commands have in common; keys as docs/report.md says.
namespace sightline {

Json toJson(const SceneSummary& scene);
/// None: null.
Json toJson(const std::optional<DeviceInfo>& device);
/// All but the seed.
Json toJson(const BakeParams& params);

}  // namespace sightline
