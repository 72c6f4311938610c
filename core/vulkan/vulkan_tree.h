#pragma once
#include "core/trace/leaf_parts.h"
#include "core/vulkan/vulkan_commands.h"

namespace sightline {

/// An acceleration structure and its memory.
struct VulkanStructure {
  VulkanBuffer memory;
  VulkanHandle<VkAccelerationStructureKHR> handle;
  VkDeviceAddress address = 0;
};

/// A part in a place.
struct PlacedPart {
  uint32_t part = 0;
  VkTransformMatrixKHR place = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
};

/// Most placed parts: their numbers have 24 bits.
inline constexpr uint64_t kMostPlacedParts = 1u << 24;

/// The driver's acceleration structures over a scene: one bottom level a part, compacted, and one instance of
/// each placed part in the top level, whose custom index is its number.
struct VulkanTree {
  std::vector<VulkanStructure> parts;
  VulkanStructure top;
  VulkanBuffer instances;
  uint64_t bytes = 0;  ///< of all structures, after compaction
  double build_seconds = 0;
};

/// Triangles that a bottom-level structure may have: the device's limit, or fewer where the structure over as
/// many as `triangles` would not fit one allocation.
uint32_t largestPart(const VulkanContext& context, uint32_t triangles);

/// corners: nine floats a triangle, in leaf order; must be on the device. placed: at least one,
/// kMostPlacedParts at most.
VulkanTree buildVulkanTree(const VulkanContext& context, const VulkanBuffer& corners,
                           const std::vector<LeafPart>& parts, const std::vector<PlacedPart>& placed);

}  // namespace sightline
