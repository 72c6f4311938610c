#pragma once
#include "core/draw/vulkan/vulkan_drawing.h"

namespace sightline {

/// Records the making of all levels of a pyramid (core/shared/pyramid.h) but the first, which is there:
/// written before a barrier to compute shaders. They are ready for shaders. Six levels a dispatch.
/// floor_levels: a fault for tests, which drops odd columns and rows.
void recordPyramid(VulkanDrawing& drawing, VkCommandBuffer commands, VkDeviceAddress pyramid, uint32_t width,
                   uint32_t height, bool floor_levels = false);

}  // namespace sightline
