// Glass, errors and times of drawing on Vulkan.
#include <cmath>

#include "core/device/registry/make_device.h"
#include "core/draw/cull_methods.h"
#include "core/draw/pvs_units.h"
#include "core/scene/scene_tree.h"
#include "core/shared/glass_colour.h"
#include "core/walk/replay.h"
#include "tests/draw_vulkan/mixed_scene.h"

namespace sightline {
namespace {

using drawing_cases::City;

template <typename Function>
std::string lineOf(Function&& function) {
  try {
    function();
  } catch (const Error& error) {
    return error.what();
  }
  return "nothing was thrown";
}

void expectParts(const std::string& line, std::initializer_list<const char*> parts) {
  for (const char* part : parts)
    EXPECT_NE(line.find(part), std::string::npos) << "no \"" << part << "\": " << line;
  EXPECT_EQ(line.find('\n'), std::string::npos) << "one line";
}

/// Panes one behind the other, some behind a wall: each pixel is what its layers, traced by hand, add up to.
TEST(Glass, IsWhatItsLayersAddUpTo) {
  SL_SKIP_WITHOUT_DRAWING();
  testing_support::SceneOfBoxes boxes;
  std::vector<SceneObject> objects;
  struct Pane {
    float left, right, distance;
  };
  const std::vector<Pane> panes = {
      {-3, 1, 4}, {-1, 3, 6}, {-2, 2, 9}, {-2.5f, 2.5f, 5}};  // the last is the wall
  for (const Pane& p : panes) {
    boxes.addRectangle({p.left, -2, -p.distance}, {p.right - p.left, 0, 0}, {0, 4, 0});
    objects.push_back({"pane", uint32_t(2 * objects.size()), 2});
  }
  // The wall covers the lower half only.
  Scene scene = boxes.finish();
  for (uint32_t i = 12; i < 16; ++i) scene.positions[i].y = std::min(scene.positions[i].y, 0.0f);
  scene.objects = objects;
  scene.surfaces.words.assign(8, kSurfaceGlass);
  scene.surfaces.words[6] = scene.surfaces.words[7] = 0;
  const City city(std::move(scene));
  const Camera camera = drawing_cases::cameraAt(city.parts, {0, 0, 0}, {0, 0, -1}, 64, 48);
  VulkanDrawing drawing("vulkan", city.scene, city.parts.drawables);
  VulkanQueryBackend backend(drawing);
  const auto expectPicture = [&](const char* what) {
    const std::vector<uint32_t> picture = drawing.readGlass();
    ASSERT_EQ(picture.size(), 64u * 48u);
    uint64_t layered = 0;
    for (uint32_t y = 0; y < 48; ++y) {
      for (uint32_t x = 0; x < 64; ++x) {
        const double a = (2 * (x + 0.5) / 64 - 1) * std::tan(M_PI / 6) * 64 / 48;
        const double b = (1 - 2 * (y + 0.5) / 48) * std::tan(M_PI / 6);
        const auto covers = [&](const Pane& p, double low, double high) {
          const double u = a * p.distance, v = b * p.distance;
          return u > p.left && u < p.right && v > low && v < high;
        };
        double colour[3] = {0, 0, 0}, through = 1;
        int layers = 0;
        for (const int pane : {2, 1, 0}) {  // from back to front
          if (!covers(panes[size_t(pane)], -2, 2)) continue;
          if (covers(panes[3], -2, 0) && panes[size_t(pane)].distance > panes[3].distance) continue;
          const vec4 glass = glassColour(uint32_t(pane));
          for (int k = 0; k < 3; ++k)
            colour[k] = glass[k] * double(glass.w) + colour[k] * (1 - double(glass.w));
          through *= 1 - double(glass.w);
          ++layers;
        }
        layered += layers > 1;
        const uint32_t pixel = picture[y * 64 + x];
        // Each layer rounds to 1/255.
        for (int k = 0; k < 3; ++k)
          EXPECT_NEAR((pixel >> 8 * k) & 255, colour[k] * 255, layers + 0.51) << what;
        EXPECT_NEAR(pixel >> 24, through * 255, layers + 0.51) << what << " at " << x << ", " << y;
      }
    }
    EXPECT_GT(layered, 200u);
  };
  backend.beginFrame(camera);
  const uint32_t order[] = {3, 2, 1, 0};
  backend.submit(order, {});
  backend.endFrame();
  expectPicture("by draws");
  for (const GpuMethod method : {GpuMethod::hiz, GpuMethod::boxes, GpuMethod::hizMeshlets}) {
    GpuCulling culling(drawing, method);
    for (int frame = 0; frame < 3; ++frame) culling.drawFrame(camera);
    expectPicture("on the GPU");
  }
}

/// Glass of a city in pictures of every kind of method: each pixel is what the panes that a ray meets add up
/// to, the farthest drawable first (by its box's middle along the view, of equally far ones the higher
/// number).
TEST(Glass, OfACityIsWhatRaysMeet) {
  SL_SKIP_WITHOUT_DRAWING();
  const City mixed(drawing_cases::withSurfaces(generateScene("city", 4000, 2), false));
  const std::vector<Drawable>& list = mixed.parts.drawables.list;
  const auto owner = drawableOfTriangles(mixed.parts.drawables);
  const Bvh bvh = buildSceneTree(mixed.scene);
  const auto tracer = makeTracer("cpu", mixed.scene, bvh);
  VulkanDrawing drawing("vulkan", mixed.scene, mixed.parts.drawables);
  VulkanQueryBackend backend(drawing);
  uint64_t compared = 0, layered = 0, number = 0;
  constexpr uint32_t kWidth = 97, kHeight = 61;
  const auto chc = cullChcPlus(mixed.parts, {});
  GpuCulling hiz(drawing, GpuMethod::hiz);
  for (const Camera& camera : mixed.path(8, kWidth, kHeight)) {
    // Nine rays a pixel: where those beside the middle meet other panes, an edge is too near to tell.
    std::vector<Ray> rays;
    for (uint32_t y = 0; y < kHeight; ++y) {
      for (uint32_t x = 0; x < kWidth; ++x) {
        for (int k = 0; k < 9; ++k)
          rays.push_back(pixelRay(camera, x, y, (k % 3 - 1) / 64.0, (k / 3 - 1) / 64.0));
      }
    }
    std::vector<Hit> hits(rays.size());
    tracer->traceRays(rays, hits);
    std::vector<std::vector<uint32_t>> panes(rays.size());
    for (const SeenThrough& seen : tracer->traceGlass(rays, hits))
      panes[seen.ray].push_back(owner[seen.triangle]);
    const glm::dvec3 eye(xyz3(camera.eye)), forward(xyz3(camera.forward));
    const auto distance = [&](uint32_t drawable) {
      const AxisBox& box = list[drawable].box;
      return glm::dot((glm::dvec3(box.low) + glm::dvec3(box.high)) * 0.5 - eye, forward);
    };
    for (auto& its : panes) {
      std::ranges::sort(its, [&](uint32_t a, uint32_t b) {
        const double da = distance(a), db = distance(b);
        return da != db ? da > db : a > b;
      });
    }
    for (const bool on_gpu : {false, true}) {
      if (on_gpu) {
        hiz.drawFrame(camera);
      } else {
        std::vector<uint32_t> drawn;
        chc->drawFrame(camera, number++, backend, drawn);
      }
      const std::vector<uint32_t> picture = drawing.readGlass();
      for (uint32_t pixel = 0; pixel < kWidth * kHeight; ++pixel) {
        const auto& its = panes[9 * pixel + 4];
        bool sure = true;
        for (int k = 0; k < 9; ++k) {
          sure = sure && panes[9 * pixel + uint32_t(k)] == its &&
                 hits[9 * pixel + uint32_t(k)].triangle == hits[9 * pixel + 4].triangle;
        }
        if (!sure) continue;
        double colour[3] = {0, 0, 0}, through = 1;
        for (const uint32_t pane : its) {
          const vec4 glass = glassColour(pane);
          for (int k = 0; k < 3; ++k)
            colour[k] = glass[k] * double(glass.w) + colour[k] * (1 - double(glass.w));
          through *= 1 - double(glass.w);
        }
        ++compared;
        layered += its.size() > 1;
        for (int k = 0; k < 3; ++k) {
          ASSERT_NEAR((picture[pixel] >> 8 * k) & 255, colour[k] * 255, double(its.size()) + 0.51)
              << (on_gpu ? "hiz " : "opti-chc++ ") << pixel;
        }
        ASSERT_NEAR(picture[pixel] >> 24, through * 255, double(its.size()) + 0.51) << pixel;
      }
    }
  }
  EXPECT_GT(compared, 2u * 8 * kWidth * kHeight / 2) << "most pixels are not on edges";
  EXPECT_GT(layered, 1000u);
}

VulkanAbilities everything() {
  VulkanAbilities all;
  all.version = VK_API_VERSION_1_2;
  for (uint32_t i = 0; i < kVulkanFeatures; ++i) {
    all.features.insert(VulkanFeature(i));
    const auto its = extensionsOf(VulkanFeature(i));
    all.extensions.insert(its.begin(), its.end());
  }
  all.queues = {VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT};
  all.timestamp_bits = {64};
  all.sub_pixel_bits = 8;
  all.group_size = 256;
  return all;
}

TEST(DrawingNeeds, WhatLacksIsNamed) {
  using enum VulkanFeature;
  EXPECT_EQ(whyUnusable(everything(), drawingNeeds()), "");
  VulkanAbilities no_tracing = everything();
  no_tracing.extensions = {};
  EXPECT_EQ(whyUnusable(no_tracing, drawingNeeds()), "") << "drawing takes no extension";
  const auto lacking = [](VulkanFeature feature) {
    VulkanAbilities abilities = everything();
    abilities.features.erase(feature);
    return abilities;
  };
  VulkanAbilities computes = everything();
  computes.queues = {VK_QUEUE_COMPUTE_BIT};
  expectParts(whyUnusable(computes, drawingNeeds()), {"no queue for graphics"});
  VulkanAbilities coarse = everything(), narrow = everything();
  coarse.sub_pixel_bits = 4;
  narrow.group_size = 128;
  expectParts(whyUnusable(coarse, drawingNeeds()), {"4 bits (subPixelPrecisionBits), 8 are needed"});
  expectParts(whyUnusable(narrow, drawingNeeds()), {"128 invocations", "256 are needed"});
  expectParts(whyUnusable(lacking(kQueryReset), drawingNeeds()), {"queries", "hostQueryReset"});
  expectParts(whyUnusable(lacking(kMultiDraw), drawingNeeds()), {"multiDrawIndirect"});
  expectParts(whyUnusable(lacking(kFirstInstance), drawingNeeds()), {"drawIndirectFirstInstance"});
  // Only the methods that take them are refused.
  for (const VulkanFeature feature : {kDrawCount, kFragmentStores, kMeshShaders, kIndependentBlend}) {
    EXPECT_EQ(whyUnusable(lacking(feature), drawingNeeds()), "");
  }
  for (const GpuMethod method : {GpuMethod::hiz, GpuMethod::hizMeshlets, GpuMethod::boxes}) {
    EXPECT_EQ(whyNotMethod(everything(), method), "");
    EXPECT_EQ(whyNotMethod(lacking(kMeshShaders), method), "") << "meshlets are drawn by lists then";
    expectParts(whyNotMethod(lacking(kDrawCount), method), {"drawIndirectCount"});
    const std::string boxes = whyNotMethod(lacking(kFragmentStores), method);
    if (method == GpuMethod::boxes) {
      expectParts(boxes, {"fragmentStoresAndAtomics"});
    } else {
      EXPECT_EQ(boxes, "");
    }
  }
}

TEST(DrawingErrors, WhatIsTooLargeIsOneLineWithSizeAndRemedy) {
  SL_SKIP_WITHOUT_DRAWING();
  const City city(1000);
  Camera camera = city.path(1, 16, 16).front();
  {
    VulkanDrawing drawing("vulkan", city.scene, city.parts.drawables);
    camera.size = {100'000, 16, 0, 0};
    expectParts(lineOf([&] { drawing.beginFrame(camera); }),
                {"vulkan:0", "100000 x 16", "a smaller resolution"});
    camera.size = {16, 16, 0, 0};  // and goes on
    VulkanQueryBackend backend(drawing);
    backend.beginFrame(camera);
    backend.endFrame();
    EXPECT_EQ(drawing.readIds().size(), 256u);
  }
  VulkanDrawing drawing("vulkan", city.scene, city.parts.drawables, {}, {.memory_budget = 40 << 20});
  camera.size = {4000, 4000, 0, 0};
  expectParts(lineOf([&] { drawing.beginFrame(camera); }),
              {"images of 4000 x 4000 pixels", "MiB", "a smaller resolution"});
  expectParts(lineOf([&] {
                VulkanDrawing("vulkan", city.scene, city.parts.drawables, {}, {.memory_budget = 20'000});
              }),
              {"of the scene", "--memory-budget"});
  expectParts(lineOf([&] { VulkanDrawing("vulkan:99", city.scene, city.parts.drawables); }), {"vulkan:99"});
}

/// Parts and rest are the frame; a clock that counts its calls says what the processor did.
TEST(DrawingTimes, PartsAddUpAndTheClockChangesNothing) {
  SL_SKIP_WITHOUT_DRAWING();
  const City city;
  double ticks = 0;
  VulkanDrawing timed("vulkan", city.scene, city.parts.drawables, {}, {.clock = [&] { return ticks += 1; }});
  VulkanDrawing untimed("vulkan", city.scene, city.parts.drawables);
  GpuCulling with(timed, GpuMethod::hiz), without(untimed, GpuMethod::hiz);
  for (const Camera& camera : city.path(4, 64, 48)) {
    with.drawFrame(camera);
    without.drawFrame(camera);
    EXPECT_EQ(with.counts(), without.counts());
    EXPECT_EQ(timed.readDepth(), untimed.readDepth());
    EXPECT_EQ(timed.readIds(), untimed.readIds());
    const GpuTimes gpu = timed.ring().gpuTimes(timed.frame());
    if (!timed.context().hasTimestamps()) continue;
    EXPECT_GT(gpu.frame, 0);
    EXPECT_GE(gpu.rest, -1e-9);
    double sum = gpu.rest;
    for (const double part : gpu.part) {
      EXPECT_GE(part, 0);
      sum += part;
    }
    EXPECT_NEAR(sum, gpu.frame, 1e-9 * gpu.frame);
    EXPECT_GT(gpu.part[size_t(GpuPart::pyramid)], 0);
    EXPECT_EQ(gpu.part[size_t(GpuPart::query)], 0);
  }
  const CpuTimes& cpu = timed.ring().cpuTimes();
  EXPECT_GT(cpu.record, 0);
  EXPECT_GT(cpu.submit, 0);
  EXPECT_EQ(untimed.ring().cpuTimes().record + untimed.ring().cpuTimes().submit, 0);
}

}  // namespace
}  // namespace sightline
