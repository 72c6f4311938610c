// Walks of generated scenes go through free space, and have the parts that they promise.
#include <gtest/gtest.h>

#include <cmath>

#include "core/base/error.h"
#include "core/generate/generate.h"
#include "core/generate/walk_plan.h"
#include "core/path/camera_path.h"
#include "core/scene/instances.h"
#include "core/scene/scene_tree.h"
#include "core/trace/cpu_tracer.h"

namespace sightline {
namespace {

struct WalkCase {
  std::string scene;
  uint64_t triangles, seed;
  uint32_t kinds = 0;
};

Ray rayFrom(const glm::dvec3& from, const glm::dvec3& direction) {
  return {glm::vec4(glm::vec3(from), 0), glm::vec4(glm::vec3(direction), 0)};
}

/// The object of a triangle.
std::string objectOf(const Scene& scene, uint32_t triangle) {
  for (const SceneObject& object : scene.objects) {
    if (triangle < object.first_triangle + object.triangle_count) return object.name;
  }
  return "?";
}

double headingChange(const PathPlace& a, const PathPlace& b) {
  const glm::dvec3 from = glm::normalize(a.look - a.eye), to = glm::normalize(b.look - b.eye);
  return std::acos(std::min(1.0, glm::dot(from, to))) * 180 / 3.14159265358979;
}

class GeneratedWalk : public testing::TestWithParam<WalkCase> {};

TEST_P(GeneratedWalk, GoesThroughFreeSpace) {
  const auto& [name, n, seed, kinds] = GetParam();
  const Scene scene =
      kinds > 0 ? flatten(generateRepeated(name, n, seed, kinds)) : generateScene(name, n, seed);
  const Bvh bvh = buildSceneTree(scene);
  const CpuTracer tracer(scene, bvh);
  const CameraPath path = generateWalk(name, n, seed, 1500, kinds);
  ASSERT_FALSE(pathProblem(path)) << pathProblem(path)->place << pathProblem(path)->what;
  ASSERT_EQ(path.frames(), 1500u);
  for (uint32_t frame = 0; frame < path.frames(); ++frame) {
    const glm::dvec3 eye = placeAt(path, frame).eye;
    // A shoulder's width around.
    for (const glm::dvec3& side : {glm::dvec3(1, 0, 0), glm::dvec3(-1, 0, 0), glm::dvec3(0, 0, 1),
                                   glm::dvec3(0, 0, -1), glm::dvec3(0, -1, 0), glm::dvec3(0, 1, 0)}) {
      const Hit hit = tracer.trace(rayFrom(eye, side));
      ASSERT_FALSE(hit.triangle != kNoTriangle && hit.t < 0.25f)
          << "frame " << frame << " is " << hit.t << " m from " << objectOf(scene, hit.triangle);
    }
    if (frame + 1 == path.frames() || startsStretch(path, frame + 1)) continue;
    const glm::dvec3 step = placeAt(path, frame + 1).eye - eye;
    if (step == glm::dvec3(0)) continue;
    const Hit hit = tracer.trace(rayFrom(eye, step));
    ASSERT_FALSE(hit.triangle != kNoTriangle && hit.t <= 1)
        << "frame " << frame << " goes through " << objectOf(scene, hit.triangle);
  }
}

TEST_P(GeneratedWalk, HasAFastTurnCutsAndARiseOverAll) {
  const auto& [name, n, seed, kinds] = GetParam();
  const Scene scene =
      kinds > 0 ? flatten(generateRepeated(name, n, seed, kinds)) : generateScene(name, n, seed);
  const CameraPath path = generateWalk(name, n, seed, 1500, kinds);
  EXPECT_EQ(path.cuts, (std::vector<uint32_t>{uint32_t(std::floor(kSideFrom * 1499 + 0.5)),
                                              uint32_t(std::floor(kRiseFrom * 1499 + 0.5))}));
  double turned = 0, fastest = 0;
  for (auto frame = uint32_t(kTurnFrom * 1499) + 1; frame < uint32_t(kTurnTo * 1499); ++frame) {
    const double change = headingChange(placeAt(path, frame), placeAt(path, frame + 1));
    turned += change;
    fastest = std::max(fastest, change);
  }
  EXPECT_GT(turned, 200);
  EXPECT_GT(fastest, 6) << "degrees a frame";
  // The last frame sees all of it: in a square image of the path's field of view.
  const PathPlace last = placeAt(path, path.frames() - 1);
  const glm::dvec3 forward = glm::normalize(last.look - last.eye);
  const glm::dvec3 right = glm::normalize(glm::cross(forward, glm::dvec3(0, 1, 0)));
  const glm::dvec3 up = glm::cross(right, forward);
  const double tangent = std::tan(path.fov / 2 * 3.14159265358979 / 180);
  size_t outside = 0;
  for (const glm::vec3& p : scene.positions) {
    const glm::dvec3 v = glm::dvec3(p) - last.eye;
    const double reach = glm::dot(v, forward) * tangent;
    outside += std::fabs(glm::dot(v, right)) > reach || std::fabs(glm::dot(v, up)) > reach ? 1 : 0;
  }
  EXPECT_EQ(outside, 0u) << "of " << scene.positions.size();
}

std::vector<WalkCase> walkCases() {
  std::vector<WalkCase> all;
  for (const GeneratedSceneInfo& info : generatedScenes()) {
    for (const uint64_t n : {1'000ull, 20'000ull, 300'000ull}) {
      for (const uint64_t seed : {1ull, 5ull}) all.push_back({info.name, n, seed});
    }
    if (canRepeat(info.name)) all.push_back({info.name, 100'000, 2, 4});
  }
  return all;
}

INSTANTIATE_TEST_SUITE_P(Scenes, GeneratedWalk, testing::ValuesIn(walkCases()), [](const auto& c) {
  return c.param.scene + "_" + std::to_string(c.param.triangles) + "_" + std::to_string(c.param.seed) + "_" +
         std::to_string(c.param.kinds);
});

TEST(GenerateWalk, TakesSixtyFramesOrMore) {
  for (const GeneratedSceneInfo& info : generatedScenes()) {
    for (uint32_t frames = kMinWalkFrames; frames < kMinWalkFrames + 60; ++frames) {
      const CameraPath path = generateWalk(info.name, 20'000, 1, frames);
      ASSERT_FALSE(pathProblem(path)) << info.name << " " << frames << ": " << pathProblem(path)->place;
      ASSERT_EQ(path.frames(), frames) << info.name;
    }
  }
  EXPECT_THROW(generateWalk("city", 20'000, 1, kMinWalkFrames - 1), Error);
  EXPECT_THROW(generateWalk("city", 20'000, 1, 1'000'001), Error);
  EXPECT_THROW(generateWalk("village", 20'000, 1, 100), Error);
  EXPECT_THROW(generateWalk("canyon", 20'000, 1, 100, 4), Error);
}

}  // namespace
}  // namespace sightline
