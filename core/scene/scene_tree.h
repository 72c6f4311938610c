#pragma once
#include "bvh/bvh.h"
#include "core/scene/scene.h"

namespace sightline {

/// The tree over a scene: what tracers and all that look for triangles near a place take. Of two levels where
/// the scene has instances: time and memory follow the triangles that are stored, and the number of
/// instances. references are then indices of Scene::triangles. Throws as buildBvh.
Bvh buildSceneTree(const Scene& scene, const BvhConfig& config = {});

}  // namespace sightline
