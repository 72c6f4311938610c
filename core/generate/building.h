#pragma once
#include <cstdint>

#include "core/generate/mesh_builder.h"

namespace sightline {

/// Sides of a building, for masks; the frame's axes.
enum BuildingSide : uint32_t { kSideHighZ = 1, kSideHighX = 2, kSideLowZ = 4, kSideLowX = 8 };

/// A house of floors with windows, standing on y = 0 of the frame, over [0, width] x [0, depth] in x and z.
/// Balconies and ledges stand out by at most kBuildingOverhang.
struct BuildingSpec {
  Frame frame;
  float width = 18, depth = 16;
  uint32_t floors = 5;
  float floor_height = 3.3f;
  uint32_t street_sides = kSideHighZ;  ///< these get the rich facades
  uint64_t seed = 0;                   ///< of its style
};
inline constexpr float kBuildingOverhang = 1.2f;
inline constexpr uint32_t kBuildingLevels = 40;

/// Level 0 is a box; then floors, windows, ledges, frames, balconies, shutters turn up; the last levels add
/// slats, bars and roof tiles. Where mesh.closed(), walls and roof are one solid, and all that is on them are
/// solids that touch it.
void makeBuilding(MeshBuilder& mesh, const BuildingSpec& spec, uint32_t level);

}  // namespace sightline
