// The software traversal against the triangle test alone, applied to every triangle.
#include <gtest/gtest.h>

#include "core/shared/vector.h"
#include "core/trace/cpu_tracer.h"
#include "tests/backend/trace_cases.h"

namespace sightline {
namespace {

TEST(CpuTracer, GivesTheHitsOfBruteForceWhateverTheTree) {
  for (const TraceCase& c : traceCases()) {
    const std::vector<Hit> expected = bruteForce(c.scene, c.rays);
    int hits = 0;
    for (const BvhConfig& config : traceConfigs()) {
      const Bvh bvh = buildBvh(c.scene.positions, c.scene.triangles, config);
      const CpuTracer tracer(c.scene, bvh);
      for (size_t i = 0; i < c.rays.size(); ++i) {
        ASSERT_PRED_FORMAT2(sameHit, tracer.trace(c.rays[i]), expected[i])
            << c.name << ", ray " << i << " " << describeRay(c.rays[i]) << ", leaf size "
            << config.max_leaf_size << ", spatial splits " << config.spatial_splits;
        hits += expected[i].triangle != kNoTriangle;
      }
    }
    EXPECT_GT(hits, 0) << c.name;
  }
}

TEST(CpuTracer, PacketsGiveTheHitsOfSingleRays) {
  for (const TraceCase& c : traceCases()) {
    const Bvh bvh = buildBvh(c.scene.positions, c.scene.triangles);
    const CpuTracer tracer(c.scene, bvh);
    std::vector<Hit> hits(c.rays.size());
    for (const int size : {1, 3, 8, 13, int(c.rays.size())}) {
      for (size_t i = 0; i < c.rays.size(); i += size) {
        tracer.tracePacket(&c.rays[i], &hits[i], int(std::min<size_t>(size, c.rays.size() - i)));
      }
      for (size_t i = 0; i < c.rays.size(); ++i) {
        ASSERT_PRED_FORMAT2(sameHit, hits[i], tracer.trace(c.rays[i]))
            << c.name << ", ray " << i << " " << describeRay(c.rays[i]);
      }
    }
  }
}

TEST(CpuTracer, AmongEqualDistancesTheLowestIdWins) {
  Scene scene;
  scene.positions = {{-1, -1, 5}, {2, -1, 5}, {-1, 2, 5}};
  scene.triangles.assign(1000, {0, 1, 2});
  const Bvh bvh = buildBvh(scene.positions, scene.triangles);
  std::vector<TriangleRecord> records(bvh.references.size());
  packTriangles(scene, bvh, 0, std::span<TriangleRecord>(records));
  for (TriangleRecord& record : records)
    record.id = (record.id * 7u + 500u) % 1000u + 3u;  // 7: prime to 1000
  const Hit hit = CpuTracer(records, bvh).trace({vec4(0, 0, 0, 0), vec4(0, 0, 2, 0)});
  EXPECT_EQ(hit.triangle, 3u);
  EXPECT_EQ(hit.t, 2.5f);
}

TEST(CpuTracer, IdsPast2To24StayWhole) {
  const TraceCase c = traceCases().front();
  const Bvh bvh = buildBvh(c.scene.positions, c.scene.triangles);
  std::vector<TriangleRecord> records(bvh.references.size());
  packTriangles(c.scene, bvh, 0, std::span<TriangleRecord>(records));
  const uint32_t offset = (1u << 24) + 1;
  for (TriangleRecord& record : records) record.id += offset;
  const CpuTracer plain(c.scene, bvh), moved(records, bvh);
  for (const Ray& ray : c.rays) {
    Hit expected = plain.trace(ray);
    if (expected.triangle != kNoTriangle) expected.triangle += offset;
    ASSERT_PRED_FORMAT2(sameHit, moved.trace(ray), expected);
  }
}

TEST(CpuTracer, ADirectionOfZeroHitsNothing) {
  const TraceCase c = traceCases().front();
  const Bvh bvh = buildBvh(c.scene.positions, c.scene.triangles);
  const CpuTracer tracer(c.scene, bvh);
  EXPECT_EQ(tracer.trace({vec4(0), vec4(0)}).triangle, kNoTriangle);
  EXPECT_EQ(tracer.trace({vec4(0), vec4(-0.0f)}).triangle, kNoTriangle);
}

/// 1 / direction overflows: the boxes' distances are NaN, also those of empty slots, which lead nowhere.
TEST(CpuTracer, DirectionsBeyondItsRangeEnd) {
  const TraceCase c = traceCases().front();
  const Bvh bvh = buildBvh(c.scene.positions, c.scene.triangles);
  const CpuTracer tracer(c.scene, bvh);
  for (const float length : {1e-45f, 1e-38f, 1e-30f, 1e-26f, 1e26f, 1e38f}) {
    for (const Ray& ray : c.rays) {
      const Hit hit = tracer.trace({ray.origin, vec4(xyz3(ray.direction) * length, 0)});
      EXPECT_TRUE(hit.triangle == kNoTriangle || hit.triangle < c.scene.triangles.size());
    }
  }
}

}  // namespace
}  // namespace sightline
