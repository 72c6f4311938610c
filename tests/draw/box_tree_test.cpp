// Trees over boxes: nothing is missing, nothing is larger than it must be.
#include "bvh/box_tree.h"

#include <gtest/gtest.h>

#include "tests/support/random_triangles.h"

namespace sightline {
namespace {

std::vector<AxisBox> randomBoxes(uint32_t count, uint32_t seed, float size) {
  testing_support::Random random(seed);
  std::vector<AxisBox> boxes;
  for (uint32_t i = 0; i < count; ++i) {
    const vec3 low = random.point(10), extent = glm::abs(random.point(size));
    boxes.push_back({low, low + extent});
  }
  return boxes;
}

double surface(const AxisBox& box) {
  const glm::dvec3 d = glm::dvec3(box.high) - glm::dvec3(box.low);
  return d.x * d.y + d.y * d.z + d.z * d.x;
}

bool holds(const AxisBox& outer, const AxisBox& inner) {
  return glm::all(glm::lessThanEqual(outer.low, inner.low)) &&
         glm::all(glm::greaterThanEqual(outer.high, inner.high));
}

/// Items below a node; checks all that is said of nodes on the way.
std::vector<uint32_t> check(const BoxTree& tree, const std::vector<AxisBox>& boxes, uint32_t index) {
  const BoxNode& node = tree.nodes[index];
  if (node.isLeaf()) {
    EXPECT_EQ(node.box, boxes[node.item]);
    EXPECT_EQ(node.children[0], kNoBoxNode);
    EXPECT_EQ(node.tight_count, 1u);
    EXPECT_EQ(tree.tightOf(node)[0], node.box);
    return {node.item};
  }
  std::vector<uint32_t> items;
  AxisBox box = tree.nodes[node.children[0]].box;
  for (const uint32_t child : node.children) {
    EXPECT_GT(child, index);
    EXPECT_EQ(tree.nodes[child].parent, index);
    const auto below = check(tree, boxes, child);
    items.insert(items.end(), below.begin(), below.end());
    box = {glm::min(box.low, tree.nodes[child].box.low), glm::max(box.high, tree.nodes[child].box.high)};
  }
  EXPECT_EQ(node.box, box);
  double sum = 0;
  for (const AxisBox& tight : tree.tightOf(node)) {
    EXPECT_TRUE(holds(node.box, tight));
    sum += surface(tight);
  }
  EXPECT_LE(sum, std::max(1.4 * surface(node.box), surface(node.box)));
  EXPECT_LE(node.tight_count, 8u);
  for (const uint32_t item : items) {
    EXPECT_TRUE(
        std::ranges::any_of(tree.tightOf(node), [&](const AxisBox& t) { return holds(t, boxes[item]); }));
  }
  return items;
}

TEST(BoxTree, HoldsEveryBoxOnceInTheSmallestNodes) {
  for (const uint32_t count : {1u, 2u, 3u, 17u, 500u, 6000u}) {
    SCOPED_TRACE(count);
    const auto boxes = randomBoxes(count, count, 2);
    const BoxTree tree = buildBoxTree(boxes);
    EXPECT_EQ(tree.nodes.size(), 2 * size_t{count} - 1);
    EXPECT_EQ(tree.nodes[0].parent, kNoBoxNode);
    auto items = check(tree, boxes, 0);
    std::sort(items.begin(), items.end());
    for (uint32_t i = 0; i < count; ++i) ASSERT_EQ(items[i], i);
  }
}

TEST(BoxTree, TightBoundsAreUsedWhereTheyPay) {
  // Two small boxes far apart: their parent's own box is nearly empty. One in the other: the parent's is as
  // good.
  const std::vector<AxisBox> apart{{{0, 0, 0}, {1, 1, 1}}, {{100, 100, 100}, {101, 101, 101}}};
  EXPECT_EQ(buildBoxTree(apart).nodes[0].tight_count, 2u);
  const std::vector<AxisBox> nested{{{0, 0, 0}, {10, 10, 10}}, {{1, 1, 1}, {9, 9, 9}}};
  EXPECT_EQ(buildBoxTree(nested).nodes[0].tight_count, 1u);
  EXPECT_EQ(buildBoxTree(apart, {.most_levels = 0}).nodes[0].tight_count, 1u);
}

TEST(BoxTree, SameBoxesAndFlatOnesAreTaken) {
  const std::vector<AxisBox> boxes(100, AxisBox{{1, 2, 3}, {4, 2, 6}});
  const BoxTree tree = buildBoxTree(boxes);
  EXPECT_EQ(check(tree, boxes, 0).size(), 100u);
  EXPECT_TRUE(buildBoxTree({}).nodes.empty());
  const std::vector<AxisBox> points(5, AxisBox{});
  EXPECT_EQ(check(buildBoxTree(points), points, 0).size(), 5u);
}

TEST(BoxTree, DependsOnNoThreads) {
  const auto boxes = randomBoxes(50000, 3, 0.5f);
  const BoxTree one = buildBoxTree(boxes, {}, 1), two = buildBoxTree(boxes, {}, 2);
  ASSERT_EQ(one.nodes.size(), two.nodes.size());
  for (size_t i = 0; i < one.nodes.size(); ++i) {
    ASSERT_EQ(one.nodes[i].box, two.nodes[i].box);
    ASSERT_EQ(one.nodes[i].item, two.nodes[i].item);
    ASSERT_EQ(one.nodes[i].parent, two.nodes[i].parent);
  }
  EXPECT_EQ(one.tight, two.tight);
}

}  // namespace
}  // namespace sightline
