// What goes wrong with Vulkan is one clear line; and the tests really run under the validation layer.
#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>

#include "core/base/error.h"
#include "core/device/vulkan/tracing_needs.h"
#include "core/device/vulkan/vulkan_scene.h"
#include "core/generate/generate.h"
#include "core/vulkan/vulkan_commands.h"
#include "core/vulkan/vulkan_image.h"
#include "tests/support/vulkan.h"

namespace sightline {
namespace {

std::string lineOf(auto&& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "nothing was thrown";
}

void expectLine(const std::string& line, std::initializer_list<const char*> parts) {
  EXPECT_EQ(line.find('\n'), std::string::npos) << line;
  for (const char* part : parts)
    EXPECT_NE(line.find(part), std::string::npos) << "no \"" << part << "\": " << line;
}

TEST(VulkanErrors, CodesAreToldInWords) {
  expectLine(lineOf([] { checkVk(VK_ERROR_DEVICE_LOST, "vkQueueSubmit"); }),
             {"vkQueueSubmit", "lost the device", "-4"});
  expectLine(lineOf([] { checkVk(VK_ERROR_OUT_OF_DEVICE_MEMORY, "vkCreateRayTracingPipelinesKHR"); }),
             {"vkCreateRayTracingPipelinesKHR", "out of device memory"});
  EXPECT_EQ(lineOf([] { checkVk(VK_SUCCESS, "vkQueueSubmit"); }), "nothing was thrown");
}

VulkanAbilities everything() {
  VulkanAbilities all;
  all.version = VK_API_VERSION_1_2;
  for (uint32_t i = 0; i < kVulkanFeatures; ++i) {
    all.features.insert(VulkanFeature(i));
    const auto its = extensionsOf(VulkanFeature(i));
    all.extensions.insert(its.begin(), its.end());
  }
  all.queues = {VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT | VK_QUEUE_TRANSFER_BIT};
  return all;
}

TEST(VulkanErrors, EachMissingAbilityIsNamed) {
  const VulkanAbilities good = everything();
  const VulkanNeeds needs = tracingNeeds(false);
  EXPECT_EQ(whyUnusable(good, needs), "");
  const auto expectReason = [&](const char* part, auto&& spoil) {
    VulkanAbilities bad = good;
    spoil(bad);
    expectLine(whyUnusable(bad, needs), {part});
  };
  using enum VulkanFeature;
  expectReason("Vulkan 1.1", [](VulkanAbilities& a) { a.version = VK_API_VERSION_1_1; });
  expectReason("VK_KHR_acceleration_structure", [](VulkanAbilities& a) { a.extensions.clear(); });
  expectReason("VK_KHR_deferred_host_operations",
               [](VulkanAbilities& a) { a.extensions.erase("VK_KHR_deferred_host_operations"); });
  expectReason("accelerationStructure", [](VulkanAbilities& a) { a.features.erase(kStructures); });
  expectReason("rayQuery",
               [](VulkanAbilities& a) { a.features.erase(kPipelines), a.features.erase(kRayQueries); });
  expectReason("bufferDeviceAddress", [](VulkanAbilities& a) { a.features.erase(kAddresses); });
  expectReason("scalarBlockLayout", [](VulkanAbilities& a) { a.features.erase(kScalarLayout); });
  expectReason("shaderInt64", [](VulkanAbilities& a) { a.features.erase(kInt64); });
  expectReason("shaderFloat64", [](VulkanAbilities& a) { a.features.erase(kFloat64); });
  expectReason("no queue for compute shaders",
               [](VulkanAbilities& a) { a.queues = {VK_QUEUE_GRAPHICS_BIT}; });
}

TEST(VulkanErrors, WhatIsThereIsTakenAndNoMore) {
  using enum VulkanFeature;
  VulkanAbilities abilities = everything();
  const auto tracing = featuresFor(abilities, tracingNeeds(false));
  EXPECT_TRUE(tracing.contains(kPipelines) && !tracing.contains(kRayQueries));
  EXPECT_TRUE(featuresFor(abilities, tracingNeeds(true)).contains(kRayQueries));
  abilities.extensions.erase("VK_KHR_ray_tracing_pipeline");
  EXPECT_EQ(whyUnusable(abilities, tracingNeeds(false)), "");
  EXPECT_TRUE(featuresFor(abilities, tracingNeeds(false)).contains(kRayQueries));
  EXPECT_TRUE(featuresFor(abilities, tracingNeeds(false)).contains(kMultiview)) << "welcome";
  abilities.features.erase(kMultiview);
  EXPECT_EQ(whyUnusable(abilities, tracingNeeds(false)), "") << "only welcome";
  EXPECT_FALSE(featuresFor(abilities, tracingNeeds(false)).contains(kMultiview));
}

/// A GPU that can draw but not trace.
TEST(VulkanErrors, DrawingTakesNoRayTracing) {
  VulkanAbilities abilities = everything();
  abilities.extensions.clear();
  VulkanNeeds drawing;
  drawing.features = {VulkanFeature::kMultiview};
  drawing.queue = VK_QUEUE_GRAPHICS_BIT;
  EXPECT_EQ(whyUnusable(abilities, drawing), "");
  expectLine(whyUnusable(abilities, tracingNeeds(false)),
             {"no ray tracing", "VK_KHR_acceleration_structure"});
  abilities.queues = {VK_QUEUE_COMPUTE_BIT, VK_QUEUE_TRANSFER_BIT};
  expectLine(whyUnusable(abilities, drawing), {"no queue for graphics"});
  abilities = everything();
  drawing.sub_pixel_bits = 8;
  drawing.group_size = 256;
  abilities.sub_pixel_bits = 8;
  abilities.group_size = 256;
  EXPECT_EQ(whyUnusable(abilities, drawing), "");
  abilities.sub_pixel_bits = 4;
  expectLine(whyUnusable(abilities, drawing), {"4 bits (subPixelPrecisionBits), 8 are needed"});
  abilities.sub_pixel_bits = 8;
  abilities.group_size = 128;
  expectLine(whyUnusable(abilities, drawing), {"128 invocations (maxComputeWorkGroupSize), 256 are needed"});
  abilities.group_size = 256;
  drawing.extensions = {"VK_KHR_swapchain"};
  expectLine(whyUnusable(abilities, drawing), {"its driver lacks VK_KHR_swapchain"});
}

TEST(VulkanErrors, NeedsThatNothingMeetsAreNamed) {
  SL_SKIP_WITHOUT_VULKAN();
  VulkanNeeds needs;
  needs.extensions = {"VK_SL_no_such_extension"};
  expectLine(lineOf([&] { const VulkanContext context("vulkan", needs); }), {"VK_SL_no_such_extension"});
  expectLine(lineOf([&] { const VulkanContext context("vulkan:0", needs); }),
             {"vulkan:0", "its driver lacks VK_SL_no_such_extension"});
  const VulkanContext without_program("vulkan", VulkanNeeds{});
  expectLine(lineOf([&] { VulkanStage::compute(without_program, "rehash.comp", 64); }),
             {"rehash.comp", "no program"});
}

/// With all that drawing takes and nothing of ray tracing turned on: copies and images work.
TEST(VulkanErrors, AContextToDrawWithTurnsNoRayTracingOn) {
  SL_SKIP_WITHOUT_VULKAN();
  VulkanNeeds needs;
  needs.features = {VulkanFeature::kMultiview, VulkanFeature::kClipDistances, VulkanFeature::kMultiDraw};
  needs.queue = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
  const VulkanContext context("vulkan", needs);
  EXPECT_TRUE(context.has(VulkanFeature::kMultiview));
  EXPECT_TRUE(context.queueFlags() & VK_QUEUE_GRAPHICS_BIT);
  EXPECT_FALSE(context.has(VulkanFeature::kStructures));
  EXPECT_EQ(context.api().vkCreateAccelerationStructureKHR, nullptr);
  EXPECT_EQ(context.api().vkCreateRayTracingPipelinesKHR, nullptr);
  const VulkanImage image(context, VK_FORMAT_R8G8B8A8_UNORM, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT,
                          VK_IMAGE_ASPECT_COLOR_BIT, {64, 64, 1}, "a picture");
  EXPECT_NE(image.view(), VkImageView(VK_NULL_HANDLE));
  const VulkanBuffer on_device = context.buffer(64, "numbers");
  const VulkanBuffer readback = context.buffer(64, "numbers", VulkanMemory::kReadback);
  EXPECT_EQ(on_device.address(), 0u) << "addresses are off";
  const uint32_t written[16] = {7, 1, 4};
  VulkanUpload upload(context);
  upload.write(on_device, written, sizeof written);
  upload.finish();
  VulkanCommands commands(context, context.queue(), context.queueFamily());
  commands.copy(on_device, readback, sizeof written);
  commands.finish();
  EXPECT_EQ(std::memcmp(readback.mapped(), written, sizeof written), 0);
}

TEST(VulkanErrors, WhatDoesNotFitIsNamed) {
  SL_SKIP_WITHOUT_VULKAN();
  const VulkanContext context("vulkan", tracingNeeds(false));
  expectLine(lineOf([&] { context.buffer(context.limits().allocation_bytes + 1, "triangles of the scene"); }),
             {"vulkan:", "triangles of the scene", "MiB", "one buffer", "use the device cpu"});
  if (context.limits().allocation_bytes > context.info().memory_bytes) return;
  std::vector<VulkanBuffer> buffers;
  const uint64_t bytes = context.limits().allocation_bytes;
  expectLine(lineOf([&] {
               for (uint64_t i = 0; i <= context.info().memory_bytes / bytes; ++i) {
                 buffers.push_back(context.buffer(bytes, "hits"));
               }
             }),
             {"hits", "are in use", "use the device cpu"});
  buffers.clear();
  EXPECT_EQ(context.allocatedBytes(), 0u);
}

TEST(VulkanErrors, WhatTheBudgetForbidsNamesTheBudget) {
  SL_SKIP_WITHOUT_VULKAN();
  const VulkanContext context("vulkan", tracingNeeds(false), 1u << 20);
  const std::string line = lineOf([&] { context.buffer(2u << 20, "hits"); });
  expectLine(line, {"hits", "of the 1.0 MiB", "give a larger --memory-budget, or leave it out"});
  EXPECT_EQ(line.find("device cpu"), std::string::npos) << line;
}

/// A budget that ends with any of the scene's buffers: those before it may still be on their way to the
/// device when they are freed.
TEST(VulkanErrors, WhatIsFreedAfterAnErrorHasArrived) {
  SL_SKIP_WITHOUT_VULKAN();
  const Scene scene = generateScene("city", 50'000, 7);
  const Bvh bvh = buildBvh(scene.positions, scene.triangles);
  const uint64_t corners = scene.triangles.size() * 36, ids = scene.triangles.size() * 4;
  uint64_t staging = 0;
  {
    const VulkanContext context("vulkan", tracingNeeds(false));
    const VulkanUpload upload(context);
    staging = context.allocatedBytes();
  }
  const std::pair<uint64_t, const char*> ends[] = {{corners - 1, "triangles of the scene"},
                                                   {corners + ids - 1, "ids of the triangles"},
                                                   {corners + 2 * ids - 1, "index of triangles"},
                                                   {corners + 2 * ids, "parts of the scene"},
                                                   {corners + 2 * ids + 64, "acceleration structure"}};
  for (const auto& [bytes, what] : ends) {
    const VulkanContext context("vulkan", tracingNeeds(false), staging + bytes);
    expectLine(lineOf([&] { uploadVulkanScene(context, scene, bvh, 0); }), {what, "--memory-budget"});
    EXPECT_EQ(context.allocatedBytes(), 0u) << what;
  }
}

/// Commands that run when they go are waited for, and what an upload reads from goes after them.
TEST(VulkanErrors, CommandsThatGoAreWaitedFor) {
  SL_SKIP_WITHOUT_VULKAN();
  const VulkanContext context("vulkan", tracingNeeds(false));
  const std::vector<uint32_t> words(6u << 20, 7);
  const VulkanBuffer target = context.buffer(words.size() * 4, "test");
  for (int i = 0; i < 5; ++i) {
    VulkanUpload upload(context);
    upload.write(target, words.data(), words.size() * 4);
  }
  for (int i = 0; i < 5; ++i) {
    VulkanCommands commands(context, context.queue(), context.queueFamily());
    commands.fill(target, uint32_t(i), words.size() * 4);
    commands.submit();
  }
}

/// Under validation, as CTest runs the tests, a mistake ends the process; so does a missing barrier.
TEST(VulkanErrorsDeathTest, ValidationIsOn) {
  SL_SKIP_WITHOUT_VULKAN();
  const char* validation = std::getenv("SIGHTLINE_VULKAN_VALIDATION");
  if (!validation) GTEST_SKIP() << "not run by CTest";
  testing::FLAGS_gtest_death_test_style = "threadsafe";
  EXPECT_DEATH(
      {
        const VulkanContext context("vulkan", tracingNeeds(false));
        VkBufferCreateInfo info{};
        VkBuffer buffer = VK_NULL_HANDLE;
        context.api().vkCreateBuffer(context.device(), &info, nullptr, &buffer);
      },
      "Vulkan validation: .*VUID");
  EXPECT_DEATH(
      {
        const VulkanContext context("vulkan", tracingNeeds(false));
        const VulkanBuffer buffer = context.buffer(64, "test");
        VulkanCommands commands(context, context.queue(), context.queueFamily());
        VkCommandBuffer recording = commands.next();
        context.api().vkCmdFillBuffer(recording, buffer.get(), 0, 64, 1);
        context.api().vkCmdFillBuffer(recording, buffer.get(), 0, 64, 2);
        commands.finish();
      },
      "SYNC-HAZARD-WRITE");
}

}  // namespace
}  // namespace sightline
