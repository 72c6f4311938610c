// A ray of a public conformance test for watertight tracing, which asks for a hit on the edge of two
// triangles (docs/numerics.md): what is true of it, and what our devices say.
#include <gtest/gtest.h>

#include <bit>

#include "core/device/embree/embree_device.h"
#include "core/device/registry/make_device.h"
#include "core/judge/ruling.h"

namespace sightline {
namespace {

float bits(uint32_t value) {
  return std::bit_cast<float>(value);
}

const vec3 kEdge[] = {{1, 0, -1}, {0, 1, -1}};
const vec3 kThird[] = {{bits(0x3ec83ac8), bits(0x3f1be29d), bits(0xbed79c23)},
                       {bits(0x3e8f7a0c), bits(0x3f353a70), bits(0xbf4fab47)}};
const Ray kRay{vec4(bits(0x3f708000), bits(0x3d780000), 0, 0), vec4(0, 0, -1, 0)};

/// Both triangles, each with the edge in one direction or the other.
Scene pair(bool turn_first, bool turn_second, const vec3& third = kThird[0]) {
  Scene scene;
  scene.positions = {kEdge[0], kEdge[1], third, kThird[1]};
  scene.triangles = {turn_first ? glm::uvec3(1, 0, 2) : glm::uvec3(0, 1, 2),
                     turn_second ? glm::uvec3(1, 0, 3) : glm::uvec3(0, 1, 3)};
  scene.objects = {{"pair", 0, 2}};
  return scene;
}

/// Of x + y = 1, on which the edge lies as the ray sees it; exact in double.
double side(const vec3& p) {
  return double(p.x) + double(p.y) - 1;
}

TEST(ConformanceRay, TheEdgeIsMetAndOneRoundingMakesASilhouetteOfIt) {
  EXPECT_EQ(side(vec3(kRay.origin)), 0) << "the ray passes through the edge";
  EXPECT_EQ(side(kThird[0]), 0x1p-24) << "the first triangle is a float step wide";
  EXPECT_LT(side(kThird[1]), -0.01) << "the second is on the other side";
  for (const int turned : {0, 1, 2, 3}) {
    const Scene scene = pair((turned & 1) != 0, (turned & 2) != 0);
    const Bvh bvh = buildBvh(scene.positions, scene.triangles);
    const Judge judge(scene, bvh);
    const ExactHit exact = judge.nearest(judgeRay(kRay));
    EXPECT_EQ(exact.triangles, (std::vector<uint32_t>{0, 1})) << turned;
    EXPECT_TRUE(exact.t.low <= 1 && exact.t.high >= 1) << turned;
    EXPECT_EQ(rule(judge, kRay, {1, 0}, exact).verdict, Verdict::kRight) << turned;
    EXPECT_EQ(rule(judge, kRay, {1, 1}, exact).verdict, Verdict::kRight) << turned;
    EXPECT_EQ(rule(judge, kRay, {0, kNoTriangle}, exact).verdict, Verdict::kRounded) << turned;
    EXPECT_EQ(rule(judge, kRay, {0, kNoTriangle}, exact, {0.01}).verdict, Verdict::kMissed)
        << turned << ": a hundredth of a float step does not get past it";
  }
  // A thousand float steps wide, 70 where the ray passes, and it must hit.
  const vec3 wide = kThird[0] + vec3(0, 1000 * 0x1p-24f, 0);
  const Scene scene = pair(false, true, wide);
  const Bvh bvh = buildBvh(scene.positions, scene.triangles);
  const Judge judge(scene, bvh);
  EXPECT_EQ(rule(judge, kRay, {0, kNoTriangle}, judge.nearest(judgeRay(kRay))).verdict, Verdict::kMissed);
}

TEST(ConformanceRay, OurDevicesHitTheLowestId) {
  for (const int turned : {0, 1, 2, 3}) {
    const Scene scene = pair((turned & 1) != 0, (turned & 2) != 0);
    const Bvh bvh = buildBvh(scene.positions, scene.triangles);
    for (const DeviceInfo& info : listDevices()) {
      if (!info.unusable.empty() || info.id.starts_with("vulkan")) continue;
      Hit hit{};
      makeTracer(info.id, scene, bvh)->traceRays({&kRay, 1}, {&hit, 1});
      if (info.id == "embree") {
        const Judge judge(scene, bvh);
        const Verdict verdict = rule(judge, kRay, hit, judge.nearest(judgeRay(kRay))).verdict;
        EXPECT_TRUE(verdict == Verdict::kRight || verdict == Verdict::kRounded) << turned;
        continue;
      }
      EXPECT_EQ(hit.triangle, 0u) << info.id << " " << turned;
      EXPECT_EQ(hit.t, 1.0f) << info.id << " " << turned;
    }
  }
}

}  // namespace
}  // namespace sightline
