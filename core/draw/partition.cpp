#include <array>

#include "bvh/bvh.h"
#include "core/draw/drawables.h"

namespace sightline {

namespace {

AlphaKind alphaOf(const Scene& scene, uint32_t id) {
  if (scene.surfaces.empty()) return AlphaKind::opaque;
  const uint32_t word = scene.surfaceOf(id);
  if ((word & kSurfaceGlass) != 0) return AlphaKind::blended;
  return (word & kSurfaceMasked) != 0 ? AlphaKind::masked : AlphaKind::opaque;
}

class Partition {
 public:
  Partition(const Scene& scene, const PartitionOptions& options, Drawables& result)
      : scene_(scene), options_(options), result_(result) {}

  void addObject(uint32_t object) {
    const SceneObject& o = scene_.objects[object];
    std::array<std::vector<uint32_t>, 3> kinds;
    for (uint32_t i = 0; i < o.triangle_count; ++i) {
      kinds[size_t(alphaOf(scene_, o.first_triangle + i))].push_back(o.first_triangle + i);
    }
    for (const AlphaKind alpha : {AlphaKind::opaque, AlphaKind::masked, AlphaKind::blended}) {
      const std::vector<uint32_t>& ids = kinds[size_t(alpha)];
      if (ids.empty()) continue;
      if (options_.split == 0 || ids.size() <= options_.split) {
        addDrawable(object, alpha, ids);
      } else {
        cut(object, alpha, ids);
      }
    }
  }

 private:
  void addDrawable(uint32_t object, AlphaKind alpha, std::span<const uint32_t> ids) {
    Drawable d;
    d.first_triangle = static_cast<uint32_t>(result_.triangles.size());
    d.triangle_count = static_cast<uint32_t>(ids.size());
    d.object = object;
    d.alpha = alpha;
    d.box = {scene_.corners(ids[0])[0], scene_.corners(ids[0])[0]};
    for (const uint32_t id : ids) {
      for (const glm::vec3& corner : scene_.corners(id)) {
        d.box = {glm::min(d.box.low, corner), glm::max(d.box.high, corner)};
      }
    }
    result_.list.push_back(d);
    result_.triangles.insert(result_.triangles.end(), ids.begin(), ids.end());
  }

  void cut(uint32_t object, AlphaKind alpha, std::span<const uint32_t> ids) {
    std::vector<glm::vec3> positions;
    std::vector<glm::uvec3> triangles;
    positions.reserve(3 * ids.size());
    triangles.reserve(ids.size());
    for (const uint32_t id : ids) {
      const uint32_t first = static_cast<uint32_t>(positions.size());
      for (const glm::vec3& corner : scene_.corners(id)) positions.push_back(corner);
      triangles.emplace_back(first, first + 1, first + 2);
    }
    // Leaves of one triangle, so that every split can be kept to.
    const Bvh bvh = buildBvh(positions, triangles, {.max_leaf_size = 1, .threads = options_.threads});
    const Tree tree{bvh, sizesOf(bvh)};
    addSubtree(tree, bvh.top2, object, alpha, ids);
  }

  struct Tree {
    const Bvh& bvh;
    std::vector<uint32_t> sizes;  ///< triangles below each node of nodes2
  };

  static std::vector<uint32_t> sizesOf(const Bvh& bvh) {
    std::vector<uint32_t> sizes(bvh.nodes2.size());
    for (size_t n = sizes.size(); n-- > 0;) {  // depth first: children come after their parent
      const BvhNode2& node = bvh.nodes2[n];
      for (int i = 0; i < 2; ++i) {
        if (node.child[i] != kNoChild) sizes[n] += node.count[i] > 0 ? node.count[i] : sizes[node.child[i]];
      }
    }
    return sizes;
  }

  void addSubtree(const Tree& tree, uint32_t index, uint32_t object, AlphaKind alpha,
                  std::span<const uint32_t> ids) {
    if (tree.sizes[index] <= options_.split) {
      std::vector<uint32_t> part;
      collect(tree, index, ids, part);
      return addDrawable(object, alpha, part);
    }
    const BvhNode2& node = tree.bvh.nodes2[index];
    for (int i = 0; i < 2; ++i) {
      if (node.child[i] == kNoChild) continue;
      if (node.count[i] > 0) {
        const uint32_t id = ids[tree.bvh.references[node.child[i]]];
        addDrawable(object, alpha, {&id, 1});
      } else {
        addSubtree(tree, node.child[i], object, alpha, ids);
      }
    }
  }

  static void collect(const Tree& tree, uint32_t index, std::span<const uint32_t> ids,
                      std::vector<uint32_t>& part) {
    const BvhNode2& node = tree.bvh.nodes2[index];
    for (int i = 0; i < 2; ++i) {
      if (node.child[i] == kNoChild) continue;
      if (node.count[i] > 0) {
        part.push_back(ids[tree.bvh.references[node.child[i]]]);
      } else {
        collect(tree, node.child[i], ids, part);
      }
    }
  }

  const Scene& scene_;
  PartitionOptions options_;
  Drawables& result_;
};

}  // namespace

Drawables partitionScene(const Scene& scene, const PartitionOptions& options) {
  Drawables result;
  result.triangles.reserve(scene.triangleCount());
  Partition partition(scene, options, result);
  for (uint32_t object = 0; object < scene.objects.size(); ++object) partition.addObject(object);
  return result;
}

AxisBox boundsOf(const Drawables& drawables) {
  AxisBox bounds = drawables.list.front().box;
  for (const Drawable& d : drawables.list) {
    bounds = {glm::min(bounds.low, d.box.low), glm::max(bounds.high, d.box.high)};
  }
  return bounds;
}

}  // namespace sightline
