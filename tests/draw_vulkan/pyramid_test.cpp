// The pyramid against the least depth of all pixels that each texel covers, by brute force.
#include "core/shared/pyramid.h"

#include <cstring>

#include "core/draw/vulkan/depth_pyramid.h"
#include "tests/draw_vulkan/drawn_city.h"
#include "tests/support/random_triangles.h"

namespace sightline {
namespace {

using testing_support::Random;

struct Pyramid {
  uint32_t width, height;
  uint64_t first;  ///< in all texels
};

uint32_t texelsOf(uint32_t width, uint32_t height) {
  return levelStart(width, height, pyramidLevels(width, height));
}

/// Builds them on the device from random depths; returns all texels.
std::vector<float> build(VulkanDrawing& drawing, const std::vector<Pyramid>& pyramids, bool floor_levels) {
  const VulkanContext& context = drawing.context();
  std::vector<float> texels(pyramids.back().first + texelsOf(pyramids.back().width, pyramids.back().height),
                            -1);
  Random random(7);
  for (const Pyramid& p : pyramids) {
    for (uint32_t i = 0; i < p.width * p.height; ++i) texels[p.first + i] = random.unit();
  }
  const VulkanBuffer buffer = context.buffer(4 * texels.size(), "pyramids");
  const VulkanBuffer readback = context.buffer(4 * texels.size(), "pyramids", VulkanMemory::kReadback);
  VulkanUpload upload(context);
  upload.write(buffer, texels.data(), 4 * texels.size());
  upload.finish();
  VulkanCommands commands(context, context.queue(), context.queueFamily());
  for (const Pyramid& p : pyramids) {
    recordPyramid(drawing, commands.next(), buffer.address() + 4 * p.first, p.width, p.height, floor_levels);
  }
  commands.copy(buffer, readback, 4 * texels.size());
  commands.finish();
  std::memcpy(texels.data(), readback.mapped(), 4 * texels.size());
  return texels;
}

/// Texels that do not hold the least depth of their pixels.
uint64_t wrongTexels(const Pyramid& p, const std::vector<float>& texels) {
  uint64_t wrong = 0;
  for (uint32_t level = 1; level < pyramidLevels(p.width, p.height); ++level) {
    const uint32_t side = 1u << level, columns = (p.width + side - 1) / side,
                   rows = (p.height + side - 1) / side;
    const float* found = &texels[p.first + levelStart(p.width, p.height, level)];
    for (uint32_t y = 0; y < rows; ++y) {
      for (uint32_t x = 0; x < columns; ++x) {
        float least = 2;
        for (uint32_t v = y * side; v < std::min((y + 1) * side, p.height); ++v) {
          for (uint32_t u = x * side; u < std::min((x + 1) * side, p.width); ++u) {
            least = std::min(least, texels[p.first + v * p.width + u]);
          }
        }
        wrong += found[y * columns + x] != least;
      }
    }
    if (level + 1 == pyramidLevels(p.width, p.height)) {
      EXPECT_EQ(columns * rows, 1u) << "the last level is a texel";
    }
  }
  return wrong;
}

std::vector<Pyramid> allSizes(uint32_t most) {
  std::vector<Pyramid> pyramids;
  uint64_t first = 0;
  for (uint32_t height = 1; height <= most; ++height) {
    for (uint32_t width = 1; width <= most; ++width) {
      pyramids.push_back({width, height, first});
      first += texelsOf(width, height);
    }
  }
  return pyramids;
}

struct Device {
  Scene scene;
  Drawables drawables;
  VulkanDrawing drawing;
  explicit Device()
      : scene(oneTriangle()), drawables(partitionScene(scene)), drawing("vulkan", scene, drawables) {}
  static Scene oneTriangle() {
    testing_support::SceneOfBoxes boxes;
    boxes.addTriangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    return boxes.finish();
  }
};

TEST(DepthPyramid, HoldsTheLeastOfAllPixelsAtEverySize) {
  SL_SKIP_WITHOUT_DRAWING();
  Device device;
  const std::vector<Pyramid> pyramids = allSizes(67);
  const std::vector<float> texels = build(device.drawing, pyramids, false);
  for (const Pyramid& p : pyramids) EXPECT_EQ(wrongTexels(p, texels), 0u) << p.width << " x " << p.height;
}

TEST(DepthPyramid, HoldsTheLeastOfLargeImages) {
  SL_SKIP_WITHOUT_DRAWING();
  Device device;
  std::vector<Pyramid> pyramids;
  uint64_t first = 0;
  for (const auto& [width, height] : {std::pair{1279u, 719u}, {1000u, 3u}, {1u, 4099u}, {4097u, 65u}}) {
    pyramids.push_back({width, height, first});
    first += texelsOf(width, height);
  }
  const std::vector<float> texels = build(device.drawing, pyramids, false);
  for (const Pyramid& p : pyramids) EXPECT_EQ(wrongTexels(p, texels), 0u) << p.width << " x " << p.height;
}

TEST(DepthPyramid, TheTestSeesDroppedColumns) {
  SL_SKIP_WITHOUT_DRAWING();
  Device device;
  const std::vector<Pyramid> pyramids = allSizes(9);
  const std::vector<float> texels = build(device.drawing, pyramids, true);
  uint64_t wrong = 0;
  for (const Pyramid& p : pyramids) {
    const uint64_t here = wrongTexels(p, texels);
    if ((p.width & (p.width - 1)) == 0 && (p.height & (p.height - 1)) == 0) {
      EXPECT_EQ(here, 0u);
    }
    wrong += here;
  }
  EXPECT_GT(wrong, 0u);
}

/// A run of pixels touches at most four texels of its level, and more than four of the one below.
TEST(DepthPyramid, TakesTheFinestLevelOfARun) {
  for (uint32_t first = 0; first < 40; ++first) {
    for (uint32_t last = first; last < 90; ++last) {
      const uint32_t level = levelOfRun(first, last);
      EXPECT_LE((last >> level) - (first >> level), 3u);
      if (level > 0) {
        EXPECT_GT((last >> (level - 1)) - (first >> (level - 1)), 3u);
      }
    }
  }
}

}  // namespace
}  // namespace sightline
