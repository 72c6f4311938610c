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
  struct Slot {
    uint32_t node = 0;
    int child = 0;
  };
  /// The n-th leaf, or inner child, or empty slot in memory order.
  template <typename Node, typename Test>
  static Slot find(const std::vector<Node>& nodes, Test test, int n = 0) {
    for (uint32_t i = 0; i < nodes.size(); ++i) {
      for (uint32_t c = 0; c < slots<Node>(); ++c) {
        if (test(nodes[i].child[c], nodes[i].count[c]) && n-- == 0) return {i, static_cast<int>(c)};
      }
    }
    ADD_FAILURE() << "no such slot";
    return {};
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
  const Slot slot2 = find(good_.nodes2, isInner);
  const Slot slot8 = find(good_.nodes8, isInner);
  const Slot leaf2 = find(good_.nodes2, isLeaf);
  const Slot leaf8 = find(good_.nodes8, isLeaf);
  expectComplaint("points past the last node", [&](Bvh& b) {
    b.nodes2[slot2.node].child[slot2.child] = static_cast<uint32_t>(b.nodes2.size());
  });
  expectComplaint("points past the last node",
                  [&](Bvh& b) { b.nodes8[slot8.node].child[slot8.child] = 0xfffffffeu; });
  expectComplaint("points past the last reference", [&](Bvh& b) {
    b.nodes2[leaf2.node].child[leaf2.child] = static_cast<uint32_t>(b.references.size());
  });
  expectComplaint("points past the last reference",
                  [&](Bvh& b) { b.nodes8[leaf8.node].child[leaf8.child] = 0xfffffffeu; });
}

TEST_F(BvhValidate, NodeReachedTwiceOrNever) {
  const Slot slot2 = find(good_.nodes2, isInner, 3);
  const Slot slot8 = find(good_.nodes8, isInner, 3);
  expectComplaint("reached twice", [&](Bvh& b) { b.nodes2[slot2.node].child[slot2.child] = 0; });
  expectComplaint("reached twice", [&](Bvh& b) { b.nodes8[slot8.node].child[slot8.child] = 0; });
  expectComplaint("unreachable", [&](Bvh& b) { b.nodes2.push_back(b.nodes2.back()); });
  expectComplaint("unreachable", [&](Bvh& b) { b.nodes8.push_back(b.nodes8.back()); });
}

TEST_F(BvhValidate, BoxThatDoesNotContainItsChildren) {
  const Slot slot2 = find(good_.nodes2, isInner, 2);
  const Slot slot8 = find(good_.nodes8, isInner, 2);
  expectComplaint("is not contained", [&](Bvh& b) {
    glm::vec4& y = b.nodes2[slot2.node].y;
    y[2 * slot2.child + 1] = std::nextafter(y[2 * slot2.child + 1], -1e9f);
  });
  expectComplaint("is not contained", [&](Bvh& b) {
    float& x = b.nodes8[slot8.node].low_x[slot8.child];
    x = std::nextafter(x, 1e9f);
  });
  for (const float bad : {kNaN, 1e9f}) {
    expectComplaint("low > high or NaN", [&](Bvh& b) { b.nodes2[slot2.node].z[2 * slot2.child] = bad; });
    expectComplaint("low > high or NaN", [&](Bvh& b) { b.nodes8[slot8.node].low_z[slot8.child] = bad; });
  }
}

TEST_F(BvhValidate, LeafSizes) {
  const Slot slot2 = find(good_.nodes2, isLeaf);
  expectComplaint("more than 8", [&](Bvh& b) { b.nodes2[slot2.node].count[slot2.child] = 9; });
  expectComplaint("", [&](Bvh& b) { b.nodes2[slot2.node].count[slot2.child] = 0xffffffffu; });
}

TEST_F(BvhValidate, ReferencesInTwoLeavesOrInNone) {
  const Slot slot2 = find(good_.nodes2, isLeaf, 5);
  const Slot other2 = find(good_.nodes2, isLeaf, 6);
  expectComplaint("shares its references", [&](Bvh& b) {
    b.nodes2[slot2.node].child[slot2.child] = b.nodes2[other2.node].child[other2.child];
  });
  expectComplaint("is in no leaf or in two", [&](Bvh& b) { ++b.nodes2[slot2.node].count[slot2.child]; });
  expectComplaint("is in no leaf or in two", [&](Bvh& b) { b.references.push_back(0); });
}

TEST_F(BvhValidate, LayoutsWithDifferentLeaves) {
  const Slot slot8 = find(good_.nodes8, isLeaf, 5);
  expectComplaint("differs between", [&](Bvh& b) { ++b.nodes8[slot8.node].count[slot8.child]; });
  const Slot other8 = find(good_.nodes8, [](uint32_t, uint32_t count) { return count == 2; });
  expectComplaint("differs between", [&](Bvh& b) { b.nodes8[other8.node].count[other8.child] = 1; });
  expectComplaint("differs between", [&](Bvh& b) {
    float& x = b.nodes8[slot8.node].high_x[slot8.child];
    x = std::nextafter(x, -1e9f);
  });
}

TEST_F(BvhValidate, EmptySlots) {
  const Slot slot8 = find(good_.nodes8, isEmpty);
  expectComplaint("is empty but", [&](Bvh& b) { b.nodes8[slot8.node].count[slot8.child] = 1; });
  expectComplaint("is empty but", [&](Bvh& b) {
    b.nodes8[slot8.node].low_y[slot8.child] = b.nodes8[slot8.node].high_y[slot8.child];
  });
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
  const Slot slot2 = find(good_.nodes2, [](uint32_t, uint32_t count) { return count >= 2; });
  const uint32_t first = good_.nodes2[slot2.node].child[slot2.child];
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
