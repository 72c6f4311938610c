#include "core/scene/scene_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/scene/instance_record.h"

namespace sightline {
namespace {

/// A mesh's tree goes into the top level by so many boxes of its upper nodes at most: placed boxes of turned
/// meshes are tighter the smaller they are.
constexpr size_t kBoxesOfMesh = 64;

/// Where a mesh's tree lies in the whole.
struct MeshTree {
  uint32_t root2 = 0, root8 = 0;
  Bounds bounds;              ///< in its own space
  std::vector<Bounds> boxes;  ///< of upper nodes: they cover all
};

Bounds childBox(const BvhNode2& node, int child) {
  return {{node.x[2 * child], node.y[2 * child], node.z[2 * child]},
          {node.x[2 * child + 1], node.y[2 * child + 1], node.z[2 * child + 1]}};
}

/// Breadth first: the boxes of a cut through the upper nodes.
std::vector<Bounds> upperBoxes(const Bvh& tree) {
  struct Open {
    Bounds box;
    uint32_t node;  ///< kNoChild: a leaf
  };
  std::vector<Open> cut{{{tree.low, tree.high}, 0}};
  size_t leaves = 0;  // at the front of the cut
  while (leaves < cut.size() && cut.size() < kBoxesOfMesh) {
    const Open open = cut[leaves];
    if (open.node == kNoChild) {
      ++leaves;
      continue;
    }
    cut.erase(cut.begin() + std::ptrdiff_t(leaves));
    const BvhNode2& node = tree.nodes2[open.node];
    for (int child = 0; child < 2; ++child) {
      if (node.child[child] == kNoChild) continue;
      cut.push_back({childBox(node, child), node.count[child] > 0 ? kNoChild : node.child[child]});
    }
  }
  std::vector<Bounds> boxes;
  for (const Open& open : cut) boxes.push_back(open.box);
  return boxes;
}

float roundedDown(double value) {
  const auto nearest = static_cast<float>(value);
  return nearest > value ? std::nextafter(nearest, -std::numeric_limits<float>::infinity()) : nearest;
}

/// Holds what placeVertex makes of every vertex in the boxes: in double, grown by its rounding.
Bounds placedBounds(const Placement& place, const MeshTree& mesh) {
  const glm::dmat3 linear = linearPart(place);
  const glm::dmat3 sizes(glm::abs(linear[0]), glm::abs(linear[1]), glm::abs(linear[2]));
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  glm::dvec3 low(kInfinity), high(-kInfinity);
  for (const Bounds& box : mesh.boxes) {
    const glm::dvec3 middle = linear * ((glm::dvec3(box.low) + glm::dvec3(box.high)) * 0.5);
    const glm::dvec3 half = sizes * ((glm::dvec3(box.high) - glm::dvec3(box.low)) * 0.5);
    low = glm::min(low, middle - half);
    high = glm::max(high, middle + half);
  }
  const glm::dvec3 origin(place.origin);
  const double rounding = 0x1p-24 * 5 * largestSum(place, mesh.bounds);
  low = low + origin - rounding;
  high = high + origin + rounding;
  return {{roundedDown(low.x), roundedDown(low.y), roundedDown(low.z)},
          {-roundedDown(-high.x), -roundedDown(-high.y), -roundedDown(-high.z)}};
}

/// Puts the trees of parts of a scene into one.
class TreeOfTrees {
 public:
  TreeOfTrees(const Scene& scene, const BvhConfig& config) : scene_(scene), config_(config) {}

  Bvh build() {
    std::vector<MeshTree> meshes;
    for (const SceneMesh& mesh : scene_.meshes)
      meshes.push_back(add(mesh.first_triangle, mesh.triangle_count));
    const MeshTree plain = scene_.plainTriangles() > 0 ? add(0, scene_.plainTriangles()) : MeshTree();
    std::vector<Bounds> boxes;
    for (const SceneInstance& instance : scene_.instances) {
      const SceneMesh& mesh = scene_.meshes[instance.mesh];
      const MeshTree& tree = meshes[instance.mesh];
      InstanceRecord record = recordOf(instance.place, tree.bounds);
      record.ids = {instance.first_id, mesh.triangle_count, instance.plain_before, mesh.first_triangle};
      record.roots = {tree.root2, tree.root8, instance.mirrors ? kInstanceMirrors : 0, 0};
      result_.instances.push_back(record);
      boxes.push_back(placedBounds(instance.place, tree));
    }
    if (scene_.plainTriangles() > 0) {
      InstanceRecord record{};
      record.roots = {plain.root2, plain.root8, kInstanceInPlace, 0};
      result_.instances.push_back(record);
      boxes.push_back(plain.bounds);
    }
    addTop(boxes);
    return std::move(result_);
  }

 private:
  /// Behind the tree of the top level, for which addTop makes room.
  MeshTree add(uint32_t first, uint32_t count) {
    const Bvh tree = buildBvh(scene_.positions, std::span(scene_.triangles).subspan(first, count), config_);
    MeshTree placed{uint32_t(result_.nodes2.size()),
                    uint32_t(result_.nodes8.size()),
                    {tree.low, tree.high},
                    upperBoxes(tree)};
    append(tree, uint32_t(result_.references.size()));
    for (const uint32_t reference : tree.references) result_.references.push_back(first + reference);
    return placed;
  }

  void append(const Bvh& tree, uint32_t first_reference) {
    const auto shift = [&](const auto& from, auto& to, int width) {
      const auto first = static_cast<uint32_t>(to.size());
      to.insert(to.end(), from.begin(), from.end());
      for (size_t i = first; i < to.size(); ++i) {
        for (int child = 0; child < width; ++child) {
          if (to[i].count[child] > 0) {
            to[i].child[child] += first_reference;
          } else if (to[i].child[child] != kNoChild) {
            to[i].child[child] += first;
          }
        }
      }
    };
    shift(tree.nodes2, result_.nodes2, 2);
    shift(tree.nodes8, result_.nodes8, 8);
    result_.depth = std::max(result_.depth, tree.depth);
    result_.build_seconds += tree.build_seconds;
  }

  /// A tree over boxes: over triangles with these boxes.
  void addTop(const std::vector<Bounds>& boxes) {
    std::vector<glm::vec3> positions;
    std::vector<glm::uvec3> triangles;
    for (const Bounds& box : boxes) {
      const auto first = static_cast<uint32_t>(positions.size());
      positions.insert(positions.end(), {box.low, box.high});
      triangles.emplace_back(first, first + 1, first);
    }
    const Bvh top = buildBvh(positions, triangles, {.max_leaf_size = 1, .threads = config_.threads});
    result_.top2 = uint32_t(result_.nodes2.size());
    result_.top8 = uint32_t(result_.nodes8.size());
    append(top, 0);
    result_.instance_order = top.references;
    result_.low = top.low;
    result_.high = top.high;
    result_.sah_cost = top.sah_cost;
  }

  const Scene& scene_;
  const BvhConfig& config_;
  Bvh result_;
};

}  // namespace

Bvh buildSceneTree(const Scene& scene, const BvhConfig& config) {
  if (!scene.hasInstances()) return buildBvh(scene.positions, scene.triangles, config);
  return TreeOfTrees(scene, config).build();
}

}  // namespace sightline
