#include "core/vulkan/vulkan_commands.h"

#include <cstring>

namespace sightline {

VulkanCommands::VulkanCommands(const VulkanContext& context, VkQueue queue, uint32_t family)
    : context_(context), queue_(queue) {
  const VulkanApi& api = context.api();
  auto pool_info = vkStruct<VkCommandPoolCreateInfo>(VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO);
  pool_info.flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT;
  pool_info.queueFamilyIndex = family;
  VkCommandPool pool = VK_NULL_HANDLE;
  checkVk(api.vkCreateCommandPool(context.device(), &pool_info, nullptr, &pool), "vkCreateCommandPool");
  pool_ = {context, pool, [](const VulkanContext& c, VkCommandPool handle) {
             c.api().vkDestroyCommandPool(c.device(), handle, nullptr);
           }};
  auto buffer_info = vkStruct<VkCommandBufferAllocateInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO);
  buffer_info.commandPool = pool;
  buffer_info.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
  buffer_info.commandBufferCount = 1;
  checkVk(api.vkAllocateCommandBuffers(context.device(), &buffer_info, &buffer_), "vkAllocateCommandBuffers");
  const auto fence_info = vkStruct<VkFenceCreateInfo>(VK_STRUCTURE_TYPE_FENCE_CREATE_INFO);
  VkFence fence = VK_NULL_HANDLE;
  checkVk(api.vkCreateFence(context.device(), &fence_info, nullptr, &fence), "vkCreateFence");
  fence_ = {context, fence, [](const VulkanContext& c, VkFence handle) {
              c.api().vkDestroyFence(c.device(), handle, nullptr);
            }};
}

VulkanCommands::~VulkanCommands() {
  // Whatever it says: a lost device runs nothing any more.
  if (submitted_) {
    context_.api().vkWaitForFences(context_.device(), 1, fence_.address(), VK_TRUE, UINT64_MAX);
  }
}

VkCommandBuffer VulkanCommands::next() {
  if (!recording_) {
    wait();
    checkVk(context_.api().vkResetCommandPool(context_.device(), pool_.get(), 0), "vkResetCommandPool");
    auto info = vkStruct<VkCommandBufferBeginInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO);
    info.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
    checkVk(context_.api().vkBeginCommandBuffer(buffer_, &info), "vkBeginCommandBuffer");
    recording_ = true;
  } else {
    barrier(VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT);
  }
  return buffer_;
}

void VulkanCommands::barrier(VkPipelineStageFlags to, VkAccessFlags access) {
  auto memory = vkStruct<VkMemoryBarrier>(VK_STRUCTURE_TYPE_MEMORY_BARRIER);
  memory.srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT;
  memory.dstAccessMask = access;
  context_.api().vkCmdPipelineBarrier(buffer_, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, to, 0, 1, &memory, 0,
                                      nullptr, 0, nullptr);
}

void VulkanCommands::fill(const VulkanBuffer& buffer, uint32_t value, uint64_t bytes, uint64_t offset) {
  if (bytes == 0) return;
  context_.api().vkCmdFillBuffer(next(), buffer.get(), offset, bytes, value);
}

void VulkanCommands::update(const VulkanBuffer& buffer, const void* data, uint64_t bytes, uint64_t offset) {
  context_.api().vkCmdUpdateBuffer(next(), buffer.get(), offset, bytes, data);
}

void VulkanCommands::updateBeside(const VulkanBuffer& buffer, const void* data, uint64_t bytes,
                                  uint64_t offset) {
  context_.api().vkCmdUpdateBuffer(recording_ ? buffer_ : next(), buffer.get(), offset, bytes, data);
}

void VulkanCommands::copy(const VulkanBuffer& from, const VulkanBuffer& to, uint64_t bytes,
                          uint64_t from_offset, uint64_t to_offset) {
  if (bytes == 0) return;
  const VkBufferCopy region{from_offset, to_offset, bytes};
  context_.api().vkCmdCopyBuffer(next(), from.get(), to.get(), 1, &region);
}

void VulkanCommands::run(const VulkanStage& stage, VkDeviceAddress launch, uint32_t count) {
  if (count > 0) stage.record(next(), launch, count);
}

void VulkanCommands::submit() {
  if (!recording_) return;
  barrier(VK_PIPELINE_STAGE_HOST_BIT, VK_ACCESS_HOST_READ_BIT);
  recording_ = false;
  checkVk(context_.api().vkEndCommandBuffer(buffer_), "vkEndCommandBuffer");
  checkVk(context_.api().vkResetFences(context_.device(), 1, fence_.address()), "vkResetFences");
  auto info = vkStruct<VkSubmitInfo>(VK_STRUCTURE_TYPE_SUBMIT_INFO);
  info.commandBufferCount = 1;
  info.pCommandBuffers = &buffer_;
  checkVk(context_.api().vkQueueSubmit(queue_, 1, &info, fence_.get()), "vkQueueSubmit");
  submitted_ = true;
}

void VulkanCommands::wait() {
  if (!submitted_) return;
  submitted_ = false;
  checkVk(context_.api().vkWaitForFences(context_.device(), 1, fence_.address(), VK_TRUE, UINT64_MAX),
          "vkWaitForFences");
}

void VulkanCommands::finish() {
  submit();
  wait();
}

VulkanUpload::VulkanUpload(const VulkanContext& context)
    : halves_{{context.buffer(kStagingBytes, "staging memory", VulkanMemory::kUpload),
               {context, context.transferQueue(), context.transferFamily()}},
              {context.buffer(kStagingBytes, "staging memory", VulkanMemory::kUpload),
               {context, context.transferQueue(), context.transferFamily()}}} {}

void VulkanUpload::write(const VulkanBuffer& target, const void* data, uint64_t bytes) {
  write(target, bytes, 4, [&](void* piece, uint64_t first, uint64_t count) {
    std::memcpy(piece, static_cast<const char*>(data) + first, count);
  });
}

void VulkanUpload::finish() {
  for (Half& half : halves_) half.commands.wait();
}

}  // namespace sightline
