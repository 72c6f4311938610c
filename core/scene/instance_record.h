#pragma once
#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

#include "core/scene/scene.h"

namespace sightline {

/// The placement's three columns.
inline glm::dmat3 linearPart(const Placement& place) {
  return {glm::dvec3(place.x), glm::dvec3(place.y), glm::dvec3(place.z)};
}

/// Largest |coordinate| in the bounds, by axis.
inline glm::dvec3 reachOf(const Bounds& bounds) {
  return glm::max(glm::abs(glm::dvec3(bounds.low)), glm::abs(glm::dvec3(bounds.high)));
}

/// R of core/shared/placement.h: the largest |T| + |A| |v| of an axis.
inline double largestSum(const Placement& place, const Bounds& bounds) {
  const glm::dvec3 reach = reachOf(bounds);
  const glm::dvec3 sums = glm::abs(glm::dvec3(place.origin)) + glm::abs(glm::dvec3(place.x)) * reach.x +
                          glm::abs(glm::dvec3(place.y)) * reach.y + glm::abs(glm::dvec3(place.z)) * reach.z;
  return std::max({sums.x, sums.y, sums.z});
}

/// The record of an instance of a mesh with these bounds, without ids and roots. The placement must pass
/// canPlace.
InstanceRecord recordOf(const Placement& place, const Bounds& bounds);

}  // namespace sightline
