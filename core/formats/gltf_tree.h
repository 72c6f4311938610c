#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/formats/gltf_data.h"
#include "core/formats/gltf_document.h"

namespace sightline {

/// A mesh with its place in the world.
struct GltfInstance {
  size_t node = 0;
  size_t mesh = 0;
  glm::dmat4 to_world{1.0};      ///< not looked at for a skin
  std::optional<uint64_t> copy;  ///< which of the node's, where EXT_mesh_gpu_instancing makes several
};

/// What the nodes of a document amount to.
struct GltfTree {
  std::vector<GltfInstance> instances;  ///< visible meshes of the scene, parents before children
  /// Of every node, also those outside of the scene: joints may stand there. None for a node that is its own
  /// ancestor.
  std::vector<std::optional<glm::dmat4>> to_world;
  glm::dmat4 world{1.0};       ///< parent of the roots, as the options have it
  uint64_t hidden_nodes = 0;   ///< of the scene: invisible, or below an invisible one
  uint64_t coarser_nodes = 0;  ///< left out: they stand for another from farther away (MSFT_lod)
  std::vector<std::string> warnings;
};

struct GltfTreeOptions {
  glm::dmat4 world{1.0};  ///< parent of the roots
  bool repair = false;    ///< leave out instances that are not finite, with a warning
  /// Told before so many instances of EXT_mesh_gpu_instancing are made; may throw, where that is too many.
  std::function<void(uint64_t)> instances = [](uint64_t) {};
};

/// Throws Error if the scene's tree reaches a node twice, and for bad instances.
GltfTree readTree(const GltfDocument& document, GltfData& data, const std::string& file,
                  const GltfTreeOptions& options);

}  // namespace sightline
