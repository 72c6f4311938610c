#pragma once
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>

#include "core/scene/scene.h"

namespace sightline {

/// The cubes of side 2^exponent whose corners have whole multiples of it as coordinates, in the scene's units
/// and space (Scene::offset taken off). Voxel (i, j, k) is the closed cube from corner (i, j, k) to (i + 1, j
/// + 1, k + 1). A power of two: then float coordinates over the voxel's size are exact doubles, and all that
/// is said of voxels and triangles can be decided without rounding.
struct Lattice {
  int exponent = 0;

  double voxelSize() const { return std::ldexp(1.0, exponent); }
  /// A place in voxels: exact.
  glm::dvec3 toVoxels(const glm::vec3& place) const { return glm::dvec3(place) * std::ldexp(1.0, -exponent); }
  bool operator==(const Lattice&) const = default;
};

/// Voxels along an axis of a grid at most.
inline constexpr int64_t kMostVoxelsAlong = 65536;
/// Voxels are at most so far from corner (0, 0, 0) along each axis.
inline constexpr int64_t kLargestVoxelPlace = int64_t(1) << 26;

/// The lattice of that voxel size. Throws Error (exit code 2) that names the two nearest powers of two if it
/// is none.
Lattice latticeOf(double voxel_size);

/// The lattice with the smallest voxels of which `along` are at least as long as the bounds' longest side.
Lattice latticeFor(const Bounds& bounds, uint64_t along);

/// Throws Error that names the smallest size that does if the scene's bounds hold more voxels than
/// kMostVoxelsAlong along an axis, or voxels farther out than kLargestVoxelPlace.
void requireFits(const Lattice& lattice, const Bounds& bounds);

}  // namespace sightline
