// Each way in which a tree can be wrong must be reported.
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "bvh/bvh.h"
#include "tests/unit/bvh_soup.h"

namespace sightline {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

class BvhValidate : public ::testing::Test {
 protected:
  Soup soup_ = randomSoup(500, 1, 0.1f);
  Bvh good_ = buildBvh(soup_.positions, soup_.triangles);

  void expectComplaint(const std::string& part, const std::function<void(Bvh&)>& damage) {
    Bvh bvh = good_;
    damage(bvh);
    const std::string complaint = validate(bvh, soup_.positions, soup_.triangles);
    EXPECT_NE(complaint.find(part), std::string::npos) << "expected: " << part << "\ngot: " << complaint;
  }

  template <typename Node>
  static uint32_t slots() {
    return sizeof(Node::child) / sizeof(uint32_t);
  }
  /// Node and child of the n-th leaf, or inner child, or empty slot in memory order.
  template <typename Node, typename Test>
  static std::pair<uint32_t, int> find(const std::vector<Node>& nodes, Test test, int n = 0) {
    for (uint32_t i = 0; i < nodes.size(); ++i) {
      for (uint32_t c = 0; c < slots<Node>(); ++c) {
        if (test(nodes[i].child[c], nodes[i].count[c]) && n-- == 0) return {i, static_cast<int>(c)};
      }
    }
    ADD_FAILURE() << "no such slot";
    return {0, 0};
  }
  static bool isLeaf(uint32_t, uint32_t count) { return count > 0; }
  static bool isInner(uint32_t child, uint32_t count) { return count == 0 && child != 0xffffffffu; }
  static bool isEmpty(uint32_t child, uint32_t) { return child == 0xffffffffu; }
};

TEST_F(BvhValidate, GoodTreeHasNoComplaint) {
  EXPECT_EQ(validate(good_, soup_.positions, soup_.triangles), "");
}

TEST_F(BvhValidate, NoNodes) {
  expectComplaint("nodes2: no root", [](Bvh& b) { b.nodes2.clear(); });
  expectComplaint("nodes8: no root", [](Bvh& b) { b.nodes8.clear(); });
  expectComplaint("no root", [](Bvh& b) { b = Bvh(); });
}

TEST_F(BvhValidate, IndexOutOfRange) {
  const auto [n2, c2] = find(good_.nodes2, isInner);
  const auto [n8, c8] = find(good_.nodes8, isInner);
  const auto [l2, d2] = find(good_.nodes2, isLeaf);
  const auto [l8, d8] = find(good_.nodes8, isLeaf);
  expectComplaint("points past the last node",
                  [&](Bvh& b) { b.nodes2[n2].child[c2] = static_cast<uint32_t>(b.nodes2.size()); });
  expectComplaint("points past the last node", [&](Bvh& b) { b.nodes8[n8].child[c8] = 0xfffffffeu; });
  expectComplaint("points past the last reference",
                  [&](Bvh& b) { b.nodes2[l2].child[d2] = static_cast<uint32_t>(b.references.size()); });
  expectComplaint("points past the last reference", [&](Bvh& b) { b.nodes8[l8].child[d8] = 0xfffffffeu; });
}

TEST_F(BvhValidate, NodeReachedTwiceOrNever) {
  const auto [n2, c2] = find(good_.nodes2, isInner, 3);
  const auto [n8, c8] = find(good_.nodes8, isInner, 3);
  expectComplaint("reached twice", [&](Bvh& b) { b.nodes2[n2].child[c2] = 0; });
  expectComplaint("reached twice", [&](Bvh& b) { b.nodes8[n8].child[c8] = 0; });
  expectComplaint("unreachable", [&](Bvh& b) { b.nodes2.push_back(b.nodes2.back()); });
  expectComplaint("unreachable", [&](Bvh& b) { b.nodes8.push_back(b.nodes8.back()); });
}

TEST_F(BvhValidate, BoxThatDoesNotContainItsChildren) {
  const auto [n2, c2] = find(good_.nodes2, isInner, 2);
  const auto [n8, c8] = find(good_.nodes8, isInner, 2);
  expectComplaint("is not contained", [&](Bvh& b) {
    glm::vec4& y = b.nodes2[n2].y;
    y[2 * c2 + 1] = std::nextafter(y[2 * c2 + 1], -1e9f);
  });
  expectComplaint("is not contained", [&](Bvh& b) {
    float& x = b.nodes8[n8].low_x[c8];
    x = std::nextafter(x, 1e9f);
  });
  for (const float bad : {kNaN, 1e9f}) {
    expectComplaint("low > high or NaN", [&](Bvh& b) { b.nodes2[n2].z[2 * c2] = bad; });
    expectComplaint("low > high or NaN", [&](Bvh& b) { b.nodes8[n8].low_z[c8] = bad; });
  }
}

TEST_F(BvhValidate, LeafSizes) {
  const auto [n2, c2] = find(good_.nodes2, isLeaf);
  expectComplaint("more than 8", [&](Bvh& b) { b.nodes2[n2].count[c2] = 9; });
  expectComplaint("", [&](Bvh& b) { b.nodes2[n2].count[c2] = 0xffffffffu; });
}

TEST_F(BvhValidate, ReferencesInTwoLeavesOrInNone) {
  const auto [n2, c2] = find(good_.nodes2, isLeaf, 5);
  const auto [m2, d2] = find(good_.nodes2, isLeaf, 6);
  expectComplaint("shares its references", [&](Bvh& b) { b.nodes2[n2].child[c2] = b.nodes2[m2].child[d2]; });
  expectComplaint("is in no leaf or in two", [&](Bvh& b) { ++b.nodes2[n2].count[c2]; });
  expectComplaint("is in no leaf or in two", [&](Bvh& b) { b.references.push_back(0); });
}

TEST_F(BvhValidate, LayoutsWithDifferentLeaves) {
  const auto [n8, c8] = find(good_.nodes8, isLeaf, 5);
  expectComplaint("differs between", [&](Bvh& b) { ++b.nodes8[n8].count[c8]; });
  const auto [m8, d8] = find(good_.nodes8, [](uint32_t, uint32_t count) { return count == 2; });
  expectComplaint("differs between", [&](Bvh& b) { b.nodes8[m8].count[d8] = 1; });
  expectComplaint("differs between", [&](Bvh& b) {
    float& x = b.nodes8[n8].high_x[c8];
    x = std::nextafter(x, -1e9f);
  });
}

TEST_F(BvhValidate, EmptySlots) {
  const auto [n8, c8] = find(good_.nodes8, isEmpty);
  expectComplaint("is empty but", [&](Bvh& b) { b.nodes8[n8].count[c8] = 1; });
  expectComplaint("is empty but", [&](Bvh& b) { b.nodes8[n8].low_y[c8] = b.nodes8[n8].high_y[c8]; });
  expectComplaint("has no child", [&](Bvh& b) {
    for (int i = 0; i < 8; ++i) {
      b.nodes8[0].count[i] = 0;
      b.nodes8[0].child[i] = 0xffffffffu;
      b.nodes8[0].low_x[i] = b.nodes8[0].low_y[i] = b.nodes8[0].low_z[i] = 1;
      b.nodes8[0].high_x[i] = b.nodes8[0].high_y[i] = b.nodes8[0].high_z[i] = -1;
    }
  });
}

TEST_F(BvhValidate, TrianglesMissingDoubledOrUnknown) {
  const auto [n2, c2] = find(good_.nodes2, [](uint32_t, uint32_t count) { return count >= 2; });
  const uint32_t first = good_.nodes2[n2].child[c2];
  expectComplaint("twice", [&](Bvh& b) { b.references[first] = b.references[first + 1]; });
  expectComplaint("is no triangle", [&](Bvh& b) { b.references[7] = 500; });
  expectComplaint("is not covered", [&](Bvh& b) { std::swap(b.references[0], b.references[499]); });
  soup_.triangles.push_back(soup_.triangles[0]);
  expectComplaint("triangle 500 is in no leaf", [](Bvh&) {});
}

TEST_F(BvhValidate, TriangleOutsideItsLeaf) {
  // A vertex on the border of everything: it moves out by the least possible.
  uint32_t far = 0;
  for (uint32_t i = 0; i < soup_.positions.size(); ++i) {
    if (soup_.positions[i].x > soup_.positions[far].x) far = i;
  }
  soup_.positions[far].x = std::nextafter(soup_.positions[far].x, 1e9f);
  expectComplaint("triangle " + std::to_string(far / 3) + " is not covered", [](Bvh&) {});
}

TEST_F(BvhValidate, Totals) {
  expectComplaint("depth", [](Bvh& b) { ++b.depth; });
  expectComplaint("low and high", [](Bvh& b) { b.high.z = std::nextafter(b.high.z, 1e9f); });
  expectComplaint("low and high", [](Bvh& b) { b.low.x = kNaN; });
  expectComplaint("sah_cost", [](Bvh& b) { b.sah_cost *= 1.01; });
  expectComplaint("sah_cost", [](Bvh& b) { b.sah_cost = kNaN; });
}

TEST_F(BvhValidate, TreeDeeperThanTheLimit) {
  // A comb by hand: each node has one leaf and the next node.
  Soup soup;
  Bvh bvh;
  const uint32_t n = kMaxDepth + 2;
  for (uint32_t i = 0; i < n; ++i) soup.add({0, 0, 0}, {1, 0, 0}, {0, 1, 1});
  for (uint32_t i = 0; i < n; ++i) bvh.references.push_back(i);
  for (uint32_t i = 0; i + 1 < n; ++i) {
    const bool last = i + 2 == n;
    const glm::vec4 box(0, 1, 0, 1);
    bvh.nodes2.push_back({box, box, box, {i, last ? i + 1 : i + 1}, {1, last ? 1u : 0u}});
    BvhNode8 wide;
    for (int c = 0; c < 8; ++c) {
      wide.low_x[c] = wide.low_y[c] = wide.low_z[c] = c < 2 ? 0.0f : 1.0f;
      wide.high_x[c] = wide.high_y[c] = wide.high_z[c] = c < 2 ? 1.0f : -1.0f;
      wide.child[c] = c == 0 ? i : c == 1 ? i + 1 : 0xffffffffu;
      wide.count[c] = c == 0 || (c == 1 && last) ? 1 : 0;
    }
    bvh.nodes8.push_back(wide);
  }
  bvh.high = glm::vec3(1);
  bvh.depth = n - 1;
  bvh.sah_cost = 2 * n - 1;
  EXPECT_EQ(validate(bvh, soup.positions, soup.triangles), "depth is above kMaxDepth");
}

TEST_F(BvhValidate, PartsThatLeaveAGap) {
  // One triangle in two leaves, cut at x = 0.5, whose boxes meet there or not.
  Soup soup;
  soup.add({0, 0, 0}, {1, 0, 0}, {0, 1, 1});
  Bvh bvh;
  bvh.references = {0, 0};
  bvh.high = glm::vec3(1);
  bvh.depth = 1;
  const auto complaint = [&](float left_high_x, float right_low_x, float right_high_y) {
    bvh.nodes2 = {
        {{0, left_high_x, right_low_x, 1}, {0, 1, 0, right_high_y}, {0, 1, 0, 0.5f}, {0, 1}, {1, 1}}};
    BvhNode8 wide;
    for (int c = 0; c < 8; ++c) {
      wide.low_x[c] = wide.low_y[c] = wide.low_z[c] = c < 2 ? 0.0f : 1.0f;
      wide.high_x[c] = wide.high_y[c] = wide.high_z[c] = c < 2 ? 1.0f : -1.0f;
      wide.child[c] = c < 2 ? static_cast<uint32_t>(c) : 0xffffffffu;
      wide.count[c] = c < 2 ? 1 : 0;
    }
    wide.high_x[0] = left_high_x;
    wide.low_x[1] = right_low_x;
    wide.high_y[1] = right_high_y;
    wide.high_z[1] = 0.5f;
    bvh.nodes8 = {wide};
    const auto area = [](float x, float y, float z) { return x * y + y * z + z * x; };
    bvh.sah_cost = 1 + (area(left_high_x, 1, 1) + area(1 - right_low_x, right_high_y, 0.5f)) / 3;
    return validate(bvh, soup.positions, soup.triangles);
  };
  EXPECT_EQ(complaint(0.5f, 0.5f, 0.5f), "");
  EXPECT_EQ(complaint(0.6f, 0.5f, 0.5f), "");
  EXPECT_NE(complaint(std::nextafter(0.5f, 0.0f), 0.5f, 0.5f).find("is not covered"), std::string::npos);
  EXPECT_NE(complaint(0.5f, std::nextafter(0.5f, 1.0f), 0.5f).find("is not covered"), std::string::npos);
  EXPECT_NE(complaint(0.5f, 0.5f, std::nextafter(0.5f, 0.0f)).find("is not covered"), std::string::npos);
}

}  // namespace
}  // namespace sightline
