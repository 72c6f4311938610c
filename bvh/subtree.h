#pragma once
// The tree while it grows: pieces that one thread each has built, under a few nodes that join them.
#include <cstdint>
#include <memory>
#include <vector>

#include "bvh/bvh.h"
#include "bvh/reference.h"

namespace sightline {

/// Either a join of two parts, or a piece: nodes in depth-first order with indices relative to the piece.
/// A piece without nodes is one leaf.
struct TreePart {
  Box box;
  std::unique_ptr<TreePart> child[2];
  std::vector<BvhNode2> nodes;
  std::vector<uint32_t> references;
  double cost = 0;     ///< of the piece: inner nodes' areas plus leaves' areas times count, scaled
  uint32_t depth = 0;  ///< inner nodes on the longest path in the piece

  bool isJoin() const { return child[0] != nullptr; }
};

void setChild(BvhNode2& node, int i, const Box& box, uint32_t child, uint32_t count);
/// Marks a child as absent: low > high, child kNoChild, count 0.
void setNoChild(BvhNode2& node, int i);

/// Puts the parts together depth first into nodes2, references, depth, sah_cost and bounds. Frees them.
void assemble(std::unique_ptr<TreePart> root, const Measure& measure, Bvh& bvh);

/// Makes nodes8 from nodes2.
void collapse(Bvh& bvh, const Measure& measure);

}  // namespace sightline
