#pragma once
// Scenes and rays that break tracers, and the brute force to compare with; shared by all tracers' tests.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "bvh/bvh.h"
#include "core/scene/scene.h"
#include "core/shared/types.h"
#include "tests/support/random_triangles.h"

namespace sightline {

using testing_support::describeRay;

struct TraceCase {
  std::string name;
  Scene scene;
  std::vector<Ray> rays;
};

/// Soups with slivers, shared vertices, axis-aligned walls, huge offsets, coplanar copies; rays at
/// vertices, edges, along axes, from vertices, incoherent and coherent. Always the same.
const std::vector<TraceCase>& traceCases();

/// Trees as different as the builder makes them.
std::vector<BvhConfig> traceConfigs();

/// Nearest hits by testing every triangle.
std::vector<Hit> bruteForce(const Scene& scene, const std::vector<Ray>& rays);

/// Bits of t and id; t does not count for a miss.
testing::AssertionResult sameHit(const char*, const char*, const Hit& actual, const Hit& expected);

}  // namespace sightline
