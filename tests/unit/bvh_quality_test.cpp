// The tree is not only valid but good: next to a full sweep, with spatial splits, and as wide nodes.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <numeric>

#include "bvh/bvh.h"
#include "tests/unit/bvh_soup.h"

namespace sightline {
namespace {

struct DBox {
  glm::dvec3 low{1e300}, high{-1e300};
  void grow(const DBox& b) {
    low = glm::min(low, b.low);
    high = glm::max(high, b.high);
  }
  double halfArea() const {
    const glm::dvec3 d = high - low;
    return d.x * d.y + d.y * d.z + d.z * d.x;
  }
};

/// SAH cost of the tree that tries every cut between sorted centroids along each axis.
class Sweep {
 public:
  explicit Sweep(const Soup& soup) {
    for (const glm::uvec3 t : soup.triangles) {
      DBox b;
      for (int i = 0; i < 3; ++i) {
        const glm::dvec3 p = soup.positions[t[i]];
        b.grow({p, p});
      }
      boxes_.push_back(b);
    }
  }

  double cost(uint32_t max_leaf) {
    std::vector<uint32_t> ids(boxes_.size());
    std::iota(ids.begin(), ids.end(), 0u);
    return build(ids, max_leaf) / bounds(ids).halfArea();
  }

 private:
  DBox bounds(const std::vector<uint32_t>& ids) const {
    DBox b;
    for (const uint32_t i : ids) b.grow(boxes_[i]);
    return b;
  }

  double build(std::vector<uint32_t> ids, uint32_t max_leaf) {
    const double area = bounds(ids).halfArea();
    const double n = static_cast<double>(ids.size());
    double best = 1e300;
    std::vector<uint32_t> left, right;
    for (int a = 0; a < 3 && ids.size() > 1; ++a) {
      std::sort(ids.begin(), ids.end(), [&](uint32_t i, uint32_t j) {
        return boxes_[i].low[a] + boxes_[i].high[a] < boxes_[j].low[a] + boxes_[j].high[a];
      });
      std::vector<double> right_area(ids.size());
      DBox b;
      for (size_t i = ids.size(); i-- > 1;) {
        b.grow(boxes_[ids[i]]);
        right_area[i] = b.halfArea();
      }
      b = {};
      for (size_t i = 1; i < ids.size(); ++i) {
        b.grow(boxes_[ids[i - 1]]);
        const double c =
            b.halfArea() * static_cast<double>(i) + right_area[i] * static_cast<double>(ids.size() - i);
        if (c < best) {
          best = c;
          left.assign(ids.begin(), ids.begin() + static_cast<long>(i));
          right.assign(ids.begin() + static_cast<long>(i), ids.end());
        }
      }
    }
    if (ids.size() <= max_leaf && (ids.size() == 1 || area * n <= area + best)) return area * n;
    return area + build(left, max_leaf) + build(right, max_leaf);
  }

  std::vector<DBox> boxes_;
};

TEST(BvhQuality, BinningIsCloseToAFullSweep) {
  for (const float size : {0.02f, 0.3f}) {
    const Soup soup = randomSoup(4000, 1, size);
    const double best = Sweep(soup).cost(4);
    const Bvh bvh = buildBvh(soup.positions, soup.triangles);
    EXPECT_LT(bvh.sah_cost, 1.1 * best) << "triangles of " << size;
  }
  const Soup grid = gridSoup(50);
  EXPECT_LT(buildBvh(grid.positions, grid.triangles).sah_cost, 1.1 * Sweep(grid).cost(4));
}

TEST(BvhQuality, SpatialSplitsPayOnSliversWithinTheirBudget) {
  const Soup soup = sliverSoup(2000, 2);
  BvhConfig config;
  const double plain = buildBvh(soup.positions, soup.triangles, config).sah_cost;
  config.spatial_splits = true;
  double last = plain;
  for (const float budget : {0.1f, 0.3f, 1.0f}) {
    config.split_budget = budget;
    const Bvh bvh = buildBvh(soup.positions, soup.triangles, config);
    EXPECT_EQ(validate(bvh, soup.positions, soup.triangles), "") << budget;
    EXPECT_LE(static_cast<double>(bvh.references.size()), 2000 * (1.0 + budget) + 0.01);
    EXPECT_GT(bvh.references.size(), 2000u);
    EXPECT_LT(bvh.sah_cost, last) << budget;
    last = bvh.sah_cost;
  }
  EXPECT_LT(last, 0.9 * plain);
}

TEST(BvhQuality, NoBudgetMeansNoSplits) {
  const Soup soup = sliverSoup(500, 3);
  const Bvh plain = buildBvh(soup.positions, soup.triangles);
  BvhConfig config;
  config.spatial_splits = true;
  for (const float budget : {0.0f, -1.0f}) {
    config.split_budget = budget;
    const Bvh bvh = buildBvh(soup.positions, soup.triangles, config);
    EXPECT_EQ(bvh.references, plain.references);
    EXPECT_EQ(bvh.sah_cost, plain.sah_cost);
  }
}

double halfArea(const BvhNode2& n, int i) {
  const double x = n.x[2 * i + 1] - n.x[2 * i], y = n.y[2 * i + 1] - n.y[2 * i],
               z = n.z[2 * i + 1] - n.z[2 * i];
  return x * y + y * z + z * x;
}
double halfArea(const BvhNode8& n, int i) {
  const double x = n.high_x[i] - n.low_x[i], y = n.high_y[i] - n.low_y[i], z = n.high_z[i] - n.low_z[i];
  return x * y + y * z + z * x;
}

/// Least sum of wide nodes' areas below a binary node, by trying every way to open children.
class LeastWide {
 public:
  explicit LeastWide(const Bvh& bvh) : bvh_(bvh), known_(bvh.nodes2.size(), -1.0) {}

  double below(uint32_t node) {
    if (known_[node] < 0) known_[node] = open({{node, 0}, {node, 1}}, 0);
    return known_[node];
  }

 private:
  struct Slot {
    uint32_t node;
    int i;
  };
  /// Slots before `fixed` stay as they are.
  double open(std::vector<Slot> slots, size_t fixed) {
    if (fixed == slots.size()) return 0;
    const BvhNode2& n = bvh_.nodes2[slots[fixed].node];
    const int i = slots[fixed].i;
    if (n.count[i]) return open(slots, fixed + 1);
    const double whole = halfArea(n, i) + below(n.child[i]) + open(slots, fixed + 1);
    if (slots.size() == 8) return whole;
    slots[fixed] = {n.child[i], 0};
    slots.push_back({n.child[i], 1});
    return std::min(whole, open(slots, fixed));
  }

  const Bvh& bvh_;
  std::vector<double> known_;
};

TEST(BvhQuality, WideNodesHaveTheLeastTotalArea) {
  for (uint32_t seed = 0; seed < 20; ++seed) {
    const Soup soup = randomSoup(120, seed, 0.2f);
    const Bvh bvh = buildBvh(soup.positions, soup.triangles);
    double sum = 0;
    for (const BvhNode8& node : bvh.nodes8) {
      for (int i = 0; i < 8; ++i) {
        if (node.count[i] == 0 && node.child[i] != 0xffffffffu) sum += halfArea(node, i);
      }
    }
    EXPECT_NEAR(sum, LeastWide(bvh).below(0), 1e-4 * sum) << "seed " << seed;
  }
}

/// Empty slots are the last ones, and nodes are not half empty.
TEST(BvhQuality, WideNodesAreFilled) {
  for (const Soup& soup : {randomSoup(20000, 4, 0.05f), gridSoup(100)}) {
    const Bvh bvh = buildBvh(soup.positions, soup.triangles);
    size_t used = 0;
    for (const BvhNode8& node : bvh.nodes8) {
      int n = 0;
      while (n < 8 && node.child[n] != 0xffffffffu) ++n;
      used += static_cast<size_t>(n);
      for (int i = n; i < 8; ++i) ASSERT_EQ(node.child[i], 0xffffffffu);
    }
    EXPECT_GT(static_cast<double>(used), 4.5 * static_cast<double>(bvh.nodes8.size()));
  }
}

}  // namespace
}  // namespace sightline
