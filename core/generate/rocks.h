#pragma once
#include <cstdint>

#include "core/generate/mesh_builder.h"

namespace sightline {

// Rocks that stand in the ground at y = 0 of the builder's frame; level 0 is nothing. The last level is
// kRockLevels (30,000 triangles).
inline constexpr uint32_t kRockLevels = 120;

void makeBoulder(MeshBuilder& mesh, float radius, uint64_t seed, uint32_t level);

/// A column with a cap that is wider than its neck.
void makeHoodoo(MeshBuilder& mesh, float height, uint64_t seed, uint32_t level);

/// A parabola of rock from x = -half_span to half_span, in the plane z = 0; its feet reach below y = 0.
struct RockArch {
  float half_span = 0, rise = 0, radius = 0;
  uint64_t seed = 0;
};
void makeRockArch(MeshBuilder& mesh, const RockArch& arch, uint32_t level);

}  // namespace sightline
