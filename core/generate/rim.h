#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/generate/mesh_builder.h"

namespace sightline {

/// Vertices along an edge, at least two.
using Seam = std::vector<uint32_t>;

/// The rim of something with four sides, counterclockwise seen from where its cap faces: the last vertex of a
/// side is the first of the next.
struct Rim {
  std::array<Seam, 4> sides;
};

/// Of four vertices.
Rim rimOf(const std::array<uint32_t, 4>& corners);

/// The triangles between two seams that run side by side, each with vertices of its own: faces the side from
/// which `a` is on the left and `b` on the right, where both run up.
void closeBetween(MeshBuilder& mesh, const Seam& a, const Seam& b);

/// The band between two rims, side by side: as a wall, from below to above, faces outwards.
void closeBetween(MeshBuilder& mesh, const Rim& below, const Rim& above);

/// A fan from `middle` over the polygon of these vertices, counterclockwise seen from where it faces.
void closeFan(MeshBuilder& mesh, uint32_t middle, std::span<const uint32_t> polygon);

/// Fans over what a rim encloses; faces where it is counterclockwise, or the other way.
void closeCap(MeshBuilder& mesh, const Rim& rim, uint32_t middle, bool other_way = false);

/// A solid block from low to high: its upper face is of nu by nv quads, two triangles each.
void closedBlock(MeshBuilder& mesh, glm::vec3 low, glm::vec3 high, uint32_t nu, uint32_t nv);

}  // namespace sightline
