// Scenes cut into drawables: every triangle once, no part too large or of two objects or kinds.
#include <gtest/gtest.h>

#include "tests/draw/draw_cases.h"

namespace sightline {
namespace {

void checkPartition(const Scene& scene, const Drawables& drawables, uint32_t split) {
  std::vector<uint32_t> times(scene.triangleCount());
  uint32_t next = 0, object = 0;
  for (const Drawable& d : drawables.list) {
    EXPECT_EQ(d.first_triangle, next);
    next += d.triangle_count;
    EXPECT_GE(d.object, object);
    object = d.object;
    ASSERT_GE(d.triangle_count, 1u);
    if (split > 0) {
      EXPECT_LE(d.triangle_count, split);
    }
    AxisBox box{glm::vec3(INFINITY), glm::vec3(-INFINITY)};
    for (uint32_t i = 0; i < d.triangle_count; ++i) {
      const uint32_t id = drawables.triangles[d.first_triangle + i];
      ++times[id];
      EXPECT_GE(id, scene.objects[d.object].first_triangle);
      EXPECT_LT(id, scene.objects[d.object].first_triangle + scene.objects[d.object].triangle_count);
      const uint32_t word = scene.surfaces.of(id);
      EXPECT_EQ(d.alpha == AlphaKind::blended, (word & kSurfaceGlass) != 0);
      EXPECT_EQ(d.alpha == AlphaKind::masked, (word & (kSurfaceGlass | kSurfaceMasked)) == kSurfaceMasked);
      for (const glm::vec3& c : scene.corners(id)) box = {glm::min(box.low, c), glm::max(box.high, c)};
    }
    EXPECT_EQ(d.box, box);
  }
  EXPECT_EQ(next, scene.triangleCount());
  for (const uint32_t t : times) ASSERT_EQ(t, 1u);
}

TEST(Partition, HoldsEveryTriangleOnce) {
  for (const char* name : {"city", "canyon", "plant", "bistro"}) {
    const Scene scene = generateScene(name, 20000, 1);
    for (const uint32_t split : {0u, 1u, 100u, 2048u}) {
      SCOPED_TRACE(std::string(name) + " " + std::to_string(split));
      const Drawables parts = partitionScene(scene, {.split = split});
      checkPartition(scene, parts, split);
      if (split == 1) {
        EXPECT_EQ(parts.list.size(), scene.triangleCount());
      }
      if (split == 0 && scene.surfaces.empty()) {
        EXPECT_EQ(parts.list.size(), scene.objects.size());
      }
    }
  }
}

TEST(Partition, CutsByKindFirst) {
  Scene scene = generateScene("city", 5000, 1);
  scene.surfaces.words.assign(scene.triangles.size(), 0);
  for (uint32_t id = 0; id < scene.triangles.size(); ++id) {
    if (id % 5 == 1) scene.surfaces.words[id] = kSurfaceGlass;
    if (id % 5 == 3) scene.surfaces.words[id] = kSurfaceMasked;
  }
  for (const uint32_t split : {0u, 10u})
    checkPartition(scene, partitionScene(scene, {.split = split}), split);
}

TEST(Partition, InstancesAreWhereTheyAre) {
  const Scene scene = generateRepeated("city", 4'000'000, 1, 4);
  ASSERT_TRUE(scene.hasInstances());
  const Drawables parts = partitionScene(scene, {.split = 0});
  EXPECT_EQ(parts.triangles.size(), scene.triangleCount());
  for (size_t d = 0; d < parts.list.size(); d += 97) {
    for (const uint32_t id : parts.trianglesOf(uint32_t(d))) {
      for (const glm::vec3& c : scene.corners(id)) {
        EXPECT_TRUE(glm::all(glm::lessThanEqual(parts.list[d].box.low, c)) &&
                    glm::all(glm::greaterThanEqual(parts.list[d].box.high, c)));
      }
    }
  }
}

TEST(Partition, DependsOnNoThreads) {
  const Scene scene = generateScene("canyon", 60000, 1);
  const Drawables one = partitionScene(scene, {.threads = 1}), two = partitionScene(scene, {.threads = 2});
  EXPECT_EQ(one.triangles, two.triangles);
  ASSERT_EQ(one.list.size(), two.list.size());
  for (size_t i = 0; i < one.list.size(); ++i)
    EXPECT_EQ(one.list[i].first_triangle, two.list[i].first_triangle);
}

}  // namespace
}  // namespace sightline
