#pragma once
#include <string>

#include "core/scene/surfaces.h"
#include "core/vulkan/vulkan_stage.h"

namespace sightline {

/// What our shaders (vk_shaders) need to trace and bake, and what they draw hemicubes with where it is there.
/// ray_queries: take them even where there are ray tracing pipelines.
VulkanNeeds tracingNeeds(bool ray_queries);

/// Whether tracing stages are ray tracing pipelines on this context of tracingNeeds.
bool usesPipelines(const VulkanContext& context);

/// DeviceInfo::layout of either kind.
const char* vulkanLayout(bool pipelines);

/// A tracing stage (trace_random, ...) of the context's kind, for scenes with these surfaces. group_size: of
/// ray queries.
VulkanStage tracingStage(const VulkanContext& context, const std::string& name, uint32_t group_size,
                         const SurfaceFeatures& features = {});

/// Why a context cannot draw hemicubes, in one line; empty: it can.
std::string whyNoHemicubes(const VulkanContext& context);

}  // namespace sightline
