#pragma once
#include <cstdint>
#include <vector>

#include "bvh/bvh.h"
#include "core/scene/surfaces.h"

namespace sightline {

/// A run of leaf order.
struct LeafPart {
  uint32_t first = 0;
  uint32_t count = 0;  ///< at least 1
  bool opaque = true;  ///< rays end on all of them
  uint32_t root = 0;   ///< of the tree that it is a part of, in nodes2 (InstanceRecord::roots)
};

/// The order in which a ray-tracing driver gets the triangles, in parts that it can build.
struct LeafParts {
  std::vector<uint32_t> ids;    ///< every stored triangle (of plain scenes: id) once, as the leaves hold them
  std::vector<LeafPart> parts;  ///< ascending; they tile ids
};

/// Splits the tree (of two levels: each mesh's) along its upper cut into subtrees of at most `limit`
/// triangles (8 at least: a leaf is never split). Triangles that spatial splits put into several leaves stay
/// in the first of them.
LeafParts splitIntoParts(const Bvh& bvh, uint32_t triangle_count, uint32_t limit);

/// The same with each part cut in two where it has both: the triangles that rays end on from either side, and
/// those with a surface of their own. So a driver asks about the latter alone.
LeafParts splitBySurface(const LeafParts& parts, const Surfaces& surfaces);

}  // namespace sightline
