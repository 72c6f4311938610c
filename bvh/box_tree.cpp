// Tight bounds are based on: O. Mattausch, J. Bittner and M. Wimmer, CHC++: Coherent Hierarchical Culling
// Revisited, 2008, section 5.2: boxes a few levels below a node, as long as their surfaces do not add up to
// much more than its own.
#include "bvh/box_tree.h"

#include <stdexcept>

#include "bvh/bvh.h"

namespace sightline {

namespace {

/// Scale and units do not matter: only ratios of surfaces are asked for.
double halfSurface(const AxisBox& box) {
  const double x = double(box.high.x) - box.low.x, y = double(box.high.y) - box.low.y,
               z = double(box.high.z) - box.low.z;
  return (x * y + y * z) + z * x;
}

class BoxTreeMaker {
 public:
  BoxTreeMaker(std::span<const AxisBox> boxes, const Bvh& bvh, BoxTree& tree)
      : boxes_(boxes), bvh_(bvh), tree_(tree) {}

  uint32_t addInner(uint32_t source, uint32_t parent) {
    const BvhNode2& from = bvh_.nodes2[source];
    if (from.child[1] == kNoChild) return addLeaf(from.child[0], parent);  // a tree of one box
    const uint32_t index = addNode(parent);
    for (int i = 0; i < 2; ++i) {
      const uint32_t child =
          from.count[i] > 0 ? addLeaf(from.child[i], index) : addInner(from.child[i], index);
      tree_.nodes[index].children[i] = child;
    }
    const AxisBox &a = tree_.nodes[tree_.nodes[index].children[0]].box,
                  &b = tree_.nodes[tree_.nodes[index].children[1]].box;
    tree_.nodes[index].box = {glm::min(a.low, b.low), glm::max(a.high, b.high)};
    return index;
  }

 private:
  uint32_t addNode(uint32_t parent) {
    tree_.nodes.emplace_back().parent = parent;
    return static_cast<uint32_t>(tree_.nodes.size() - 1);
  }

  uint32_t addLeaf(uint32_t place, uint32_t parent) {
    const uint32_t index = addNode(parent);
    tree_.nodes[index].item = bvh_.references[place];
    tree_.nodes[index].box = boxes_[tree_.nodes[index].item];
    return index;
  }

  std::span<const AxisBox> boxes_;
  const Bvh& bvh_;
  BoxTree& tree_;
};

void addTight(BoxTree& tree, BoxNode& node, const TightBounds& limits) {
  const double most = limits.most_surface * halfSurface(node.box);
  std::vector<uint32_t> kept{static_cast<uint32_t>(&node - tree.nodes.data())};
  for (uint32_t level = 0; level < limits.most_levels; ++level) {
    std::vector<uint32_t> below;
    double surface = 0;
    for (const uint32_t i : kept) {
      const BoxNode& n = tree.nodes[i];
      if (n.isLeaf()) {
        below.push_back(i);
      } else {
        below.insert(below.end(), n.children, n.children + 2);
      }
    }
    for (const uint32_t i : below) surface += halfSurface(tree.nodes[i].box);
    if (below.size() == kept.size() || !(surface <= most)) break;
    kept = below;
  }
  node.first_tight = static_cast<uint32_t>(tree.tight.size());
  node.tight_count = static_cast<uint32_t>(kept.size());
  for (const uint32_t i : kept) tree.tight.push_back(tree.nodes[i].box);
}

}  // namespace

BoxTree buildBoxTree(std::span<const AxisBox> boxes, const TightBounds& tight, int threads) {
  BoxTree tree;
  if (boxes.empty()) return tree;
  if (boxes.size() >= size_t{1} << 31) throw std::length_error("too many boxes for one tree");
  // Over triangles with these boxes.
  std::vector<glm::vec3> positions;
  std::vector<glm::uvec3> triangles;
  positions.reserve(2 * boxes.size());
  triangles.reserve(boxes.size());
  for (const AxisBox& box : boxes) {
    const uint32_t first = static_cast<uint32_t>(positions.size());
    positions.insert(positions.end(), {box.low, box.high});
    triangles.emplace_back(first, first + 1, first + 1);
  }
  const Bvh bvh = buildBvh(positions, triangles, {.max_leaf_size = 1, .threads = threads});
  tree.nodes.reserve(2 * boxes.size() - 1);
  BoxTreeMaker(boxes, bvh, tree).addInner(bvh.top2, kNoBoxNode);
  for (BoxNode& node : tree.nodes) addTight(tree, node, tight);
  return tree;
}

}  // namespace sightline
