#pragma once
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace sightline {

/// Most corners of a concave polygon: ear clipping takes quadratic time.
inline constexpr size_t kMaxConcaveCorners = 10'000;

/// What cutting all concave polygons of a file may take, in tests of a corner against a triangle: under a
/// second ...
inline constexpr uint64_t kMaxCutTests = 200'000'000;
/// ... and so many more for each of their corners.
inline constexpr uint64_t kCutTestsACorner = 100;

/// Cuts a polygon of n >= 3 corners into n - 2 triangles of its corners' numbers 0 .. n - 1, appended to
/// `triangles` in the polygon's orientation. Convex ones become a fan from corner 0; concave ones are cut by
/// ears; crossing, flat or folded ones still give n - 2 triangles. Positions must be finite.
/// Counts the tests off `tests_left`. Returns false, and appends nothing, for a concave polygon of more than
/// kMaxConcaveCorners corners, or if no tests are left: one so entangled that cutting it takes too long.
bool triangulate(std::span<const glm::vec3> corners, std::vector<glm::uvec3>& triangles,
                 uint64_t& tests_left);

}  // namespace sightline
