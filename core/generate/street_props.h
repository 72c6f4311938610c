#pragma once
#include <cstdint>

#include "core/generate/mesh_builder.h"

namespace sightline {

// Things that stand in a street, on y = 0 of the builder's frame. Up to level 1 they are left out; from then
// on they get finer with the level, up to kPropLevels.
inline constexpr uint32_t kPropLevels = 40;

/// Along the frame's z axis, within 1 m of it and 2.3 m of the origin.
void makeCar(MeshBuilder& mesh, uint64_t seed, uint32_t level);
/// Arm along the frame's +x, within 1.5 m; 5 to 6 m high.
void makeLamp(MeshBuilder& mesh, uint64_t seed, uint32_t level);
/// Crown of leaves from 2.4 to 6 m high, within 1.7 m of the axis.
void makeTree(MeshBuilder& mesh, uint64_t seed, uint32_t level);
/// A litter bin, 1 m high.
void makeBin(MeshBuilder& mesh, uint64_t seed, uint32_t level);
/// A wire hanging from a to b, with a lamp in its middle. Sags by at most 0.6 m, the lamp by 0.5 m more.
void makeWire(MeshBuilder& mesh, glm::vec3 a, glm::vec3 b, uint32_t level);

}  // namespace sightline
