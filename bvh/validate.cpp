// Checks a tree from its definition alone, trusting no index in it.
#include <algorithm>
#include <cmath>
#include <vector>

#include "bvh/bvh.h"
#include "bvh/coverage.h"

namespace sightline {

namespace {

using Bounds3 = CoverageBox;

bool isEmpty(const Bounds3& b) {
  return b.low.x > b.high.x && b.low.y > b.high.y && b.low.z > b.high.z;
}
bool isOrdered(const Bounds3& b) {
  return b.low.x <= b.high.x && b.low.y <= b.high.y && b.low.z <= b.high.z;
}
bool contains(const Bounds3& outer, const Bounds3& inner) {
  return glm::all(glm::lessThanEqual(outer.low, inner.low)) &&
         glm::all(glm::greaterThanEqual(outer.high, inner.high));
}
bool equal(const Bounds3& a, const Bounds3& b) {
  return a.low == b.low && a.high == b.high;
}
Bounds3 unite(const Bounds3& a, const Bounds3& b) {
  return {glm::min(a.low, b.low), glm::max(a.high, b.high)};
}

Bounds3 boundsOf(const BvhNode2& n, int i) {
  const int l = 2 * i, h = l + 1;
  return {{n.x[l], n.y[l], n.z[l]}, {n.x[h], n.y[h], n.z[h]}};
}
Bounds3 boundsOf(const BvhNode8& n, int i) {
  return {{n.low_x[i], n.low_y[i], n.low_z[i]}, {n.high_x[i], n.high_y[i], n.high_z[i]}};
}
template <typename Node>
constexpr int kChildren = sizeof(Node::child) / sizeof(uint32_t);

/// What a walk found for the leaf that starts at a reference.
struct Leaf {
  Bounds3 box;
  uint32_t count = 0;
};

struct Walk {
  std::vector<Leaf> leaf_at;  ///< by first reference; count 0: no leaf starts there
  Bounds3 root;
  uint32_t depth = 0;
  double cost = 0;  ///< areas of inner nodes plus areas of leaves times count
};

double halfArea(const Bounds3& b) {
  const glm::dvec3 d = glm::dvec3(b.high) - glm::dvec3(b.low);
  return d.x * d.y + d.y * d.z + d.z * d.x;
}

/// Walks nodes from 0, each once. Boxes of inner children must contain what is below.
template <typename Node>
class Walker {
 public:
  Walker(const char* name, const std::vector<Node>& nodes, size_t references)
      : name_(name), nodes_(nodes), reached_(nodes.size(), false) {
    walk_.leaf_at.resize(references);
  }

  /// A complaint, or empty.
  std::string run() {
    if (nodes_.empty()) return std::string(name_) + ": no root";
    push({0, 1, {}});
    while (!stack_.empty() && error_.empty()) {
      const Entry e = stack_.back();
      stack_.pop_back();
      visit(e);
    }
    const auto lost = std::find(reached_.begin(), reached_.end(), false);
    if (lost != reached_.end()) fail(static_cast<uint32_t>(lost - reached_.begin()), -1, "is unreachable");
    return error_;
  }
  const Walk& result() const { return walk_; }

 private:
  struct Entry {
    uint32_t node, depth;
    Bounds3 box;
  };

  /// Keeps the first complaint.
  void fail(uint32_t node, int child, const char* what) {
    if (!error_.empty()) return;
    error_ = std::string(name_) + " node " + std::to_string(node) + " ";
    if (child >= 0) error_ += "child " + std::to_string(child) + " ";
    error_ += what;
  }

  void push(const Entry& e) {
    reached_[e.node] = true;
    stack_.push_back(e);
  }

  void visit(const Entry& e) {
    const Node& node = nodes_[e.node];
    Bounds3 all{glm::vec3(INFINITY), glm::vec3(-INFINITY)};
    walk_.depth = std::max(walk_.depth, e.depth);
    for (int i = 0; i < kChildren<Node>; ++i) {
      const Bounds3 box = boundsOf(node, i);
      if (node.child[i] == kNoChild) {
        if (node.count[i] != 0 || !isEmpty(box)) fail(e.node, i, "is empty but has a count or a box");
        continue;
      }
      if (!isOrdered(box)) fail(e.node, i, "has a box with low > high or NaN");
      all = unite(all, box);
      if (node.count[i] == 0) {
        visitInner(e, i, node.child[i], box);
      } else {
        visitLeaf(e, i, node.child[i], node.count[i], box);
      }
    }
    if (!isOrdered(all)) fail(e.node, -1, "has no child");
    if (e.node == 0) {
      walk_.root = all;
    } else if (!contains(e.box, all)) {
      fail(e.node, -1, "is not contained in the box that its parent has for it");
    }
    walk_.cost += halfArea(e.node == 0 ? all : e.box);
  }

  void visitInner(const Entry& parent, int i, uint32_t index, const Bounds3& box) {
    if (index >= nodes_.size()) {
      fail(parent.node, i, "points past the last node");
    } else if (reached_[index]) {
      fail(parent.node, i, "points to a node that is reached twice");
    } else {
      push({index, parent.depth + 1, box});
    }
  }

  void visitLeaf(const Entry& parent, int i, uint32_t first, uint32_t count, const Bounds3& box) {
    const size_t total = walk_.leaf_at.size();
    if (count > 8) fail(parent.node, i, "is a leaf of more than 8 references");
    if (first >= total || count > total - first) {
      fail(parent.node, i, "points past the last reference");
    } else if (walk_.leaf_at[first].count) {
      fail(parent.node, i, "shares its references with another leaf");
    } else {
      walk_.leaf_at[first] = {box, count};
      walk_.cost += halfArea(box) * count;
    }
  }

  const char* name_;
  const std::vector<Node>& nodes_;
  std::vector<bool> reached_;
  std::vector<Entry> stack_;
  Walk walk_;
  std::string error_;
};

/// Leaves must tile the references without gap or overlap.
std::string checkTiling(const Walk& walk) {
  size_t next = 0;
  for (size_t i = 0; i < walk.leaf_at.size(); ++i) {
    if ((walk.leaf_at[i].count != 0) != (i == next)) {
      return "reference " + std::to_string(i) + " is in no leaf or in two";
    }
    if (i == next) next += walk.leaf_at[i].count;
  }
  return "";
}

std::string checkSameLeaves(const Walk& two, const Walk& eight) {
  for (size_t i = 0; i < two.leaf_at.size(); ++i) {
    if (two.leaf_at[i].count != eight.leaf_at[i].count ||
        (two.leaf_at[i].count && !equal(two.leaf_at[i].box, eight.leaf_at[i].box))) {
      return "the leaf at reference " + std::to_string(i) + " differs between nodes2 and nodes8";
    }
  }
  return equal(two.root, eight.root) ? "" : "the roots of nodes2 and nodes8 have different boxes";
}

std::string checkTotals(const Bvh& bvh, const Walk& walk) {
  if (walk.depth != bvh.depth) return "depth is " + std::to_string(walk.depth) + ", not as stated";
  if (walk.depth > kMaxDepth) return "depth is above kMaxDepth";
  if (!equal(walk.root, {bvh.low, bvh.high})) return "low and high differ from the root's box";
  const double area = halfArea(walk.root);
  const double cost = area > 0 ? walk.cost / area : 0;
  if (!(std::fabs(cost - bvh.sah_cost) <= 1e-3 * cost)) return "sah_cost is not the tree's";
  return "";
}

std::string checkTriangles(const Bvh& bvh, const Walk& walk, std::span<const glm::vec3> positions,
                           std::span<const glm::uvec3> triangles) {
  CoverageCheck check(positions, triangles);
  for (size_t first = 0; first < bvh.references.size(); first += walk.leaf_at[first].count) {
    for (uint32_t i = 0; i < walk.leaf_at[first].count; ++i) {
      const uint32_t id = bvh.references[first + i];
      if (id >= triangles.size()) {
        return "reference " + std::to_string(first + i) + " is no triangle: " + std::to_string(id);
      }
      for (uint32_t j = 0; j < i; ++j) {
        if (bvh.references[first + j] == id) {
          return "the leaf at reference " + std::to_string(first) + " holds triangle " + std::to_string(id) +
                 " twice";
        }
      }
      check.add(id, walk.leaf_at[first].box);
    }
  }
  return check.finish();
}

}  // namespace

std::string validate(const Bvh& bvh, std::span<const glm::vec3> positions,
                     std::span<const glm::uvec3> triangles) {
  Walker<BvhNode2> two("nodes2", bvh.nodes2, bvh.references.size());
  if (std::string e = two.run(); !e.empty()) return e;
  Walker<BvhNode8> eight("nodes8", bvh.nodes8, bvh.references.size());
  if (std::string e = eight.run(); !e.empty()) return e;
  if (std::string e = checkTiling(two.result()); !e.empty()) return e;
  if (std::string e = checkSameLeaves(two.result(), eight.result()); !e.empty()) return e;
  if (std::string e = checkTotals(bvh, two.result()); !e.empty()) return e;
  return checkTriangles(bvh, two.result(), positions, triangles);
}

}  // namespace sightline
