#pragma once
#include <cstdint>

#include "bvh/bvh.h"
#include "core/judge/judge_ray.h"

namespace sightline {

/// Finds the triangles that a ray may meet: a walk through the tree in double with grown boxes, written apart
/// from the devices' own so that it shares no mistake with them.
///
/// Boxes grow by 2^-22 of the scene's and the origin's reach. That covers, with a factor of 2^28, the
/// rounding of a slab's distance in double (4 * 2^-53 of it), and the 2^-20 of a coordinate by which leaves
/// of spatial splits are rounded outwards need no cover.
///
/// With instances, the ray goes into the mesh's space by the placement's inverse in double, and the boxes
/// grow by as much as that stretches the growth, and by what placed vertices round (InstanceRecord::padding).
class CandidateWalk {
 public:
  /// bvh must outlive it.
  explicit CandidateWalk(const Bvh& bvh);

  /// Calls visit(triangle) for each triangle in a leaf whose box the ray meets at a distance of no more than
  /// limit(), nearer boxes first by and by; limit may shrink. A triangle may come several times. padding:
  /// added to that of the class, world units.
  template <typename Visit, typename Limit>
  void walk(const JudgeRay& ray, double padding, Visit&& visit, Limit&& limit) const;

 private:
  struct Slabs {
    double low_shift[3];  ///< added to a plane to get its place relative to the origin
    double high_shift[3];
    double inverse[3];
  };
  struct Ranges {
    double near[8], far[8];
  };
  double growth(const JudgeRay& ray, double padding) const;
  static Slabs slabs(const JudgeRay& ray, const glm::dvec3& growth);
  static Slabs slabsIn(const InstanceRecord& instance, const JudgeRay& ray, double growth);
  static void meet(const BvhNode8& node, const Slabs& slabs, Ranges& ranges);

  /// Calls leaf(first, count) for the leaves below a node of nodes8.
  template <typename Leaf, typename Limit>
  void walkBelow(uint32_t root, const Slabs& ray_slabs, Leaf&& leaf, Limit&& limit) const;

  const Bvh& bvh_;
  double reach_;
};

template <typename Visit, typename Limit>
void CandidateWalk::walk(const JudgeRay& ray, double padding, Visit&& visit, Limit&& limit) const {
  const double grown = growth(ray, padding);
  const Slabs world = slabs(ray, glm::dvec3(grown));
  if (!bvh_.hasInstances()) {
    const auto leaf = [&](uint32_t first, uint32_t count) {
      for (uint32_t i = first; i < first + count; ++i) visit(bvh_.references[i]);
    };
    return walkBelow(0, world, leaf, limit);
  }
  const auto enter = [&](uint32_t place, uint32_t) {
    const InstanceRecord& instance = bvh_.instances[bvh_.instance_order[place]];
    const bool in_place = (instance.roots.z & kInstanceInPlace) != 0;
    const auto leaf = [&](uint32_t first, uint32_t count) {
      for (uint32_t i = first; i < first + count; ++i) visit(bvh_.idOf(instance, bvh_.references[i]));
    };
    walkBelow(instance.roots.y, in_place ? world : slabsIn(instance, ray, grown), leaf, limit);
  };
  walkBelow(bvh_.top8, world, enter, limit);
}

template <typename Leaf, typename Limit>
void CandidateWalk::walkBelow(uint32_t root, const Slabs& ray_slabs, Leaf&& leaf, Limit&& limit) const {
  struct Entry {
    uint32_t child, count;
    double near;
  };
  Entry stack[7 * kMaxDepth + 8];
  uint32_t size = 0;
  stack[size++] = {root, 0, 0};
  while (size > 0) {
    const Entry entry = stack[--size];
    if (entry.near > limit()) continue;
    if (entry.count > 0) {
      leaf(entry.child, entry.count);
      continue;
    }
    const BvhNode8& node = bvh_.nodes8[entry.child];
    Ranges ranges;
    meet(node, ray_slabs, ranges);
    const uint32_t bottom = size;
    for (int i = 0; i < 8; ++i) {
      if (!(ranges.near[i] <= ranges.far[i])) continue;
      uint32_t place = size++;  // the farthest deepest in the stack
      for (; place > bottom && stack[place - 1].near < ranges.near[i]; --place)
        stack[place] = stack[place - 1];
      stack[place] = {node.child[i], node.count[i], ranges.near[i]};
    }
  }
}

}  // namespace sightline
