#pragma once
#include <algorithm>
#include <vector>

#include "bvh/bvh.h"

namespace sightline {

/// A closed box.
struct SearchBox {
  glm::dvec3 low, high;
};

/// Calls visit(place) for the places, in the leaves below a node, whose leaf's box has a point in common with
/// the box, until it returns true: then the result is true.
template <typename Visit>
bool anyLeafBelow(const Bvh& bvh, uint32_t root, const SearchBox& box, Visit&& visit) {
  const auto apart = [](const glm::vec4& range, int child, double from, double to) {
    return range[2 * child] > to || range[2 * child + 1] < from;
  };
  std::vector<uint32_t> stack{root};
  while (!stack.empty()) {
    const BvhNode2& node = bvh.nodes2[stack.back()];
    stack.pop_back();
    for (int child = 0; child < 2; ++child) {
      if (apart(node.x, child, box.low.x, box.high.x) || apart(node.y, child, box.low.y, box.high.y) ||
          apart(node.z, child, box.low.z, box.high.z)) {
        continue;
      }
      if (node.count[child] == 0) {
        stack.push_back(node.child[child]);
        continue;
      }
      for (uint32_t i = 0; i < node.count[child]; ++i) {
        if (visit(node.child[child] + i)) return true;
      }
    }
  }
  return false;
}

/// The box in the instance's space, grown by what placeVertex rounds (padding of core/shared/placement.h
/// covers that twice) and by the rounding of the inverse.
inline SearchBox localBox(const InstanceRecord& instance, const SearchBox& box) {
  const glm::dvec3 origin(instance.place.origin);
  const glm::dvec3 middle = (box.low + box.high) * 0.5 - origin, half = (box.high - box.low) * 0.5;
  const vec4 rows[3] = {instance.local_x, instance.local_y, instance.local_z};
  SearchBox local;
  for (int axis = 0; axis < 3; ++axis) {
    const glm::dvec3 row(rows[axis]);
    const glm::dvec3 size = glm::abs(middle) + half;
    const double reach = glm::dot(glm::abs(row), half) + double(instance.padding[axis]) +
                         double(rows[axis].w) * 0x1p-22 * std::max({size.x, size.y, size.z});
    const double at = glm::dot(row, middle);
    local.low[axis] = at - reach;
    local.high[axis] = at + reach;
  }
  return local;
}

/// Calls visit(id) for the triangles of all leaves whose box has a point in common with the closed box from
/// low to high, until it returns true: then the result is true. Triangles with a part in the box are among
/// them, others may be; with spatial splits a triangle may come several times.
template <typename Visit>
bool anyInLeaves(const Bvh& bvh, const glm::dvec3& low, const glm::dvec3& high, Visit&& visit) {
  const SearchBox box{low, high};
  if (!bvh.hasInstances()) {
    return anyLeafBelow(bvh, 0, box, [&](uint32_t place) { return visit(bvh.references[place]); });
  }
  return anyLeafBelow(bvh, bvh.top2, box, [&](uint32_t place) {
    const uint32_t number = bvh.instance_order[place];
    const InstanceRecord& instance = bvh.instances[number];
    const bool in_place = (instance.roots.z & kInstanceInPlace) != 0;
    return anyLeafBelow(
        bvh, instance.roots.x, in_place ? box : localBox(instance, box),
        [&](uint32_t reference) { return visit(bvh.idOf(instance, bvh.references[reference])); });
  });
}

}  // namespace sightline
