#include "core/draw/vulkan/vulkan_drawing.h"

#include <cstring>

#include "core/draw/vulkan/drawing_needs.h"

namespace sightline {
namespace {

constexpr VkPipelineStageFlags kShaders =
    VK_PIPELINE_STAGE_ALL_GRAPHICS_BIT | VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT;

}  // namespace

VulkanDrawing::VulkanDrawing(const std::string& selector, const Scene& scene, const Drawables& drawables,
                             const TriangleLists& lists, const DrawingOptions& options)
    : context_(selector, drawingNeeds(), options.memory_budget),
      mesh_(context_, scene, drawables, lists),
      passes_(context_, mesh_.hasGlass()),
      programs_(context_, passes_),
      launch_buffer_(context_.buffer(sizeof(DrawLaunch), "a frame's launch")),
      ring_(context_, options.clock, options.chain) {
  mesh_.describe(launch_);
}

void VulkanDrawing::beginFrame(const Camera& camera) {
  if (camera.size.x != target_.width() || camera.size.y != target_.height()) {
    ring_.drain();
    target_ = DrawTarget();
    target_ = DrawTarget(context_, passes_, camera.size.x, camera.size.y);
    ++targets_;
  }
  launch_.camera = camera;
  described_ = drawn_ = false;
  ring_.beginFrame(++frame_);
}

CommandRing::Entry& VulkanDrawing::open(uint32_t queries, uint64_t box_bytes, uint64_t result_bytes) {
  CommandRing::Entry& entry = ring_.open(queries, box_bytes, result_bytes);
  if (!described_) {  // after the frame before has read its own
    barrier(entry.commands, kShaders, 0, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT);
    context_.api().vkCmdUpdateBuffer(entry.commands, launch_buffer_.get(), 0, sizeof launch_, &launch_);
    barrier(entry.commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT, kShaders,
            VK_ACCESS_SHADER_READ_BIT);
    described_ = true;
  }
  return entry;
}

CommandRing::Entry& VulkanDrawing::openKept(uint64_t key, std::span<const uint32_t> data,
                                            const VulkanBuffer& to, uint64_t result_bytes) {
  CommandRing::Entry& entry = ring_.openKept(key, sizeof launch_ + data.size_bytes(), result_bytes);
  auto* out = static_cast<char*>(entry.boxes.mapped());
  std::memcpy(out, &launch_, sizeof launch_);
  if (!data.empty()) std::memcpy(out + sizeof launch_, data.data(), data.size_bytes());
  described_ = true;
  drawn_ = entry.recorded;
  if (entry.recorded) return entry;
  barrier(entry.commands, kShaders, 0, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT);
  const VkBufferCopy first{0, 0, sizeof launch_}, second{sizeof launch_, 0, data.size_bytes()};
  const VulkanApi& api = context_.api();
  api.vkCmdCopyBuffer(entry.commands, entry.boxes.get(), launch_buffer_.get(), 1, &first);
  if (!data.empty()) api.vkCmdCopyBuffer(entry.commands, entry.boxes.get(), to.get(), 1, &second);
  barrier(entry.commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT, kShaders,
          VK_ACCESS_SHADER_READ_BIT);
  return entry;
}

void VulkanDrawing::beginPass(CommandRing::Entry& entry) {
  target_.begin(context_, entry.commands, passes_, !drawn_);
  drawn_ = true;
}

void VulkanDrawing::endPass(CommandRing::Entry& entry) {
  context_.api().vkCmdEndRenderPass(entry.commands);
}

void VulkanDrawing::submit(CommandRing::Entry& entry) {
  ring_.submit(entry);
}

void VulkanDrawing::endFrame() {
  if (drawn_) return;
  CommandRing::Entry& entry = open();
  beginPass(entry);
  endPass(entry);
  ring_.mark(entry, GpuPart::draw);
  submit(entry);
}

DrawPush VulkanDrawing::push(VkDeviceAddress other, const uvec4& numbers) const {
  return {launch_buffer_.address(), other, numbers};
}

void VulkanDrawing::draw(VkCommandBuffer commands, const SlotRun& run, uint32_t drawable,
                         std::optional<AlphaKind>& bound) {
  const bool indexed = run.kind == AlphaKind::opaque && !mesh_.hasSides();
  if (bound != run.kind) {
    bound = run.kind;
    programs_.bind(commands,
                   indexed                          ? DrawKind::opaque
                   : run.kind == AlphaKind::blended ? DrawKind::glass
                                                    : DrawKind::masked,
                   push());
    if (indexed)
      context_.api().vkCmdBindIndexBuffer(commands, mesh_.indices().get(), 0, VK_INDEX_TYPE_UINT32);
  }
  if (indexed) {
    context_.api().vkCmdDrawIndexed(commands, 3 * run.count, 1, 3 * run.first, 0, drawable);
  } else {
    context_.api().vkCmdDraw(commands, 3 * run.count, 1, 3 * run.first, drawable);
  }
}

void VulkanDrawing::barrier(VkCommandBuffer commands, VkPipelineStageFlags from, VkAccessFlags written,
                            VkPipelineStageFlags to, VkAccessFlags used) const {
  auto memory = vkStruct<VkMemoryBarrier>(VK_STRUCTURE_TYPE_MEMORY_BARRIER);
  memory.srcAccessMask = written;
  memory.dstAccessMask = used;
  context_.api().vkCmdPipelineBarrier(commands, from, to, 0, 1, &memory, 0, nullptr, 0, nullptr);
}

std::vector<uint32_t> VulkanDrawing::read(const DrawTarget& target, DrawTarget::Image image) const {
  std::vector<uint32_t> pixels(target.pixels());
  const VulkanBuffer buffer =
      context_.buffer(4 * pixels.size(), "an image's pixels", VulkanMemory::kReadback);
  VulkanCommands commands(context_, context_.queue(), context_.queueFamily());
  target.copy(context_, commands.next(), image, buffer);
  commands.finish();
  std::memcpy(pixels.data(), buffer.mapped(), 4 * pixels.size());
  return pixels;
}

std::vector<float> VulkanDrawing::readDepth(const DrawTarget& target) const {
  const std::vector<uint32_t> bits = read(target, DrawTarget::Image::depth);
  std::vector<float> depth(bits.size());
  std::memcpy(depth.data(), bits.data(), 4 * bits.size());
  return depth;
}

std::vector<uint32_t> VulkanDrawing::readGlass() const {
  return passes_.glass() ? read(target_, DrawTarget::Image::glass) : std::vector<uint32_t>();
}

}  // namespace sightline
