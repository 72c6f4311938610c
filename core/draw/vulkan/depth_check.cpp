#include "core/draw/vulkan/depth_check.h"

#include <algorithm>

#include "vk_shaders/compare_launch.h"

namespace sightline {
namespace {

constexpr uint32_t kCompareGroup = 256;  // of vk_shaders/compare_depth.comp

}  // namespace

void DepthCheck::fit() {
  const VulkanContext& context = drawing_.context();
  const DrawTarget& drawn = drawing_.target();
  if (target_.width() == drawn.width() && target_.height() == drawn.height()) return;
  target_ = DrawTarget();
  for (VulkanBuffer* buffer : {&reference_, &tested_, &ids_}) *buffer = VulkanBuffer();
  target_ = DrawTarget(context, drawing_.passes(), drawn.width(), drawn.height());
  const VulkanMemoryUse use("images to compare", "a smaller resolution, or leave the check out");
  for (VulkanBuffer* buffer : {&reference_, &tested_, &ids_})
    *buffer = context.buffer(4 * drawn.pixels(), use);
  const uint64_t counts = 4 * (kDrawableCounts + 2 * drawing_.mesh().drawables().list.size());
  if (counts_.bytes() > 0) return;
  counts_ = context.buffer(counts, use);
  results_ = context.buffer(counts, use, VulkanMemory::kReadback);
  launch_ = context.buffer(sizeof(CompareLaunch), use);
}

void DepthCheck::drawReference(VkCommandBuffer commands, GpuCulling* method) {
  target_.begin(drawing_.context(), commands, drawing_.passes(), true);
  std::optional<AlphaKind> bound;
  const auto drawKind = [&](AlphaKind kind) {
    for (uint32_t i = 0; i < drawing_.mesh().drawables().list.size(); ++i) {
      const SlotRun run = drawing_.mesh().run(i);
      if (run.kind == kind) drawing_.draw(commands, run, i, bound);
    }
  };
  if (method != nullptr && method->usesMeshShaders()) {
    method->drawAll(commands);
  } else {
    drawKind(AlphaKind::opaque);
  }
  drawKind(AlphaKind::masked);
  drawing_.context().api().vkCmdEndRenderPass(commands);
}

DepthDifference DepthCheck::compare(GpuCulling* method) {
  const VulkanContext& context = drawing_.context();
  drawing_.ring().drain();
  fit();
  const CompareLaunch launch{reference_.address(), tested_.address(), ids_.address(), counts_.address()};
  VulkanCommands commands(context, context.queue(), context.queueFamily());
  commands.update(launch_, &launch, sizeof launch);
  commands.fill(counts_, 0, counts_.bytes());
  drawReference(commands.next(), method);
  target_.copy(context, commands.next(), DrawTarget::Image::depth, reference_);
  target_.copy(context, commands.next(), DrawTarget::Image::ids, ids_);
  drawing_.target().copy(context, commands.next(), DrawTarget::Image::depth, tested_);
  const auto pixels = uint32_t(target_.pixels());
  const auto drawables = uint32_t(drawing_.mesh().drawables().list.size());
  const DrawPush push{launch_.address(), 0, {pixels, drawables, 0, 0}};
  const uint32_t groups = (pixels + kCompareGroup - 1) / kCompareGroup;
  drawing_.programs().run(commands.next(), "compare_depth.comp", push, std::min(groups, 32768u),
                          (groups + 32767) / 32768);
  commands.copy(counts_, results_, counts_.bytes());
  commands.finish();

  const auto* counts = static_cast<const uint32_t*>(results_.mapped());
  DepthDifference difference;
  difference.false_pixels = counts[kFalsePixels];
  difference.too_near_pixels = counts[kTooNearPixels];
  for (uint32_t i = 0; i < drawables; ++i) {
    const uint32_t missing = counts[kDrawableCounts + 2 * i];
    if (missing > 0) difference.missing.push_back({i, missing});
    difference.largest = std::max(difference.largest, missing);
    if (counts[kDrawableCounts + 2 * i + 1] > 0) difference.shown.push_back(i);
  }
  return difference;
}

}  // namespace sightline
