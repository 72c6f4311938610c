// The 8-wide layout. Which binary nodes become wide nodes is chosen so that the sum of the wide nodes'
// areas, the expected number of visits, is the least possible for the given binary tree.
// Based on: H. Ylitie, T. Karras, S. Laine, Efficient Incoherent Ray Traversal on GPUs Through Compressed
// Wide BVHs, 2017, section 3.1. Where we differ: leaves stay as they are.
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "bvh/subtree.h"

namespace sightline {

namespace {

constexpr int kWidth = 8;
/// Subtrees of at most so many binary nodes are handled by one thread.
constexpr uint32_t kPieceNodes = 4096;

/// Least cost of a subtree as a forest of at most i + 1 trees, i in [0, 7). Index 0: as one wide node.
using Costs = std::array<float, kWidth - 1>;
/// For a forest of at most i + 1 trees: how many of them the first child's side gets; 0: the node stays
/// whole. Index 7: the children of the node itself, when it is wide.
using Choice = std::array<uint8_t, kWidth>;

Box boxOf(const BvhNode2& node, int i) {
  const int l = 2 * i, h = 2 * i + 1;
  const float low[4] = {node.x[l], node.y[l], node.z[l], 0};
  const float high[4] = {node.x[h], node.y[h], node.z[h], 0};
  return {load4(low), load4(high)};
}

void setSlot(BvhNode8& node, int i, const Box& box, uint32_t child, uint32_t count) {
  node.low_x[i] = lane(box.low, 0);
  node.low_y[i] = lane(box.low, 1);
  node.low_z[i] = lane(box.low, 2);
  node.high_x[i] = lane(box.high, 0);
  node.high_y[i] = lane(box.high, 1);
  node.high_z[i] = lane(box.high, 2);
  node.child[i] = child;
  node.count[i] = count;
}

/// A child slot of a wide node: child i of a binary node, whose subtree ends before binary node `end`.
struct Slot {
  uint32_t node;
  int i;
  uint32_t end;
};

struct Slots {
  Slot slot[kWidth];
  int count = 0;
};

/// A wide node near the root, or all wide nodes of a subtree, built by one thread.
struct Part {
  uint32_t root;  ///< binary node
  bool piece;
  std::vector<BvhNode8> nodes;  ///< indices of inner children: of a part, or relative to the piece
  uint32_t first = 0;           ///< where the nodes go
};

class Collapse {
 public:
  Collapse(Bvh& bvh, const Measure& measure) : bvh_(bvh), measure_(measure), choice_(bvh.nodes2.size()) {}

  void run() {
    const uint32_t nodes = static_cast<uint32_t>(bvh_.nodes2.size());
    choose(0, nodes, 0);
    addTop(0, nodes);
    tbb::parallel_for(size_t{0}, parts_.size(), [&](size_t i) {
      if (parts_[i].piece) addNode(parts_[i].root, parts_[i].nodes);
    });
    uint32_t total = 0;
    for (Part& part : parts_) {
      part.first = total;
      total += static_cast<uint32_t>(part.nodes.size());
    }
    bvh_.nodes8.resize(total);
    tbb::parallel_for(size_t{0}, parts_.size(), [&](size_t i) { place(parts_[i]); });
  }

 private:
  /// Fills choice_ for the subtree of binary nodes [node, end), whose area is given.
  Costs choose(uint32_t node, uint32_t end, float area) {
    const BvhNode2& n = bvh_.nodes2[node];
    Costs cost[2] = {};  // a leaf costs nothing here
    const auto chooseChild = [&](int i) {
      if (n.count[i] || n.child[i] == kNoChild) return;
      const uint32_t child_end = i == 0 && isInner(n, 1) ? n.child[1] : end;
      cost[i] = choose(n.child[i], child_end, measure_.halfArea(boxOf(n, i)));
    };
    if (end - node > kPieceNodes) {
      tbb::parallel_invoke([&] { chooseChild(0); }, [&] { chooseChild(1); });
    } else {
      chooseChild(0);
      chooseChild(1);
    }
    return combine(cost[0], cost[1], area, choice_[node]);
  }

  static bool isInner(const BvhNode2& n, int i) { return n.count[i] == 0 && n.child[i] != kNoChild; }

  static Costs combine(const Costs& a, const Costs& b, float area, Choice& choice) {
    Costs cost;
    float split[kWidth + 1];  // by number of trees, 2..8
    for (int trees = 2; trees <= kWidth; ++trees) {
      split[trees] = std::numeric_limits<float>::infinity();
      for (int left = 1; left < trees; ++left) {
        const float c = a[left - 1] + b[trees - left - 1];
        if (c < split[trees]) {
          split[trees] = c;
          choice[trees - 1] = static_cast<uint8_t>(left);
        }
      }
    }
    cost[0] = split[kWidth] + area;
    choice[0] = 0;
    for (int trees = 2; trees < kWidth; ++trees) {
      cost[trees - 1] = std::min(cost[0], split[trees]);
      if (cost[0] < split[trees]) choice[trees - 1] = 0;
    }
    return cost;
  }

  /// The slots that a binary node's children take among `trees` slots.
  void gather(uint32_t node, uint32_t end, int trees, Slots& slots) const {
    const int left = choice_[node][trees - 1];
    const BvhNode2& n = bvh_.nodes2[node];
    for (int i = 0; i < 2; ++i) {
      const int share = i == 0 ? left : trees - left;
      const uint32_t child_end = i == 0 && isInner(n, 1) ? n.child[1] : end;
      if (isInner(n, i) && choice_[n.child[i]][share - 1]) {
        gather(n.child[i], child_end, share, slots);
      } else if (n.child[i] != kNoChild) {
        slots.slot[slots.count++] = {node, i, child_end};
      }
    }
  }

  /// A wide node for a binary node; inner children get the index that addInner returns.
  template <typename AddInner>
  BvhNode8 makeNode(uint32_t node, uint32_t end, AddInner addInner) const {
    Slots slots;
    gather(node, end, kWidth, slots);
    BvhNode8 wide;
    for (int i = 0; i < kWidth; ++i) {
      if (i >= slots.count) {
        const float most = std::numeric_limits<float>::infinity();
        setSlot(wide, i, {splat4(most), splat4(-most)}, kNoChild, 0);
        continue;
      }
      const BvhNode2& n = bvh_.nodes2[slots.slot[i].node];
      const int side = slots.slot[i].i;
      const uint32_t child = n.count[side] ? n.child[side] : addInner(n.child[side], slots.slot[i].end);
      setSlot(wide, i, boxOf(n, side), child, n.count[side]);
    }
    return wide;
  }

  uint32_t addTop(uint32_t node, uint32_t end) {
    const uint32_t index = static_cast<uint32_t>(parts_.size());
    const bool piece = end - node <= kPieceNodes;
    parts_.push_back({node, piece, {}});
    if (!piece) {
      const BvhNode8 wide = makeNode(node, end, [&](uint32_t c, uint32_t e) { return addTop(c, e); });
      parts_[index].nodes.push_back(wide);
    }
    return index;
  }

  uint32_t addNode(uint32_t node, std::vector<BvhNode8>& nodes) const {
    const uint32_t index = static_cast<uint32_t>(nodes.size());
    nodes.emplace_back();
    const BvhNode8 wide = makeNode(node, 0, [&](uint32_t c, uint32_t) { return addNode(c, nodes); });
    nodes[index] = wide;
    return index;
  }

  void place(Part& part) {
    BvhNode8* to = bvh_.nodes8.data() + part.first;
    for (const BvhNode8& from : part.nodes) {
      *to = from;
      for (int i = 0; i < kWidth; ++i) {
        if (from.count[i] || from.child[i] == kNoChild) continue;
        to->child[i] = part.piece ? part.first + from.child[i] : parts_[from.child[i]].first;
      }
      ++to;
    }
    part.nodes = {};
  }

  Bvh& bvh_;
  const Measure& measure_;
  std::vector<Choice> choice_;
  std::vector<Part> parts_;  ///< depth first
};

}  // namespace

void collapse(Bvh& bvh, const Measure& measure) {
  Collapse(bvh, measure).run();
}

}  // namespace sightline
