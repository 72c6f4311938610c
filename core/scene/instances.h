#pragma once
#include <cstdint>

#include "core/scene/scene.h"

namespace sightline {

/// Whether a mesh may be an instance at a placement, so that placeVertex (core/shared/placement.h) places it
/// as well as floats can and rays find it: all is finite and neither the placement nor its inverse stretches
/// more than 2^20 times; the condition (largest row sums of both, multiplied) is at most 1024, so nothing is
/// singular or squeezed flat; and where the mesh lies far off in its own space, the place does not take it
/// back to near the origin, which would cost digits (the largest |T| + |A| |v| is at most four times the
/// largest coordinate that comes out). What may not be one is stored as plain triangles, placed in double.
/// bounds: of the mesh's positions.
bool canPlace(const Placement& place, const Bounds& bounds);

/// Whether a scene is stored with instances: from four times as many triangles as are stored on, where at
/// least 2^20 need not be stored (about 150 MiB with their tree). Rays can take up to half as long again
/// through two levels, so smaller scenes stay plain; and the vertices of plain scenes are placed in double,
/// which is finer than placeVertex by up to 4 units in the last place.
bool instancesPay(uint64_t stored_triangles, uint64_t all_triangles);

/// Fills in what follows from meshes, first_id and place of all instances. The scene holds all positions and
/// triangles.
void countInstances(Scene& scene);

/// The surface word that a triangle has in the plain scene, where each masked one has a record of its own, in
/// the order of ids. masked: those before it; counts this one.
inline uint32_t flatWord(uint32_t word, uint32_t& masked) {
  return (word & kSurfaceMasked) == 0 ? word : (word & ~kSurfaceIndex) | (masked++ & kSurfaceIndex);
}

/// The surfaces of the plain scene that a scene with instances stands for. Throws Error where there are more
/// masked triangles than records can be numbered, and std::bad_alloc.
Surfaces flatSurfaces(const Scene& scene);

/// The plain scene that a scene with instances stands for: its plain positions, then those of each instance
/// in turn. A plain scene is returned as it is. Throws as flatSurfaces.
Scene flatten(Scene scene);

}  // namespace sightline
