// Id images: each device's pixels are the hits of the rays that viewRay makes on the host.
#include <gtest/gtest.h>

#include <cmath>

#include "core/device/registry/make_device.h"
#include "core/generate/generate.h"
#include "core/trace/cpu_tracer.h"
#include "tests/backend/trace_cases.h"
#include "tests/support/vulkan.h"

namespace sightline {
namespace {

using testing_support::Random;
using testing_support::soup;

std::vector<ViewFrame> randomFrames(Random& random, int count) {
  std::vector<ViewFrame> frames;
  for (int i = 0; i < count; ++i) {
    const vec3 forward = glm::normalize(random.point(1) + vec3(1e-3f)),
               right = glm::normalize(glm::cross(forward, random.point(1))), up = glm::cross(right, forward);
    const float tangent = 0.2f + 2 * random.unit();
    frames.push_back(
        {vec4(random.point(1.5f), 0), vec4(forward, 0), vec4(right * tangent, 0), vec4(up * tangent, 0)});
  }
  return frames;
}

std::vector<uint32_t> reference(const CpuTracer& tracer, const std::vector<ViewFrame>& frames,
                                uint32_t resolution) {
  std::vector<uint32_t> triangles;
  for (const ViewFrame& frame : frames) {
    for (uint32_t y = 0; y < resolution; ++y) {
      for (uint32_t x = 0; x < resolution; ++x) {
        triangles.push_back(tracer.trace(viewRay(frame, x, y, resolution)).triangle);
      }
    }
  }
  return triangles;
}

class Views : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    if (isVulkan()) SL_SKIP_WITHOUT_VULKAN();
  }
  static bool isVulkan() { return std::string(GetParam()).starts_with("vulkan"); }

  /// On Vulkan, where the driver intersects, 1 pixel in 500 may differ, at edges.
  static void expectImages(const Scene& scene, const std::vector<ViewFrame>& frames, uint32_t resolution) {
    const Bvh bvh = buildBvh(scene.positions, scene.triangles);
    DeviceOptions options;
    options.ray_queries = std::string(GetParam()) == "vulkan queries";
    const auto device = makeDevice(isVulkan() ? "vulkan" : GetParam(), scene, bvh, options);
    const std::vector<uint32_t> expected = reference(CpuTracer(scene, bvh), frames, resolution);
    for (int run = 0; run < 2; ++run) {
      std::vector<uint32_t> actual(expected.size(), 12345u);
      device->traceViews(frames, resolution, actual);
      size_t different = 0, hits = 0;
      for (size_t i = 0; i < expected.size(); ++i) {
        hits += expected[i] != kNoTriangle;
        different += actual[i] != expected[i];
        if (!isVulkan()) {
          ASSERT_EQ(actual[i], expected[i]) << "pixel " << i << " at resolution " << resolution;
        }
      }
      EXPECT_LE(different, expected.size() / 500) << "at resolution " << resolution;
      if (resolution > 8) {
        EXPECT_GT(hits, expected.size() / 20);
      }
    }
  }
};

TEST_P(Views, ShowWhatTheRaysOfTheirPixelsHit) {
  Random random(77);
  const Scene scene = soup(random, 400, 0.7f, 0.3f);
  for (const uint32_t resolution : {1u, 2u, 7u, 8u, 33u, 100u}) {
    expectImages(scene, randomFrames(random, 9), resolution);
  }
}

TEST_P(Views, ManyViewsOfAFewPixels) {
  Random random(78);
  expectImages(soup(random, 100, 1.5f, 0.5f), randomFrames(random, 3000), 3);
}

INSTANTIATE_TEST_SUITE_P(All, Views, testing::Values("cpu", "opencl", "vulkan", "vulkan queries"),
                         [](const auto& device) {
                           std::string name = device.param;
                           std::replace(name.begin(), name.end(), ' ', '_');
                           return name;
                         });

/// The tiles cover each pixel of an image once; packets of 8 lie side by side.
TEST(ViewPixel, CoversTheImageOnce) {
  for (const uint32_t resolution : {1u, 3u, 4u, 8u, 9u, 31u, 64u}) {
    std::vector<int> seen(size_t(resolution) * resolution, 0);
    for (uint32_t item = 0; item < viewItems(resolution); ++item) {
      const uint32_t pixel = viewPixel(item, resolution);
      if (pixel == kNoTriangle) continue;
      ASSERT_LT(pixel, seen.size());
      ++seen[pixel];
      const uint32_t first = viewPixel(item / 8 * 8, resolution);
      EXPECT_LT(pixel % resolution - first % resolution, 4u);
      EXPECT_LT(pixel / resolution - first / resolution, 2u);
    }
    for (const int count : seen) ASSERT_EQ(count, 1) << "resolution " << resolution;
  }
}

/// Corners of the image lie where the frame says; rows go down, columns to the right.
TEST(ViewRay, GoesThroughThePixelsCentre) {
  const ViewFrame frame = {vec4(1, 2, 3, 0), vec4(0, 0, -1, 0), vec4(0.5f, 0, 0, 0), vec4(0, 0.5f, 0, 0)};
  const Ray corner = viewRay(frame, 0, 0, 4), last = viewRay(frame, 3, 3, 4),
            middle = viewRay(frame, 1, 1, 3);
  EXPECT_EQ(corner.origin, vec4(1, 2, 3, 0));
  EXPECT_EQ(corner.direction, vec4(-1.5f, 1.5f, -4, 0));
  EXPECT_EQ(last.direction, vec4(1.5f, -1.5f, -4, 0));
  EXPECT_EQ(middle.direction, vec4(0, 0, -3, 0));
}

}  // namespace
}  // namespace sightline
