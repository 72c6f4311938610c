#include "core/draw/vulkan/drawing_needs.h"

#include "vk_shaders/shaders.h"

namespace sightline {

VulkanNeeds drawingNeeds() {
  using enum VulkanFeature;
  VulkanNeeds needs;
  needs.shaders = shaderCode;
  needs.features = {kAddresses, kScalarLayout, kInt64, kFloat64, kMultiDraw, kFirstInstance, kQueryReset};
  needs.welcome = {kDrawCount, kFragmentStores, kIndependentBlend, kMeshShaders};
  needs.none =
      "no Vulkan device found: install a GPU's driver, or mesa-vulkan-drivers 25 or later for the processor";
  needs.queue = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
  needs.sub_pixel_bits = 8;  // of BoxGuard and core/shared/guarded_box.h
  needs.group_size = 256;    // of vk_shaders
  return needs;
}

std::string whyNotMethod(const VulkanAbilities& abilities, GpuMethod method) {
  std::string why = whyLacks(abilities, VulkanFeature::kDrawCount);
  if (why.empty() && method == GpuMethod::boxes) why = whyLacks(abilities, VulkanFeature::kFragmentStores);
  return why;
}

}  // namespace sightline
