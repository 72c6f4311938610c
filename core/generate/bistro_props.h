#pragma once
#include <cstdint>

#include "core/generate/mesh_builder.h"

namespace sightline {

// Small things of a street cafe, standing on y = 0 of the builder's frame. Low levels leave them out, small
// things longer than large ones; the last level is kBistroLevels.
inline constexpr uint32_t kBistroLevels = 60;
inline constexpr float kTableHeight = 0.74f;

/// Round, 0.36 m in radius, on a column.
void makeTable(MeshBuilder& mesh, uint32_t level);
/// 0.45 m square, its back towards -z.
void makeChair(MeshBuilder& mesh, uint32_t level);
/// Cup with handle, saucer and spoon, within 0.1 m of the axis.
void makeCup(MeshBuilder& mesh, uint32_t level);
/// A bottle and a glass, within 0.15 m of the axis.
void makeBottle(MeshBuilder& mesh, uint32_t level);
/// A small lamp for a table, 0.25 m high.
void makeTableLamp(MeshBuilder& mesh, uint32_t level);
/// Up to 2.6 m high, within 1.4 m of the axis.
void makeParasol(MeshBuilder& mesh, uint32_t level);
/// A pot with a plant of long, bent leaves: within 0.75 m of the axis, up to 1.8 m high.
void makePottedPlant(MeshBuilder& mesh, uint64_t seed, uint32_t level);
/// One strand of a ball of thin fibres around (0, radius, 0) that wind about within the radius.
void makeHairballStrand(MeshBuilder& mesh, float radius, uint64_t seed, uint32_t level);
/// A wire from a to b with bulbs; sags by 0.4 m.
void makeStringLights(MeshBuilder& mesh, glm::vec3 a, glm::vec3 b, uint32_t level);

}  // namespace sightline
