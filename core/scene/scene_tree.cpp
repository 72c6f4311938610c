#include "core/scene/scene_tree.h"

namespace sightline {

Bvh buildSceneTree(const Scene& scene, const BvhConfig& config) {
  return buildBvh(scene.positions, scene.triangles, config);
}

}  // namespace sightline
