#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "bvh/axis_box.h"

namespace sightline {

/// No node, no item: the parent of the root, the children of a leaf, the item of an inner node.
inline constexpr uint32_t kNoBoxNode = 0xffffffffu;

/// A node of a tree over boxes: a leaf with one box, or two children.
struct BoxNode {
  AxisBox box;  ///< of what is below: the smallest that holds it
  uint32_t parent = kNoBoxNode;
  uint32_t children[2] = {kNoBoxNode, kNoBoxNode};
  uint32_t item = kNoBoxNode;  ///< of a leaf: which of the boxes given it holds
  uint32_t first_tight = 0;    ///< in BoxTree::tight
  uint32_t tight_count = 0;    ///< at least 1

  bool isLeaf() const { return item != kNoBoxNode; }
};

/// How many boxes stand for a node where its own is too coarse (CHC++: tight bounds).
struct TightBounds {
  uint32_t most_levels = 3;   ///< so many levels down at most; 0: the node's own box
  double most_surface = 1.4;  ///< while their surfaces add up to no more than so many times the node's own
};

/// A binary tree of boxes by the surface area heuristic, with a box a leaf.
struct BoxTree {
  std::vector<BoxNode> nodes;  ///< root first, depth first: children have higher numbers than their parent
  std::vector<AxisBox> tight;

  /// Boxes that together hold what the node holds: tighter than its own box, not much more to draw. A leaf's
  /// is its own.
  std::span<const AxisBox> tightOf(const BoxNode& node) const {
    return {tight.data() + node.first_tight, node.tight_count};
  }
};

/// Builds the tree. Boxes must be finite, low <= high, and may be the same; the same boxes give the same tree
/// on any number of threads (0: all cores). No boxes give no nodes. Throws std::length_error for 2^31 boxes
/// or more, and std::bad_alloc.
BoxTree buildBoxTree(std::span<const AxisBox> boxes, const TightBounds& tight = {}, int threads = 0);

}  // namespace sightline
