#pragma once
#include <string>

#include "core/pvs/pvs_file.h"
#include "core/scene/scene.h"

namespace sightline {

/// One decimal id a line, ascending.
std::string idsText(const CellPvs& cell);

/// Cell, statistics and ids as JSON (docs/report.md); with a scene also its objects with the numbers of
/// their triangles and of those in the set. scene may be null.
std::string cellJson(const PvsFile& pvs, const CellPvs& cell, const Scene* scene);

/// The triangles of the set alone, in the same order, with the vertices that they use and the objects that
/// have any. Throws Error if the set is empty: a scene has at least one triangle.
Scene visibleScene(const Scene& scene, const CellPvs& cell);

}  // namespace sightline
