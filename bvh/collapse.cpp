// The 8-wide layout: each wide node takes a binary node and opens, again and again, the child with the
// largest surface until eight are there (or only leaves).
// Based on: I. Wald, C. Benthin, S. Boulos, Getting Rid of Packets, 2008, section 3.
#include <algorithm>
#include <limits>

#include "bvh/subtree.h"

namespace sightline {

namespace {

struct Child {
  Box box;
  uint32_t child, count;
  float area;
};

Child childOf(const BvhNode2& node, int i, const Measure& measure) {
  const int l = 2 * i, h = 2 * i + 1;
  const float low[4] = {node.x[l], node.y[l], node.z[l], 0};
  const float high[4] = {node.x[h], node.y[h], node.z[h], 0};
  Child c{{load4(low), load4(high)}, node.child[i], node.count[i], 0};
  c.area = measure.halfArea(c.box);
  return c;
}

/// Index of the inner child with the largest area, the first of equal ones; -1: only leaves.
int childToOpen(const Child* children, int n) {
  int best = -1;
  for (int i = 0; i < n; ++i) {
    if (children[i].count == 0 && (best < 0 || children[i].area > children[best].area)) best = i;
  }
  return best;
}

int gather(const Bvh& bvh, uint32_t node, const Measure& measure, Child* children) {
  int n = 0;
  for (int i = 0; i < 2; ++i) {
    if (bvh.nodes2[node].child[i] != 0xffffffffu) children[n++] = childOf(bvh.nodes2[node], i, measure);
  }
  for (int open; n < 8 && (open = childToOpen(children, n)) >= 0;) {
    const BvhNode2& opened = bvh.nodes2[children[open].child];
    children[open] = childOf(opened, 0, measure);
    children[n++] = childOf(opened, 1, measure);
  }
  return n;
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

uint32_t addNode8(Bvh& bvh, uint32_t node2, const Measure& measure) {
  const uint32_t index = static_cast<uint32_t>(bvh.nodes8.size());
  bvh.nodes8.emplace_back();
  Child children[8];
  const int n = gather(bvh, node2, measure, children);
  for (int i = 0; i < 8; ++i) {
    if (i >= n) {
      const float most = std::numeric_limits<float>::max();
      setSlot(bvh.nodes8[index], i, {splat4(most), splat4(-most)}, 0xffffffffu, 0);
      continue;
    }
    const Child& c = children[i];
    const uint32_t child = c.count ? c.child : addNode8(bvh, c.child, measure);
    setSlot(bvh.nodes8[index], i, c.box, child, c.count);
  }
  return index;
}

}  // namespace

void collapse(Bvh& bvh, const Measure& measure) {
  addNode8(bvh, 0, measure);
}

}  // namespace sightline
