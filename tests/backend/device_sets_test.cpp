// The sets of found triangles in the memory of OpenCL and Vulkan devices.
#include <gtest/gtest.h>

#include "core/base/error.h"
#include "core/device/opencl/opencl_scene.h"
#include "core/device/opencl/opencl_set.h"
#include "core/device/vulkan/tracing_needs.h"
#include "core/device/vulkan/vulkan_set.h"
#include "tests/support/vulkan.h"

namespace sightline {
namespace {

constexpr uint32_t kTriangles = 1000;

/// An array has room for every triangle. What overflows there is a thread that lost every race for a slot;
/// growing must leave the array as it is, for the launch comes again.
TEST(OpenClSetTest, AnArrayDoesNotGrow) {
  if (listOpenClDevices().empty()) GTEST_SKIP() << "no OpenCL device";
  OpenClContext context("opencl");
  buildKernels(context, 1);
  const ClBuffer overflow = context.buffer(4, "overflow");
  context.fill(overflow, 1, 4);
  OpenClSet set(context, overflow, kTriangles, false);
  const uint32_t winner = 7;
  context.write(set.winner(), &winner, 4, 42 * 4);
  set.grow(4);
  EXPECT_EQ(set.capacity(), 0u);
  ASSERT_EQ(set.winner().bytes(), kTriangles * 4);
  uint32_t kept = 0;
  context.read(set.winner(), &kept, 4, 42 * 4);
  EXPECT_EQ(kept, winner);
}

TEST(VulkanSetTest, AnArrayDoesNotGrow) {
  SL_SKIP_WITHOUT_VULKAN();
  const VulkanContext context("vulkan", tracingNeeds(false));
  VulkanRunner runner(context);
  VulkanSet set(context, runner, kTriangles, false);
  const uint64_t winner = runner.launch.winner, bytes = context.allocatedBytes();
  set.grow(4);
  EXPECT_EQ(set.capacity(), 0u);
  EXPECT_EQ(runner.launch.winner, winner);
  EXPECT_EQ(context.allocatedBytes(), bytes);
}

/// 2^16 slots times 2^16 are none in 32 bits.
TEST(OpenClSetTest, GrowingPastTheLargestTableIsAnError) {
  if (listOpenClDevices().empty()) GTEST_SKIP() << "no OpenCL device";
  OpenClContext context("opencl");
  buildKernels(context, 1);
  const ClBuffer overflow = context.buffer(4, "overflow");
  context.fill(overflow, 0, 4);
  OpenClSet set(context, overflow, kTriangles, true);
  const uint32_t capacity = set.capacity();
  EXPECT_THROW(set.grow(1u << 16), Error);
  EXPECT_EQ(set.capacity(), capacity);
  EXPECT_EQ(set.winner().bytes(), capacity * 4);
}

TEST(VulkanSetTest, GrowingPastTheLargestTableIsAnError) {
  SL_SKIP_WITHOUT_VULKAN();
  const VulkanContext context("vulkan", tracingNeeds(false));
  VulkanRunner runner(context);
  VulkanSet set(context, runner, kTriangles, true);
  const uint32_t capacity = set.capacity();
  const uint64_t bytes = context.allocatedBytes();
  EXPECT_THROW(set.grow(1u << 16), Error);
  EXPECT_EQ(set.capacity(), capacity);
  EXPECT_EQ(context.allocatedBytes(), bytes);
}

}  // namespace
}  // namespace sightline
