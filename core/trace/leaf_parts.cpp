#include "core/trace/leaf_parts.h"

#include <algorithm>

namespace sightline {
namespace {

/// First and one past the last reference below a child.
struct ReferenceRange {
  uint32_t begin, end;
};

/// Leaves follow each other in depth-first order, so the outermost ones bound a subtree's references.
ReferenceRange referencesBelow(const Bvh& bvh, uint32_t node) {
  uint32_t left = node, right = node;
  while (bvh.nodes2[left].count[0] == 0) left = bvh.nodes2[left].child[0];
  const auto last = [&](uint32_t n) { return bvh.nodes2[n].child[1] == kNoChild ? 0 : 1; };
  while (bvh.nodes2[right].count[last(right)] == 0) right = bvh.nodes2[right].child[last(right)];
  const BvhNode2& end = bvh.nodes2[right];
  return {bvh.nodes2[left].child[0], end.child[last(right)] + end.count[last(right)]};
}

/// Ranges of at most `limit` references below a node, in order. Recursion is as deep as the tree.
void cutBelow(const Bvh& bvh, uint32_t node, uint32_t limit, std::vector<ReferenceRange>& ranges) {
  const ReferenceRange all = referencesBelow(bvh, node);
  if (all.end - all.begin <= limit) {
    ranges.push_back(all);
    return;
  }
  for (int i = 0; i < 2; ++i) {
    const uint32_t child = bvh.nodes2[node].child[i], count = bvh.nodes2[node].count[i];
    if (count > 0) {
      ranges.push_back({child, child + count});
    } else if (child != kNoChild) {
      cutBelow(bvh, child, limit, ranges);
    }
  }
}

}  // namespace

LeafParts splitIntoParts(const Bvh& bvh, uint32_t triangle_count, uint32_t limit) {
  std::vector<uint32_t> roots{0};
  if (bvh.hasInstances()) {
    roots.clear();
    for (const InstanceRecord& instance : bvh.instances) roots.push_back(instance.roots.x);
    std::ranges::sort(roots);
    roots.erase(std::unique(roots.begin(), roots.end()), roots.end());
  }
  LeafParts result;
  result.ids.reserve(triangle_count);
  std::vector<bool> seen(triangle_count, false);
  for (const uint32_t root : roots) {
    std::vector<ReferenceRange> ranges;
    cutBelow(bvh, root, std::max(limit, 8u), ranges);
    for (const ReferenceRange& range : ranges) {
      const auto first = static_cast<uint32_t>(result.ids.size());
      for (uint32_t i = range.begin; i < range.end; ++i) {
        const uint32_t id = bvh.references[i];
        if (!seen[id]) result.ids.push_back(id);
        seen[id] = true;
      }
      const auto count = static_cast<uint32_t>(result.ids.size()) - first;
      if (count > 0) result.parts.push_back({first, count, true, root});
    }
  }
  return result;
}

LeafParts splitBySurface(const LeafParts& parts, const Surfaces& surfaces) {
  LeafParts result = parts;
  if (surfaces.empty()) return result;
  result.parts.clear();
  for (const LeafPart& part : parts.parts) {
    const auto begin = result.ids.begin() + part.first, end = begin + part.count;
    const auto middle = std::stable_partition(begin, end, [&](uint32_t id) { return surfaces.of(id) == 0; });
    const auto opaque = uint32_t(middle - begin);
    if (opaque > 0) result.parts.push_back({part.first, opaque, true, part.root});
    if (opaque < part.count)
      result.parts.push_back({part.first + opaque, part.count - opaque, false, part.root});
  }
  return result;
}

}  // namespace sightline
