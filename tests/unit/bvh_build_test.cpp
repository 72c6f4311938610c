#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <stdexcept>
#include <utility>

#include "bvh/bvh.h"
#include "tests/unit/bvh_soup.h"

namespace sightline {
namespace {

/// Builds with and without spatial splits and for several leaf sizes, and expects valid trees.
void expectValid(const Soup& soup, const std::string& what, uint32_t most_depth = kMaxDepth) {
  for (const bool spatial : {false, true}) {
    for (const uint32_t leaf : {1u, 4u, 8u}) {
      BvhConfig config;
      config.spatial_splits = spatial;
      config.max_leaf_size = leaf;
      const Bvh bvh = buildBvh(soup.positions, soup.triangles, config);
      SCOPED_TRACE(what + (spatial ? ", spatial splits" : "") + ", leaves of " + std::to_string(leaf));
      EXPECT_EQ(validate(bvh, soup.positions, soup.triangles), "");
      EXPECT_LE(bvh.depth, most_depth);
      EXPECT_TRUE(std::isfinite(bvh.sah_cost));
      for (const BvhNode2& node : bvh.nodes2) {
        EXPECT_LE(node.count[0], leaf);
        EXPECT_LE(node.count[1], leaf);
      }
      if (!spatial) {
        EXPECT_EQ(bvh.references.size(), soup.triangles.size());
      }
      EXPECT_LE(static_cast<double>(bvh.references.size()), 1.3 * static_cast<double>(soup.triangles.size()));
    }
  }
}

template <typename T>
bool sameBytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

void expectSame(const Bvh& a, const Bvh& b, const std::string& what) {
  EXPECT_TRUE(sameBytes(a.nodes2, b.nodes2)) << what;
  EXPECT_TRUE(sameBytes(a.nodes8, b.nodes8)) << what;
  EXPECT_TRUE(sameBytes(a.references, b.references)) << what;
  EXPECT_EQ(a.sah_cost, b.sah_cost) << what;
  EXPECT_EQ(a.depth, b.depth) << what;
  EXPECT_EQ(a.low, b.low) << what;
  EXPECT_EQ(a.high, b.high) << what;
}

TEST(BvhBuild, SoupsOfAllSizesAreValid) {
  for (const uint32_t n : {1u, 2u, 3u, 4u, 5u, 8u, 9u, 33u, 100u, 1000u, 4096u, 4097u, 40000u}) {
    expectValid(randomSoup(n, n, 0.05f), "soup of " + std::to_string(n));
  }
}

TEST(BvhBuild, ManySmallSoupsAreValid) {
  for (uint32_t seed = 0; seed < 200; ++seed) {
    const uint32_t n = 1 + seed % 40;
    expectValid(randomSoup(n, seed, seed % 3 ? 0.3f : 3.0f), "seed " + std::to_string(seed));
  }
}

TEST(BvhBuild, GridsAndSliversAreValid) {
  expectValid(gridSoup(1), "grid of 1");
  expectValid(gridSoup(100), "grid of 100");
  expectValid(sliverSoup(3000, 1), "slivers");
}

TEST(BvhBuild, OneTriangleIsOneLeafInOneNode) {
  Soup soup;
  soup.add({1, 2, 3}, {4, 5, 6}, {7, 8, -9});
  const Bvh bvh = buildBvh(soup.positions, soup.triangles);
  ASSERT_EQ(validate(bvh, soup.positions, soup.triangles), "");
  ASSERT_EQ(bvh.nodes2.size(), 1u);
  ASSERT_EQ(bvh.nodes8.size(), 1u);
  EXPECT_EQ(bvh.nodes2[0].count[0], 1u);
  EXPECT_EQ(bvh.nodes2[0].child[1], 0xffffffffu);
  EXPECT_GT(bvh.nodes2[0].x[2], bvh.nodes2[0].x[3]);
  EXPECT_EQ(bvh.nodes8[0].count[0], 1u);
  for (int i = 1; i < 8; ++i) EXPECT_EQ(bvh.nodes8[0].child[i], 0xffffffffu);
  EXPECT_EQ(bvh.low, glm::vec3(1, 2, -9));
  EXPECT_EQ(bvh.high, glm::vec3(7, 8, 6));
  EXPECT_EQ(bvh.depth, 1u);
  EXPECT_EQ(bvh.sah_cost, 2.0);
}

TEST(BvhBuild, NoTrianglesAreRefused) {
  const Soup soup;
  EXPECT_THROW(buildBvh(soup.positions, soup.triangles), std::invalid_argument);
}

TEST(BvhBuild, LeafSizesOutOfRangeCountAsTheNearest) {
  const Soup soup = randomSoup(300, 4, 0.1f);
  for (const auto& [asked, taken] : {std::pair{0u, 1u}, std::pair{100u, 8u}}) {
    BvhConfig config;
    config.max_leaf_size = asked;
    const Bvh a = buildBvh(soup.positions, soup.triangles, config);
    config.max_leaf_size = taken;
    expectSame(a, buildBvh(soup.positions, soup.triangles, config), std::to_string(asked));
  }
}

TEST(BvhBuild, MillionIdenticalTrianglesGiveAShallowTree) {
  Soup soup;
  soup.add({0, 0, 0}, {1, 0, 0}, {0, 1, 1});
  soup.triangles.resize(1'000'000, soup.triangles[0]);
  for (const bool spatial : {false, true}) {
    BvhConfig config;
    config.spatial_splits = spatial;
    const Bvh bvh = buildBvh(soup.positions, soup.triangles, config);
    EXPECT_EQ(validate(bvh, soup.positions, soup.triangles), "");
    EXPECT_LT(bvh.depth, 32u);
  }
}

TEST(BvhBuild, EqualCentroids) {
  Soup soup;
  for (int i = 1; i <= 1000; ++i) {
    const float s = static_cast<float>(i);
    soup.add({-s, -s, s}, {s, -s, -s}, {s, s, s});
  }
  expectValid(soup, "concentric", 40);
}

TEST(BvhBuild, DegenerateTriangles) {
  Soup points, one_point, line;
  RandomPoints random(3);
  for (int i = 0; i < 5000; ++i) {
    const glm::vec3 p = random.point();
    points.add(p, p, p);
    one_point.add({1, 2, 3}, {1, 2, 3}, {1, 2, 3});
    line.add({p.x, 0, 0}, {p.y, 0, 0}, {p.z, 0, 0});
  }
  expectValid(points, "points");
  expectValid(one_point, "one point", 20);
  expectValid(line, "line");
}

TEST(BvhBuild, ExtremeCoordinates) {
  for (const float scale : {1e30f, 1e38f, 3e38f, 1e-30f, 1e-38f, 1e-44f}) {
    Soup soup = randomSoup(3000, 5, 0.05f);
    for (glm::vec3& p : soup.positions) p = glm::clamp(p, -1.0f, 1.0f) * scale;
    expectValid(soup, "scale " + std::to_string(scale));
    Soup slivers = sliverSoup(500, 5);
    for (glm::vec3& p : slivers.positions) p = glm::clamp(p, -1.0f, 1.0f) * scale;
    expectValid(slivers, "slivers, scale " + std::to_string(scale));
  }
}

TEST(BvhBuild, HugeOffset) {
  Soup soup = randomSoup(20000, 6, 0.05f);
  for (glm::vec3& p : soup.positions) p = p * 10.0f + glm::vec3(1e7f, -3e6f, 1e5f);
  expectValid(soup, "offset");
  // One triangle far away: all others fall into one bin until it is split off.
  soup = randomSoup(20000, 7, 0.05f);
  soup.add({1e30f, 1e30f, 1e30f}, {1e30f, 2e30f, 1e30f}, {1e30f, 1e30f, 2e30f});
  expectValid(soup, "outlier");
}

/// Sizes fall by a half each: binning peels off a few a level, so that depth needs its limit.
TEST(BvhBuild, ExponentialSpacingStaysWithinTheDepthLimit) {
  Soup soup;
  for (int i = -126; i < 120; ++i) {
    for (int k = 1; k <= 20; ++k) {
      const float s = std::ldexp(1.0f + 0.04f * static_cast<float>(k), i);
      soup.add({s, 0, 0}, {s * 1.001f, s * 0.01f, 0}, {s, 0, s * 0.01f});
      soup.add({0, 0, -s}, {0, s * 0.01f, -s}, {s * 0.01f, 0, -s * 1.001f});
    }
  }
  expectValid(soup, "exponential");
}

TEST(BvhBuild, NegativeZeroIsZero) {
  Soup a = gridSoup(40), b = a;
  for (glm::vec3& p : b.positions) {
    for (int i = 0; i < 3; ++i) p[i] = p[i] == 0 ? -0.0f : p[i];
  }
  expectSame(buildBvh(a.positions, a.triangles), buildBvh(b.positions, b.triangles), "-0");
}

TEST(BvhBuild, SameBytesForAnyNumberOfThreads) {
  tbb::global_control more(tbb::global_control::max_allowed_parallelism, 7);
  Soup soup = randomSoup(50000, 8, 0.05f);
  const Soup slivers = sliverSoup(1000, 9);
  for (size_t i = 0; i < slivers.positions.size(); i += 3) {
    soup.add(slivers.positions[i], slivers.positions[i + 1], slivers.positions[i + 2]);
  }
  for (const bool spatial : {false, true}) {
    BvhConfig config;
    config.spatial_splits = spatial;
    config.threads = 1;
    const Bvh one = buildBvh(soup.positions, soup.triangles, config);
    EXPECT_EQ(validate(one, soup.positions, soup.triangles), "");
    for (const int threads : {2, 7}) {
      config.threads = threads;
      expectSame(one, buildBvh(soup.positions, soup.triangles, config),
                 std::to_string(threads) + (spatial ? " threads, spatial" : " threads"));
    }
  }
}

TEST(BvhBuild, ScalingByAPowerOfTwoGivesTheSameTree) {
  Soup soup = randomSoup(5000, 10, 0.2f);
  for (const bool spatial : {false, true}) {
    BvhConfig config;
    config.spatial_splits = spatial;
    const Bvh one = buildBvh(soup.positions, soup.triangles, config);
    for (const float scale : {1024.0f, 0x1p-60f, 0x1p100f}) {
      Soup scaled = soup;
      for (glm::vec3& p : scaled.positions) p *= scale;
      Bvh other = buildBvh(scaled.positions, scaled.triangles, config);
      ASSERT_EQ(one.nodes2.size(), other.nodes2.size()) << scale;
      for (size_t i = 0; i < one.nodes2.size(); ++i) {
        BvhNode2 node = one.nodes2[i];
        node.x *= scale;
        node.y *= scale;
        node.z *= scale;
        ASSERT_EQ(std::memcmp(&node, &other.nodes2[i], sizeof node), 0) << "node " << i << ", " << scale;
      }
      EXPECT_TRUE(sameBytes(one.references, other.references)) << scale;
      EXPECT_EQ(one.sah_cost, other.sah_cost) << scale;
    }
  }
}

/// Nodes lie depth first: the first inner child directly follows its parent, the second its subtree.
TEST(BvhBuild, NodesLieDepthFirst) {
  const Soup soup = randomSoup(30000, 11, 0.05f);
  const Bvh bvh = buildBvh(soup.positions, soup.triangles);
  uint32_t next2 = 0, next8 = 0, reference = 0;
  const std::function<void(uint32_t)> walk2 = [&](uint32_t i) {
    ASSERT_EQ(i, next2++);
    for (int c = 0; c < 2; ++c) {
      if (bvh.nodes2[i].count[c]) {
        ASSERT_EQ(bvh.nodes2[i].child[c], reference);
        reference += bvh.nodes2[i].count[c];
      } else {
        walk2(bvh.nodes2[i].child[c]);
      }
    }
  };
  const std::function<void(uint32_t)> walk8 = [&](uint32_t i) {
    ASSERT_EQ(i, next8++);
    for (int c = 0; c < 8; ++c) {
      if (bvh.nodes8[i].count[c] == 0 && bvh.nodes8[i].child[c] != 0xffffffffu) walk8(bvh.nodes8[i].child[c]);
    }
  };
  walk2(0);
  walk8(0);
}

}  // namespace
}  // namespace sightline
