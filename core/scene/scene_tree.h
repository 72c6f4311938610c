#pragma once
#include "bvh/bvh.h"
#include "core/scene/scene.h"

namespace sightline {

/// The tree over a scene: what tracers and all that look for triangles near a place take. Throws as buildBvh.
Bvh buildSceneTree(const Scene& scene, const BvhConfig& config = {});

}  // namespace sightline
