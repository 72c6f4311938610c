#include "core/draw/vulkan/depth_pyramid.h"

#include "core/shared/pyramid.h"

namespace sightline {
namespace {

// Of vk_shaders/pyramid.comp.
constexpr uint32_t kLevelsAtOnce = 6, kTexelsOfGroup = 64;

}  // namespace

void recordPyramid(VulkanDrawing& drawing, VkCommandBuffer commands, VkDeviceAddress pyramid, uint32_t width,
                   uint32_t height, bool floor_levels) {
  for (uint32_t level = 0; level + 1 < pyramidLevels(width, height); level += kLevelsAtOnce) {
    const DrawPush push{pyramid, 0, {width, height, level, floor_levels ? 1u : 0u}};
    drawing.programs().run(commands, "pyramid.comp", push,
                           (levelSize(width, level) + kTexelsOfGroup - 1) / kTexelsOfGroup,
                           (levelSize(height, level) + kTexelsOfGroup - 1) / kTexelsOfGroup);
    drawing.barrier(commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT,
                    VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
                    VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT);
  }
}

}  // namespace sightline
