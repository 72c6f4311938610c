// The exact judge on scenes with instances: it finds through both levels what it finds in the plain scene.
#include <gtest/gtest.h>

#include "core/judge/judge.h"
#include "core/scene/scene_tree.h"
#include "tests/support/instanced_scene.h"

namespace sightline {
namespace {

TEST(JudgeOfInstances, RulesAsOnThePlainScene) {
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    const Scene scene = testing_support::randomInstances(seed, 40, 60), flat = flatten(scene);
    const Bvh tree = buildSceneTree(scene, {.spatial_splits = seed % 2 == 0}),
              flat_tree = buildSceneTree(flat);
    const Judge judge(scene, tree), flat_judge(flat, flat_tree);
    testing_support::TestRandom random(seed + 50);
    size_t hits = 0;
    for (int i = 0; i < 1000; ++i) {
      const glm::vec3 from = random.inCube(30);
      const auto t = flat.corners(random.below(flat.triangleCount()));
      // A third of the rays go exactly through a corner.
      const glm::vec3 target = i % 3 == 0 ? t[0] : t[0] * 0.3f + t[1] * 0.3f + t[2] * 0.4f;
      const JudgeRay ray{glm::dvec3(from), glm::dvec3(target - from)};
      const ExactHit got = judge.nearest(ray), wanted = flat_judge.nearest(ray);
      ASSERT_EQ(got.triangles, wanted.triangles) << seed << " ray " << i;
      hits += wanted.triangles.empty() ? 0 : 1;
    }
    EXPECT_GT(hits, 500u);
  }
}

}  // namespace
}  // namespace sightline
