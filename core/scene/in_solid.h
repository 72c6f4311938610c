#pragma once
#include <array>
#include <span>

#include "core/scene/scene.h"
#include "core/shared/types.h"

namespace sightline {

/// Which faces free space is on. Front faces are counter-clockwise seen from there; exported levels often
/// have it the other way round.
enum class FreeSide { kFront, kBack, kAny };

inline constexpr int kSolidProbes = 64;

/// Directions over the whole sphere, spread evenly, none along an axis: the same on every machine.
std::array<glm::vec3, kSolidProbes> solidProbes();

/// Whether a point is inside of something solid: of the rays from it along `directions` that hit anything
/// (hits, one a direction), more than half hit a triangle from the side that is not free. kAny: never.
bool inSolid(const Scene& scene, FreeSide free_side, std::span<const glm::vec3> directions,
             std::span<const Hit> hits);

}  // namespace sightline
