#pragma once
#include <string>

#include "core/vulkan/vulkan_context.h"

namespace sightline {

/// What drawing takes: a queue with graphics and compute shaders, and what VulkanFeature names; no ray
/// tracing. What only some methods take is welcome.
VulkanNeeds drawingNeeds();

/// Methods that choose on the GPU what is drawn.
enum class GpuMethod {
  hiz,          ///< drawables against a pyramid of depth, in two passes
  hizMeshlets,  ///< meshlets likewise
  boxes,        ///< drawables by drawn boxes that leave flags, in two passes
};

/// Why a device cannot run the method, in one line; empty: it can.
std::string whyNotMethod(const VulkanAbilities& abilities, GpuMethod method);

}  // namespace sightline
