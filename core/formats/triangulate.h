#pragma once
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace sightline {

/// Most corners of a concave polygon: ear clipping takes quadratic time.
inline constexpr size_t kMaxConcaveCorners = 10'000;

/// Cuts a polygon of n >= 3 corners into n - 2 triangles of its corners' numbers 0 .. n - 1, appended to
/// `triangles` in the polygon's orientation. Convex ones become a fan from corner 0; concave ones are cut by
/// ears; crossing, flat or folded ones still give n - 2 triangles. Positions must be finite.
/// Returns false, and appends nothing, for a concave polygon of more than kMaxConcaveCorners corners, or one
/// of thousands of corners so entangled that cutting takes longer than about a second.
bool triangulate(std::span<const glm::vec3> corners, std::vector<glm::uvec3>& triangles);

}  // namespace sightline
