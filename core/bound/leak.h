#pragma once
#include <optional>

#include "core/bound/blocked_space.h"
#include "core/voxel/lattice.h"

namespace sightline {

/// A place where a segment has a point in an opaque voxel, or on its surface up to rounding: the nearest to
/// `from`, in the scene's space as both ends. A segment that no triangle stops before `to` came there by a
/// gap that no path of voxels without triangles fits through. Nothing: it has none.
std::optional<glm::dvec3> opaquePlace(const glm::dvec3& from, const glm::dvec3& to, const Lattice& lattice,
                                      const BlockedSpace& opaque);

}  // namespace sightline
