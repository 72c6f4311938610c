// The sets of found triangles in the memory of GPUs.
#include <gtest/gtest.h>

#include "core/base/error.h"
#include "core/device/gpu/gpu_set.h"
#include "core/device/opencl/opencl_stages.h"
#include "core/device/vulkan/vulkan_stages.h"
#include "core/generate/generate.h"
#include "tests/support/vulkan.h"

namespace sightline {
namespace {

constexpr uint32_t kTriangles = 1000;

template <typename Api>
class GpuSetTest : public testing::Test {
 protected:
  static constexpr bool kOpenCl = std::is_same_v<Api, OpenClStages>;

  void SetUp() override {
    if (kOpenCl && listOpenClDevices().empty()) GTEST_SKIP() << "no OpenCL device";
    if (!kOpenCl) SL_SKIP_WITHOUT_VULKAN();
    const Scene scene = generateScene("bistro", kTriangles, 1);
    api_ = std::make_unique<Api>(kOpenCl ? "opencl" : "vulkan", scene,
                                 buildBvh(scene.positions, scene.triangles), DeviceOptions{});
  }

  std::unique_ptr<Api> api_;
};

using Apis = testing::Types<OpenClStages, VulkanStages>;
TYPED_TEST_SUITE(GpuSetTest, Apis);

/// An array has room for every triangle. What overflows there is a thread that lost every race for a slot;
/// growing must leave the array as it is, for the launch comes again.
TYPED_TEST(GpuSetTest, AnArrayDoesNotGrow) {
  GpuSet<TypeParam> set(*this->api_, kTriangles, false);
  const uint64_t bytes = this->api_->allocatedBytes();
  this->api_->fill(set.winner(), 7, kTriangles * 4);
  set.grow(4);
  EXPECT_EQ(set.capacity(), 0u);
  EXPECT_EQ(this->api_->launch().capacity, 0u);
  EXPECT_EQ(this->api_->allocatedBytes(), bytes);
  ASSERT_EQ(set.winner().bytes(), kTriangles * 4);
  std::vector<uint32_t> kept(kTriangles);
  this->api_->read(set.winner(), kept.data(), kTriangles * 4);
  EXPECT_EQ(kept, std::vector<uint32_t>(kTriangles, 7));
}

/// 2^16 slots times 2^16 are none in 32 bits.
TYPED_TEST(GpuSetTest, GrowingPastTheLargestTableIsAnError) {
  GpuSet<TypeParam> set(*this->api_, kTriangles, true);
  const uint32_t capacity = set.capacity();
  const uint64_t bytes = this->api_->allocatedBytes();
  EXPECT_THROW(set.grow(1u << 16), Error);
  EXPECT_EQ(set.capacity(), capacity);
  EXPECT_EQ(set.winner().bytes(), capacity * 4);
  EXPECT_EQ(this->api_->allocatedBytes(), bytes);
}

/// What a larger table holds is what the smaller one held.
TYPED_TEST(GpuSetTest, GrowingKeepsTheContents) {
  GpuSet<TypeParam> set(*this->api_, kTriangles, true);
  const uint32_t capacity = set.capacity();
  std::vector<uint32_t> list(kTriangles);
  for (uint32_t i = 0; i < kTriangles; ++i) list[i] = i;
  auto indices = this->api_->buffer(kTriangles * 4, "triangles");
  auto entries = this->api_->buffer(kTriangles * sizeof(PvsEntry), "entries");
  this->api_->write(indices, list.data(), kTriangles * 4);
  this->api_->bind(StageBuffer::indices, indices);
  this->api_->bind(StageBuffer::entries, entries);
  this->api_->launch().list_end = 0;
  this->api_->run(GpuStage::kInsertContained, kTriangles);
  EXPECT_EQ(this->api_->takeCounters()[kOverflowCounter], 0u);
  set.grow(4);
  ASSERT_EQ(set.capacity(), capacity * 4);
  std::vector<uint32_t> winner(set.capacity());
  this->api_->read(set.winner(), winner.data(), winner.size() * 4);
  EXPECT_EQ(std::count(winner.begin(), winner.end(), kSlotOld), kTriangles);
  EXPECT_EQ(std::count(winner.begin(), winner.end(), kSlotEmpty), winner.size() - kTriangles);
}

}  // namespace
}  // namespace sightline
