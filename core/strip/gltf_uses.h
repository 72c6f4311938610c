#pragma once
#include <nlohmann/json.hpp>
#include <vector>

#include "core/formats/gltf_document.h"
#include "core/strip/strip_formats.h"

namespace sightline {

/// What becomes of a primitive.
struct PrimitivePlan {
  bool whole = true;       ///< it is not touched
  bool loses = false;      ///< triangles
  bool gone = false;       ///< it leaves its mesh
  std::vector<bool> kept;  ///< its triangles; empty if it is whole
};

struct MeshPlan {
  std::vector<PrimitivePlan> primitives;
  bool unshown = false;  ///< nothing is left: no node shows it any more; its first primitive with triangles
                         ///< keeps one, since a mesh must have something
};

/// A plan for each mesh. root: of the document's JSON. Fills in what the report keeps, its objects and notes.
std::vector<MeshPlan> planMeshes(const GltfDocument& document, const nlohmann::json& root,
                                 const StripInput& input, StripReport& report);

}  // namespace sightline
