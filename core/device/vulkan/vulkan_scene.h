#pragma once
#include "core/device/vulkan/vulkan_runner.h"
#include "core/scene/scene.h"
#include "core/vulkan/vulkan_tree.h"

namespace sightline {

/// A scene on a Vulkan device: corners in leaf order, the maps between leaves and ids, and the driver's trees
/// over them.
struct VulkanScene {
  VulkanBuffer corners, leaf_ids, leaf_of, part_starts, part_ids, part_places;
  VulkanBuffer instances;  ///< without memory in plain scenes
  uint32_t instance_count = 0;
  VulkanBuffer surfaces;  ///< without memory where all triangles are opaque from both sides
  VulkanTree tree;

  /// Puts the addresses into the runner's launch.
  void describe(VulkanRunner& runner) const;
};

/// Uploads in pieces, so that the host needs little memory besides scene and tree, and builds the trees.
/// part_limit: triangles of a bottom-level structure at most, 0: as many as the device takes. Throws Error.
VulkanScene uploadVulkanScene(const VulkanContext& context, const Scene& scene, const Bvh& bvh,
                              uint32_t part_limit);

}  // namespace sightline
