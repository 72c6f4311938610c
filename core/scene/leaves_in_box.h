#pragma once
#include <vector>

#include "bvh/bvh.h"

namespace sightline {

/// Calls visit(id) for the triangles of all leaves whose box has a point in common with the closed box from
/// low to high, until it returns true: then the result is true. Triangles with a part in the box are among
/// them, others may be; with spatial splits a triangle may come several times.
template <typename Visit>
bool anyInLeaves(const Bvh& bvh, const glm::dvec3& low, const glm::dvec3& high, Visit&& visit) {
  const auto apart = [](const glm::vec4& range, int child, double from, double to) {
    return range[2 * child] > to || range[2 * child + 1] < from;
  };
  std::vector<uint32_t> stack{0};
  while (!stack.empty()) {
    const BvhNode2& node = bvh.nodes2[stack.back()];
    stack.pop_back();
    for (int child = 0; child < 2; ++child) {
      if (apart(node.x, child, low.x, high.x) || apart(node.y, child, low.y, high.y) ||
          apart(node.z, child, low.z, high.z)) {
        continue;
      }
      if (node.count[child] == 0) {
        stack.push_back(node.child[child]);
        continue;
      }
      for (uint32_t i = 0; i < node.count[child]; ++i) {
        if (visit(bvh.references[node.child[child] + i])) return true;
      }
    }
  }
  return false;
}

}  // namespace sightline
