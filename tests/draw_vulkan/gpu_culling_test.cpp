// Methods that cull on the GPU show what drawing everything shows, bit by bit; and the comparison sees what
// they miss.
#include "tests/draw_vulkan/drawn_city.h"

namespace sightline {
namespace {

using drawing_cases::City;

struct Replay {
  uint64_t false_pixels = 0, too_near = 0, missing = 0, shown = 0, drawn = 0, drawables = 0, triangles = 0;
};

Replay replay(const City& city, GpuMethod method, const std::vector<Camera>& path,
              const GpuCullingOptions& options) {
  VulkanDrawing drawing("vulkan", city.scene, city.parts.drawables);
  GpuCulling culling(drawing, method, options);
  DepthCheck check(drawing);
  Replay result;
  for (const Camera& camera : path) {
    culling.drawFrame(camera);
    const FrameCounts counts = culling.counts();
    const DepthDifference difference = check.compare(&culling);
    result.false_pixels += difference.false_pixels;
    result.too_near += difference.too_near_pixels;
    result.missing += difference.missing.size();
    result.shown += difference.shown.size();
    result.drawn += counts.objects;
    result.triangles += counts.triangles;
    result.drawables += culling.unitCount();
    EXPECT_EQ(counts.submits, 1u);
    EXPECT_LE(counts.triangles, city.scene.triangleCount());
  }
  return result;
}

struct Case {
  const char* name;
  GpuMethod method;
  bool mesh_shaders;
};
const Case kCases[] = {{"hiz", GpuMethod::hiz, true},
                       {"boxes", GpuMethod::boxes, true},
                       {"hiz-meshlets", GpuMethod::hizMeshlets, true},
                       {"hiz-meshlets by lists", GpuMethod::hizMeshlets, false}};

TEST(GpuCulling, ShowsWhatDrawingEverythingShows) {
  SL_SKIP_WITHOUT_DRAWING();
  const City city;
  for (const auto& [width, height, frames] : {std::array{160u, 120u, 24u}, {97u, 61u, 24u}, {1u, 1u, 8u}}) {
    const std::vector<Camera> path = city.path(frames, width, height);
    for (const Case& its : kCases) {
      const Replay result = replay(city, its.method, path, {.mesh_shaders = its.mesh_shaders});
      EXPECT_EQ(result.false_pixels, 0u) << its.name << " at " << width << " x " << height;
      EXPECT_EQ(result.too_near, 0u) << its.name;
      EXPECT_EQ(result.missing, 0u) << its.name;
      EXPECT_GT(result.shown, 0u);
      EXPECT_LT(result.drawn, result.drawables / 2) << its.name << " culls nothing";
    }
  }
}

}  // namespace
}  // namespace sightline
