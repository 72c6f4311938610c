#pragma once
#include <algorithm>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

#include "core/shared/bvh_node.h"
#include "core/shared/placement.h"

namespace sightline {

/// No tree has more inner nodes on a path of nodes2 than this, whatever the input: a traversal that keeps
/// one entry a level needs a stack of kMaxDepth entries for nodes2 and of 7 * kMaxDepth for nodes8.
inline constexpr uint32_t kMaxDepth = SL_MAX_DEPTH;

/// How to build. The defaults suit triangle soups from 1 to 20 million triangles. Values out of range count
/// as the nearest one in range.
struct BvhConfig {
  uint32_t max_leaf_size = 4;   ///< references in a leaf, 1..8
  bool spatial_splits = false;  ///< Stich et al. 2009: fewer box tests, more references, slower to build
  float split_budget = 0.3f;    ///< additional references that spatial splits may make, as a share, 0..1
  int threads = 0;              ///< 0: all cores. The tree does not depend on it.
};

/// The child of an empty slot.
inline constexpr uint32_t kNoChild = 0xffffffffu;

static_assert(sizeof(BvhNode2) == 64);

/// Eight children a node, bounds as structure of arrays: for single rays on SIMD CPUs. 256 bytes.
struct BvhNode8 {
  float low_x[8], high_x[8], low_y[8], high_y[8], low_z[8], high_z[8];  ///< empty slot: low > high
  uint32_t child[8];                                                    ///< as in BvhNode2
  uint32_t count[8];  ///< as in BvhNode2; an empty slot has count 0 and child 0xffffffff
};
static_assert(sizeof(BvhNode8) == 256);

/// A bounding volume hierarchy over triangles. Every node's box contains the boxes of what is below it, and a
/// leaf's box contains its triangles; conservative rounding is the traversal's task (core/shared/box.h). With
/// spatial splits a triangle may lie in several leaves, and their boxes together contain it: each holds the
/// part between the leaf's planes, rounded outwards by up to 2^-20 of its largest coordinate.
/// Empty slots have low = infinity, high = -infinity and come after the used ones.
///
/// A tree of two levels (of a scene with instances, core/scene/scene_tree.h) has a tree a mesh, in the mesh's
/// space, and one over the instances' boxes, in one set of arrays. The upper tree's leaves hold one place of
/// instance_order each.
struct Bvh {
  std::vector<BvhNode2> nodes2;  ///< root at top2, depth first; a scene of one leaf has child[1] empty
  std::vector<BvhNode8> nodes8;  ///< the same tree collapsed, root at top8, depth first; same leaves
  std::vector<uint32_t>
      references;  ///< triangles (of plain scenes: ids) in leaf order; one may occur several times
  std::vector<InstanceRecord> instances;  ///< by id, last the plain triangles, if any; empty: one level
  std::vector<uint32_t> instance_order;   ///< indices of instances in leaf order
  uint32_t top2 = 0, top8 = 0;            ///< roots; 0 with one level
  glm::vec3 low{0}, high{0};              ///< bounds of everything
  double sah_cost = 0;  ///< surface area heuristic: node cost 1, triangle cost 1; 0 if the root has no area
  uint32_t depth = 0;   ///< inner nodes on the longest path of nodes2; of two levels the deeper one
  double build_seconds = 0;

  bool hasInstances() const { return !instances.empty(); }

  /// The id of a triangle of an instance by what stands in references.
  uint32_t idOf(const InstanceRecord& instance, uint32_t reference) const {
    if ((instance.roots.z & kInstanceInPlace) != 0) return plainId(reference);
    return instance.ids.x + (reference - instance.ids.w);
  }

  /// The id of a triangle in no mesh by its index: those of the instances before it come first.
  uint32_t plainId(uint32_t index) const {
    const auto after =
        std::upper_bound(instances.begin(), instances.end() - 1, index,
                         [](uint32_t value, const InstanceRecord& i) { return value < i.ids.z; });
    if (after == instances.begin()) return index;
    const uvec4& ids = (after - 1)->ids;
    return index - ids.z + ids.x + ids.y;
  }
};

/// Builds the tree; the same input gives the same bytes for any number of threads.
/// Positions must be finite, indices in range. Peak memory is 64 bytes a reference besides the result and
/// the scene. Throws std::invalid_argument for no triangles, std::length_error for 2^32 - 2^14 or more, and
/// std::bad_alloc.
Bvh buildBvh(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles,
             const BvhConfig& config = {});

/// Checks every invariant, trusting no index in the tree, and returns the first complaint; empty: valid.
/// Boxes contain their children; the leaves' boxes cover each triangle, and none is missing; leaves have 1 to
/// 8 different references and tile them all; both layouts hold the same leaves; no node is unreachable or
/// reached twice; empty slots are marked as such; bounds, depth (at most kMaxDepth) and SAH cost are right.
std::string validate(const Bvh& bvh, std::span<const glm::vec3> positions,
                     std::span<const glm::uvec3> triangles);

}  // namespace sightline
