#include "core/shared/random_ray.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "core/sampling/random_segment.h"

namespace sightline {
namespace {

Face unitFace() {
  Face face{};
  face.edge_u = face.axis_u = vec4(1, 0, 0, 0);
  face.edge_v = face.axis_v = vec4(0, 1, 0, 0);
  face.normal = vec4(0, 0, 1, 0);
  return face;
}

TEST(SinQuarter, IsWithinItsBound) {
  for (int i = 0; i <= 1 << 20; ++i) {
    const float x = static_cast<float>(i) / (1 << 20);
    ASSERT_NEAR(sinQuarter(x), std::sin(double(x) * 1.57079632679489662), 3e-7) << x;
  }
}

TEST(HemisphereDirection, IsUnitAndLeavesTheFace) {
  std::mt19937 random(2);
  for (int i = 0; i < 300'000; ++i) {
    const auto azimuth = static_cast<uint32_t>(i < 5 ? i * 0x400000u % 0x1000000u : random() >> 8);
    const auto height = static_cast<uint32_t>(i % 7 == 0 ? 0xffffffu : random() >> 8);
    const HemisphereDirection direction = hemisphereDirection(azimuth, height);
    const vec3 d(direction.x, direction.y, direction.z);
    ASSERT_GT(d.z, 0.0f) << azimuth << ' ' << height;
    ASSERT_NEAR(glm::length(glm::dvec3(d)), 1.0, 5e-7) << azimuth << ' ' << height;
    const double angle = double(azimuth) / (1 << 24) * 2 * 3.14159265358979324;
    const double r = std::sqrt(1.0 - double(d.z) * d.z);
    ASSERT_NEAR(d.x, r * std::cos(angle), 5e-7) << azimuth << ' ' << height;
    ASSERT_NEAR(d.y, r * std::sin(angle), 5e-7) << azimuth << ' ' << height;
  }
}

class Strata : public testing::TestWithParam<std::tuple<uint64_t, uint32_t>> {};

TEST_P(Strata, EnumerateEveryRayOnce) {
  const auto [first, count] = GetParam();
  const RandomSegment segment = makeRandomSegment(0, first, count, 1);
  std::vector<int> seen(count);
  uint64_t empty = 0;
  for (uint64_t slot = 0; slot < slotCount(segment); ++slot) {
    const uint32_t offset = slotOffset(segment, static_cast<uint32_t>(slot));
    if (offset == kNoTriangle) {
      ++empty;
    } else {
      ASSERT_LT(offset, count);
      ++seen[offset];
    }
  }
  for (uint32_t i = 0; i < count; ++i) ASSERT_EQ(seen[i], 1) << "offset " << i;
  EXPECT_LE(empty, count / 16 + 64);  // what makeRandomSegment allows itself
}

INSTANTIATE_TEST_SUITE_P(Runs, Strata,
                         testing::Values(std::tuple{0ull, 1u}, std::tuple{0ull, 63u},
                                         std::tuple{17ull, 1000u}, std::tuple{12345ull, 100'003u},
                                         std::tuple{0xfffffff0ull, 65'536u}, std::tuple{1ull << 40, 999'999u},
                                         std::tuple{10'000'000ull, 4'194'304u}));

TEST(Strata, PacketsAreCoherent) {
  const RandomSegment segment = makeRandomSegment(0, 0, 4'000'000, 1);
  const Face face = unitFace();
  double spread = 0;
  int packets = 0;
  for (uint32_t slot = 0; slot + 8 <= slotCount(segment); slot += 8 * 997, ++packets) {
    vec3 sum(0);
    float rays = 0;  // an empty slot has no direction
    for (uint32_t lane = 0; lane < 8; ++lane) {
      const vec3 direction(
          offsetRay(segment, face, uvec4(1, 2, 3, 4), slotOffset(segment, slot + lane)).direction);
      rays += direction == vec3(0) ? 0.0f : 1.0f;
      sum += direction;
    }
    if (rays > 0) spread += 1 - glm::length(sum) / rays;
  }
  EXPECT_LT(spread / packets, 0.005) << "directions of a packet should almost agree";
}

TEST(RandomRay, OriginsLieOnTheFaceAndFillIt) {
  const Face face = unitFace();
  std::vector<int> cells(64);
  for (uint32_t i = 0; i < 64'000; ++i) {
    const Ray ray = randomRay(0, i, face, uvec4(0x12345678u, 999u, 77u, 5u));
    ASSERT_GE(ray.origin.x, 0.0f);
    ASSERT_LE(ray.origin.x, 1.0f);
    ASSERT_EQ(ray.origin.z, 0.0f);
    ++cells[std::min(7, int(ray.origin.x * 8)) * 8 + std::min(7, int(ray.origin.y * 8))];
  }
  for (const int count : cells) EXPECT_NEAR(count, 1000, 40);
}

TEST(RandomSegment, RunsAfterEachOtherDoNotOverlap) {
  const RandomSegment a = makeRandomSegment(0, 0xffffffffull, 100, 1);
  EXPECT_EQ(segmentFirst(a), 0xffffffffull);
  EXPECT_EQ(a.range.w, 100u);
  EXPECT_EQ(a.batch.x, 1u);
}

}  // namespace
}  // namespace sightline
