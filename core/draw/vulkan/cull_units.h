#pragma once
#include <array>
#include <vector>

#include "core/draw/drawables.h"
#include "vk_shaders/draw_launch.h"

namespace sightline {

/// What a method on the GPU chooses from: units, opaque ones first, then masked, then blended.
struct CullUnits {
  std::vector<CullUnit> units;
  std::array<uint32_t, 4> ends{};  ///< ends[kind] .. ends[kind + 1]: the units of an AlphaKind
  // Of meshlets only:
  std::vector<uint32_t>
      indices;  ///< three vertices a slot, of the opaque units; empty: slots are the drawables'
  std::vector<uint32_t> words;  ///< CullLaunch::meshlets
};

/// A unit a drawable.
CullUnits drawableUnits(const Drawables& drawables);

/// Most vertices and triangles of a meshlet: vk_shaders/meshlet.mesh emits no more.
inline constexpr uint32_t kMeshletVertices = 64, kMeshletTriangles = 124;

/// No fewer units than meshletUnits gives, told without making them.
uint64_t mostMeshletUnits(const Drawables& drawables);

/// Opaque drawables cut into meshlets (meshoptimizer), a unit each; the others as they are. Meshlets have no
/// cones: both sides of a triangle are seen.
CullUnits meshletUnits(const Scene& scene, const Drawables& drawables);

}  // namespace sightline
