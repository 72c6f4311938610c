#include "core/vulkan/vulkan_tree.h"

#include <algorithm>
#include <chrono>

#include "core/shared/bvh_node.h"

namespace sightline {
namespace {

/// Triangles without indices. Unless all are opaque, shaders decide about each, some perhaps asked several
/// times.
VkAccelerationStructureGeometryKHR triangleGeometry(VkDeviceAddress corners, uint32_t triangles,
                                                    bool opaque) {
  auto geometry =
      vkStruct<VkAccelerationStructureGeometryKHR>(VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR);
  geometry.geometryType = VK_GEOMETRY_TYPE_TRIANGLES_KHR;
  if (opaque) geometry.flags = VK_GEOMETRY_OPAQUE_BIT_KHR;
  VkAccelerationStructureGeometryTrianglesDataKHR& data = geometry.geometry.triangles;
  data.sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_TRIANGLES_DATA_KHR;
  data.vertexFormat = VK_FORMAT_R32G32B32_SFLOAT;
  data.vertexData.deviceAddress = corners;
  data.vertexStride = kCornerBytes / 3;
  data.maxVertex = 3 * triangles - 1;
  data.indexType = VK_INDEX_TYPE_NONE_KHR;
  return geometry;
}

VkAccelerationStructureGeometryKHR instanceGeometry(VkDeviceAddress instances) {
  auto geometry =
      vkStruct<VkAccelerationStructureGeometryKHR>(VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR);
  geometry.geometryType = VK_GEOMETRY_TYPE_INSTANCES_KHR;
  VkAccelerationStructureGeometryInstancesDataKHR& data = geometry.geometry.instances;
  data.sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_INSTANCES_DATA_KHR;
  data.data.deviceAddress = instances;
  return geometry;
}

VkAccelerationStructureBuildGeometryInfoKHR buildInfo(VkAccelerationStructureTypeKHR type,
                                                      const VkAccelerationStructureGeometryKHR& geometry) {
  auto info = vkStruct<VkAccelerationStructureBuildGeometryInfoKHR>(
      VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_GEOMETRY_INFO_KHR);
  info.type = type;
  info.flags = VK_BUILD_ACCELERATION_STRUCTURE_PREFER_FAST_TRACE_BIT_KHR;
  if (type == VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR) {
    info.flags |= VK_BUILD_ACCELERATION_STRUCTURE_ALLOW_COMPACTION_BIT_KHR;
  }
  info.mode = VK_BUILD_ACCELERATION_STRUCTURE_MODE_BUILD_KHR;
  info.geometryCount = 1;
  info.pGeometries = &geometry;
  return info;
}

VkAccelerationStructureBuildSizesInfoKHR buildSizes(const VulkanContext& context,
                                                    const VkAccelerationStructureBuildGeometryInfoKHR& info,
                                                    uint32_t count) {
  auto sizes = vkStruct<VkAccelerationStructureBuildSizesInfoKHR>(
      VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_SIZES_INFO_KHR);
  context.api().vkGetAccelerationStructureBuildSizesKHR(
      context.device(), VK_ACCELERATION_STRUCTURE_BUILD_TYPE_DEVICE_KHR, &info, &count, &sizes);
  return sizes;
}

VulkanStructure createStructure(const VulkanContext& context, VkAccelerationStructureTypeKHR type,
                                uint64_t bytes) {
  VulkanStructure structure;
  structure.memory = context.buffer(bytes, "acceleration structure");
  auto info = vkStruct<VkAccelerationStructureCreateInfoKHR>(
      VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_CREATE_INFO_KHR);
  info.buffer = structure.memory.get();
  info.size = bytes;
  info.type = type;
  VkAccelerationStructureKHR handle = VK_NULL_HANDLE;
  checkVk(context.api().vkCreateAccelerationStructureKHR(context.device(), &info, nullptr, &handle),
          "vkCreateAccelerationStructureKHR");
  structure.handle = {context, handle, [](const VulkanContext& c, VkAccelerationStructureKHR freed) {
                        c.api().vkDestroyAccelerationStructureKHR(c.device(), freed, nullptr);
                      }};
  auto of = vkStruct<VkAccelerationStructureDeviceAddressInfoKHR>(
      VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_DEVICE_ADDRESS_INFO_KHR);
  of.accelerationStructure = handle;
  structure.address = context.api().vkGetAccelerationStructureDeviceAddressKHR(context.device(), &of);
  return structure;
}

/// Builds structures, one after the other; scratch memory is kept for the next.
class TreeBuilder {
 public:
  explicit TreeBuilder(const VulkanContext& context)
      : context_(context), commands_(context, context.queue(), context.queueFamily()) {
    auto info = vkStruct<VkQueryPoolCreateInfo>(VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO);
    info.queryType = VK_QUERY_TYPE_ACCELERATION_STRUCTURE_COMPACTED_SIZE_KHR;
    info.queryCount = 1;
    VkQueryPool pool = VK_NULL_HANDLE;
    checkVk(context.api().vkCreateQueryPool(context.device(), &info, nullptr, &pool), "vkCreateQueryPool");
    sizes_ = {context, pool, [](const VulkanContext& c, VkQueryPool handle) {
                c.api().vkDestroyQueryPool(c.device(), handle, nullptr);
              }};
  }

  /// Over `count` triangles or instances.
  VulkanStructure build(VkAccelerationStructureTypeKHR type,
                        const VkAccelerationStructureGeometryKHR& geometry, uint32_t count) {
    VkAccelerationStructureBuildGeometryInfoKHR info = buildInfo(type, geometry);
    const VkAccelerationStructureBuildSizesInfoKHR sizes = buildSizes(context_, info, count);
    VulkanStructure structure = createStructure(context_, type, sizes.accelerationStructureSize);
    const uint64_t alignment = context_.limits().scratch_alignment;
    if (scratch_.bytes() < sizes.buildScratchSize + alignment) {
      scratch_ = VulkanBuffer();
      scratch_ = context_.buffer(sizes.buildScratchSize + alignment, "scratch memory of a build");
    }
    info.scratchData.deviceAddress = (scratch_.address() + alignment - 1) / alignment * alignment;
    info.dstAccelerationStructure = structure.handle.get();
    VkAccelerationStructureBuildRangeInfoKHR range{};
    range.primitiveCount = count;
    const VkAccelerationStructureBuildRangeInfoKHR* ranges = &range;
    context_.api().vkCmdBuildAccelerationStructuresKHR(commands_.next(), 1, &info, &ranges);
    return structure;
  }

  /// The same structure in as little memory as it needs.
  VulkanStructure compact(VulkanStructure loose) {
    const VulkanApi& api = context_.api();
    api.vkCmdResetQueryPool(commands_.next(), sizes_.get(), 0, 1);
    api.vkCmdWriteAccelerationStructuresPropertiesKHR(commands_.next(), 1, loose.handle.address(),
                                                      VK_QUERY_TYPE_ACCELERATION_STRUCTURE_COMPACTED_SIZE_KHR,
                                                      sizes_.get(), 0);
    commands_.finish();
    uint64_t bytes = 0;
    checkVk(api.vkGetQueryPoolResults(context_.device(), sizes_.get(), 0, 1, sizeof bytes, &bytes,
                                      sizeof bytes, VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT),
            "vkGetQueryPoolResults");
    if (bytes == 0 || bytes >= loose.memory.bytes()) return loose;
    VulkanStructure tight = createStructure(context_, VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR, bytes);
    auto copy =
        vkStruct<VkCopyAccelerationStructureInfoKHR>(VK_STRUCTURE_TYPE_COPY_ACCELERATION_STRUCTURE_INFO_KHR);
    copy.src = loose.handle.get();
    copy.dst = tight.handle.get();
    copy.mode = VK_COPY_ACCELERATION_STRUCTURE_MODE_COMPACT_KHR;
    api.vkCmdCopyAccelerationStructureKHR(commands_.next(), &copy);
    commands_.finish();
    return tight;
  }

  VulkanCommands& commands() { return commands_; }

 private:
  const VulkanContext& context_;
  VulkanCommands commands_;
  VulkanHandle<VkQueryPool> sizes_;
  VulkanBuffer scratch_;
};

/// Seen from both sides.
VkAccelerationStructureInstanceKHR instanceOf(const VulkanStructure& part, const VkTransformMatrixKHR& place,
                                              uint32_t number) {
  VkAccelerationStructureInstanceKHR instance{};
  instance.transform = place;
  instance.instanceCustomIndex = number & 0xffffffu;
  instance.mask = 0xff;
  instance.flags = VK_GEOMETRY_INSTANCE_TRIANGLE_FACING_CULL_DISABLE_BIT_KHR;
  instance.accelerationStructureReference = part.address;
  return instance;
}

}  // namespace

uint32_t largestPart(const VulkanContext& context, uint32_t triangles) {
  auto limit = static_cast<uint32_t>(std::min<uint64_t>(context.limits().part_triangles, triangles));
  const VkAccelerationStructureGeometryKHR geometry = triangleGeometry(0, limit, true);
  const auto info = buildInfo(VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR, geometry);
  const auto fits = [&](uint32_t count) {
    const VkAccelerationStructureBuildSizesInfoKHR sizes = buildSizes(context, info, count);
    return std::max(sizes.accelerationStructureSize,
                    sizes.buildScratchSize + context.limits().scratch_alignment) <=
           context.limits().allocation_bytes;
  };
  while (limit > 1 && !fits(limit)) limit -= limit / 4 + 1;
  return limit;
}

VulkanTree buildVulkanTree(const VulkanContext& context, const VulkanBuffer& corners,
                           const std::vector<LeafPart>& parts, const std::vector<PlacedPart>& placed) {
  const auto start = std::chrono::steady_clock::now();
  VulkanTree tree;
  TreeBuilder builder(context);
  std::vector<VkAccelerationStructureInstanceKHR> instances;
  for (const LeafPart& part : parts) {
    const auto geometry =
        triangleGeometry(corners.address() + uint64_t(part.first) * kCornerBytes, part.count, part.opaque);
    VulkanStructure loose =
        builder.build(VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR, geometry, part.count);
    tree.parts.push_back(builder.compact(std::move(loose)));
    tree.bytes += tree.parts.back().memory.bytes();
  }
  for (const PlacedPart& part : placed) {
    instances.push_back(
        instanceOf(tree.parts[part.part], part.place, static_cast<uint32_t>(instances.size())));
  }
  const uint64_t instance_bytes = instances.size() * sizeof instances.front();
  const VulkanBuffer staging = context.buffer(instance_bytes, "instances", VulkanMemory::kUpload);
  std::copy(instances.begin(), instances.end(),
            static_cast<VkAccelerationStructureInstanceKHR*>(staging.mapped()));
  tree.instances = context.buffer(instance_bytes, "instances");
  builder.commands().copy(staging, tree.instances, instance_bytes);
  tree.top =
      builder.build(VK_ACCELERATION_STRUCTURE_TYPE_TOP_LEVEL_KHR, instanceGeometry(tree.instances.address()),
                    static_cast<uint32_t>(instances.size()));
  builder.commands().finish();
  tree.bytes += tree.top.memory.bytes();
  tree.build_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return tree;
}

}  // namespace sightline
