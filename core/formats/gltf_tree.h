#pragma once
#include <optional>
#include <string>
#include <vector>

#include "core/formats/gltf_document.h"

namespace sightline {

/// A mesh with its place in the world.
struct GltfInstance {
  size_t node = 0;
  size_t mesh = 0;
};

/// What the nodes of a document amount to.
struct GltfTree {
  std::vector<GltfInstance> instances;  ///< visible meshes of the scene, parents before children
  /// Of every node, also those outside of the scene: joints may stand there. None for a node that is its own
  /// ancestor.
  std::vector<std::optional<glm::dmat4>> to_world;
  uint64_t hidden_nodes = 0;  ///< of the scene: invisible, or below an invisible one
};

/// Throws Error if the scene's tree reaches a node twice.
GltfTree readTree(const GltfDocument& document, const std::string& file);

}  // namespace sightline
