// From parts to one tree, depth first: a node's first inner child directly follows it.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>

#include "bvh/subtree.h"

namespace sightline {

namespace {

struct Place {
  TreePart* part;
  uint32_t first_node, first_reference;
};

/// Lays out the joins' nodes and decides where each piece goes.
struct Layout {
  const Measure& measure;
  Bvh& bvh;
  std::vector<Place> pieces;
  std::vector<std::pair<uint32_t, BvhNode2>> joins;
  uint32_t nodes = 0, references = 0;
  double cost = 0;

  struct Result {
    uint32_t child, count;
  };

  Result add(TreePart& part, uint32_t depth) {
    if (!part.isJoin()) return addPiece(part, depth);
    const uint32_t index = nodes++;
    const size_t slot = joins.size();
    joins.emplace_back(index, BvhNode2{});
    cost += measure.halfArea(part.box);
    bvh.depth = std::max(bvh.depth, depth + 1);
    for (int i = 0; i < 2; ++i) {
      const Result r = add(*part.child[i], depth + 1);
      setChild(joins[slot].second, i, part.child[i]->box, r.child, r.count);
    }
    return {index, 0};
  }

  Result addPiece(TreePart& part, uint32_t depth) {
    pieces.push_back({&part, nodes, references});
    cost += part.cost;
    bvh.depth = std::max(bvh.depth, depth + part.depth);
    const uint32_t count = static_cast<uint32_t>(part.references.size());
    const Result result = part.nodes.empty() ? Result{references, count} : Result{nodes, 0};
    nodes += static_cast<uint32_t>(part.nodes.size());
    references += count;
    return result;
  }
};

void copyPiece(const Place& place, Bvh& bvh) {
  BvhNode2* node = bvh.nodes2.data() + place.first_node;
  for (const BvhNode2& n : place.part->nodes) {
    *node = n;
    for (int i = 0; i < 2; ++i) node->child[i] += n.count[i] ? place.first_reference : place.first_node;
    ++node;
  }
  std::copy(place.part->references.begin(), place.part->references.end(),
            bvh.references.begin() + place.first_reference);
  place.part->nodes = {};
  place.part->references = {};
}

}  // namespace

void setChild(BvhNode2& node, int i, const Box& box, uint32_t child, uint32_t count) {
  glm::vec4* axes[3] = {&node.x, &node.y, &node.z};
  for (int a = 0; a < 3; ++a) {
    (*axes[a])[2 * i] = lane(box.low, a);
    (*axes[a])[2 * i + 1] = lane(box.high, a);
  }
  node.child[i] = child;
  node.count[i] = count;
}

void setNoChild(BvhNode2& node, int i) {
  const float most = std::numeric_limits<float>::infinity();
  setChild(node, i, {splat4(most), splat4(-most)}, kNoChild, 0);
}

void assemble(std::unique_ptr<TreePart> root, const Measure& measure, Bvh& bvh) {
  Layout layout{measure, bvh, {}, {}, 0, 0, 0};
  layout.add(*root, 0);
  const double area = measure.halfArea(root->box);
  if (layout.nodes == 0) {
    BvhNode2 node;
    setChild(node, 0, root->box, 0, layout.references);
    setNoChild(node, 1);
    layout.joins.emplace_back(0, node);
    layout.nodes = 1;
    layout.cost += area;
    bvh.depth = 1;
  }
  bvh.sah_cost = area > 0 ? layout.cost / area : 0;
  bvh.low = {lane(root->box.low, 0), lane(root->box.low, 1), lane(root->box.low, 2)};
  bvh.high = {lane(root->box.high, 0), lane(root->box.high, 1), lane(root->box.high, 2)};
  bvh.nodes2.resize(layout.nodes);
  bvh.references.resize(layout.references);
  for (const auto& [index, node] : layout.joins) bvh.nodes2[index] = node;
  tbb::parallel_for(size_t{0}, layout.pieces.size(), [&](size_t i) { copyPiece(layout.pieces[i], bvh); });
}

}  // namespace sightline
