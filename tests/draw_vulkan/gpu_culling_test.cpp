// Methods that cull on the GPU show what drawing everything shows, bit by bit; and the comparison sees what
// they miss.
#include "core/shared/box_extent.h"
#include "tests/draw_vulkan/mixed_scene.h"
#include "tests/support/random_triangles.h"

namespace sightline {
namespace {

using drawing_cases::City;
using drawing_cases::withSurfaces;

struct Replay {
  uint64_t false_pixels = 0, too_near = 0, missing = 0, shown = 0, drawn = 0, units = 0, triangles = 0;
  std::vector<FrameCounts> counts;
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
    result.units += culling.unitCount();
    result.counts.push_back(counts);
    EXPECT_EQ(counts.submits, 1u);
    EXPECT_EQ(difference.false_pixels == 0, difference.missing.empty());
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

void expectExact(const City& city, const std::vector<Camera>& path, std::span<const Case> cases) {
  for (const Case& its : cases) {
    SCOPED_TRACE(its.name);
    const Replay result = replay(city, its.method, path, {.mesh_shaders = its.mesh_shaders});
    EXPECT_EQ(result.false_pixels, 0u);
    EXPECT_EQ(result.too_near, 0u);
    EXPECT_EQ(result.missing, 0u);
    EXPECT_GT(result.shown, 0u);
    EXPECT_LT(result.drawn, result.units * 2 / 3) << "culls nothing";
    EXPECT_GE(result.triangles, result.drawn);
    EXPECT_LT(result.triangles, path.size() * city.scene.triangleCount());
  }
}

TEST(GpuCulling, ShowsWhatDrawingEverythingShows) {
  SL_SKIP_WITHOUT_DRAWING();
  const City city;
  for (const auto& [width, height, frames] : {std::array{160u, 120u, 24u}, {97u, 61u, 24u}, {1u, 1u, 8u}}) {
    SCOPED_TRACE(testing::Message() << width << " x " << height);
    expectExact(city, city.path(frames, width, height), kCases);
  }
}

TEST(GpuCulling, KnowsGlassHolesAndSides) {
  SL_SKIP_WITHOUT_DRAWING();
  const City mixed(withSurfaces(generateScene("city", 4000, 2), false));
  expectExact(mixed, mixed.path(12, 97, 61), kCases);
  const City sides(withSurfaces(generateScene("city", 4000, 2), true));
  expectExact(sides, sides.path(12, 97, 61), std::span(kCases).first(2));
  VulkanDrawing drawing("vulkan", sides.scene, sides.parts.drawables);
  EXPECT_THROW(GpuCulling(drawing, GpuMethod::hizMeshlets), Error);
}

/// The picture is exact in the frame after a cut, too; the first pass then draws what is out of the way.
TEST(GpuCulling, TheSameFramesGiveTheSameCounts) {
  SL_SKIP_WITHOUT_DRAWING();
  const City city;
  for (const Case& its : kCases) {
    const auto once =
        replay(city, its.method, city.path(10, 97, 61), {.mesh_shaders = its.mesh_shaders}).counts;
    const auto again =
        replay(city, its.method, city.path(10, 97, 61), {.mesh_shaders = its.mesh_shaders}).counts;
    EXPECT_EQ(once, again) << its.name;
  }
}

TEST(GpuCulling, ForgetsAsIfJustMade) {
  SL_SKIP_WITHOUT_DRAWING();
  const City city;
  const std::vector<Camera> path = city.path(6, 97, 61);
  VulkanDrawing drawing("vulkan", city.scene, city.parts.drawables);
  GpuCulling culling(drawing, GpuMethod::hiz);
  std::vector<FrameCounts> counts[2];
  for (auto& its : counts) {
    culling.forget();
    for (const Camera& camera : path) {
      culling.drawFrame(camera);
      its.push_back(culling.counts());
    }
  }
  EXPECT_EQ(counts[0], counts[1]);
}

/// What the test calls hidden is hidden: at each pixel that its box may touch, the full depth is nearer.
TEST(GpuCulling, EveryHiddenBoxLiesBehindTheFullDepth) {
  SL_SKIP_WITHOUT_DRAWING();
  const City city;
  for (const Case& its : kCases) {
    VulkanDrawing drawing("vulkan", city.scene, city.parts.drawables);
    GpuCulling culling(drawing, its.method, {.mesh_shaders = its.mesh_shaders});
    DepthCheck check(drawing);
    uint64_t hidden = 0;
    for (const Camera& camera : city.path(10, 97, 61)) {
      culling.drawFrame(camera);
      const std::vector<uint32_t> seen = culling.readSeen();
      check.compare(&culling);
      const std::vector<float> depth = check.referenceDepth();
      for (uint32_t i = 0; i < seen.size(); ++i) {
        const CullUnit& unit = culling.units().units[i];
        const BoxExtent box = boxExtent(camera, glm::vec3(unit.low), glm::vec3(unit.high));
        if (seen[i] != 0 || box.place != kBoxAhead) continue;
        ++hidden;
        // What drawn boxes find hidden is judged by their drawn faces; these may be as near as the extent
        // says.
        if (its.method == GpuMethod::boxes) continue;
        for (uint32_t y = box.pixels.y; y <= box.pixels.w; ++y) {
          for (uint32_t x = box.pixels.x; x <= box.pixels.z; ++x) {
            ASSERT_GT(depth[y * camera.size.x + x], box.depth) << its.name << ", unit " << i;
          }
        }
      }
    }
    EXPECT_GT(hidden, 100u) << its.name;
  }
}

/// The tests of the tests: each fault must show.
TEST(GpuCulling, PlantedFaultsRaiseFalsePixels) {
  SL_SKIP_WITHOUT_DRAWING();
  const City city(20'000);
  const std::vector<Camera> path = city.path(24, 159, 119);
  const auto falsePixels = [&](GpuMethod method, const GpuCullingFaults& faults) {
    return replay(city, method, path, {.faults = faults}).false_pixels;
  };
  EXPECT_GT(falsePixels(GpuMethod::hiz, {.no_second_pass = true}), 0u);
  EXPECT_GT(falsePixels(GpuMethod::boxes, {.no_second_pass = true}), 0u);
  EXPECT_GT(falsePixels(GpuMethod::hizMeshlets, {.no_second_pass = true}), 0u);
  EXPECT_GT(falsePixels(GpuMethod::hiz, {.shrink_pixels = 1}), 0u);
  EXPECT_GT(falsePixels(GpuMethod::boxes, {.shrink_pixels = 1}), 0u);
}

/// A wall that hides all but the last column of pixels, at a width where each level has a last texel of its
/// own for it.
TEST(GpuCulling, SeesThroughTheLastColumn) {
  SL_SKIP_WITHOUT_DRAWING();
  testing_support::SceneOfBoxes boxes;
  boxes.addRectangle({-20, -20, -5}, {25.5f, 0, 0}, {0, 40, 0});
  boxes.addRectangle({-12, -3, -10}, {24, 0, 0}, {0, 6, 0});
  Scene scene = boxes.finish();
  scene.objects = {{"wall", 0, 2}, {"behind", 2, 2}};
  const City city(std::move(scene));
  const std::vector<Camera> still(4, drawing_cases::cameraAt(city.parts, {0, 0, 0}, {0, 0, -1}, 65, 33));
  for (const Case& its : kCases) {
    const Replay right = replay(city, its.method, still, {.mesh_shaders = its.mesh_shaders});
    EXPECT_EQ(right.false_pixels, 0u) << its.name;
    EXPECT_EQ(right.shown, 8u) << "both show";
  }
  EXPECT_GT(replay(city, GpuMethod::hiz, still, {.faults = {.floor_levels = true}}).false_pixels, 0u);
}

/// Views without any coherence: from anywhere, through walls, straight up and down.
TEST(GpuCulling, ShowsEverythingFromAnywhere) {
  SL_SKIP_WITHOUT_DRAWING();
  const City city;
  const AxisBox bounds = boundsOf(city.parts.drawables);
  testing_support::Random random(5);
  std::vector<Camera> views;
  while (views.size() < 60) {
    const glm::dvec3 share(random.unit(), random.unit() * 1.5f, random.unit());
    const glm::dvec3 eye =
        glm::dvec3(bounds.low) + share * (glm::dvec3(bounds.high) - glm::dvec3(bounds.low));
    const glm::dvec3 along =
        views.size() % 10 == 0 ? glm::dvec3(0, views.size() % 20 ? 1 : -1, 0) : glm::dvec3(random.point(1));
    views.push_back(drawing_cases::cameraAt(city.parts, eye, eye + along, 47, 33));
  }
  expectExact(city, views, kCases);
}

/// Frames that nobody waits for come one after another, and the last is as if each had been waited for.
TEST(GpuCulling, FramesInFlightChangeNothing) {
  SL_SKIP_WITHOUT_DRAWING();
  const City city;
  const std::vector<Camera> path = city.path(100, 97, 61);
  for (const Case& its : kCases) {
    std::vector<float> depth[2];
    std::vector<uint32_t> ids[2];
    for (const bool waits : {false, true}) {
      VulkanDrawing drawing("vulkan", city.scene, city.parts.drawables);
      GpuCulling culling(drawing, its.method, {.mesh_shaders = its.mesh_shaders});
      for (const Camera& camera : path) {
        culling.drawFrame(camera);
        if (waits) drawing.ring().drain();
      }
      depth[waits] = drawing.readDepth();
      ids[waits] = drawing.readIds();
    }
    EXPECT_EQ(depth[0], depth[1]) << its.name;
    EXPECT_EQ(ids[0], ids[1]) << its.name;
  }
}

/// With candidates nothing else is drawn, and of them all that shows: as if they were the scene.
TEST(GpuCulling, DrawsCandidatesOnly) {
  SL_SKIP_WITHOUT_DRAWING();
  const City city;
  VulkanDrawing drawing("vulkan", city.scene, city.parts.drawables);
  std::vector<uint32_t> odd, even;
  for (uint32_t i = 0; i < city.parts.drawables.list.size(); ++i) (i % 2 ? odd : even).push_back(i);
  for (const Case& its : kCases) {
    GpuCulling culling(drawing, its.method, {.mesh_shaders = false});
    VulkanQueryBackend backend(drawing);
    uint32_t frame = 0;
    for (const Camera& camera : city.path(8, 97, 61)) {
      const std::vector<uint32_t>& candidates = frame < 4 ? odd : even;
      culling.drawFrame(camera, candidates, frame % 4 == 0);
      ++frame;
      const std::vector<float> depth = drawing.readDepth();
      backend.beginFrame(camera);
      backend.submit(candidates, {});
      backend.endFrame();
      EXPECT_EQ(depth, drawing.readDepth()) << its.name << ", frame " << frame;
    }
    culling.drawFrame(city.path(8, 97, 61).front(), {}, true);
    EXPECT_EQ(culling.counts().draws, 0u);
    EXPECT_EQ(drawing.readIds(), std::vector<uint32_t>(97 * 61, kNoDrawable))
        << "no candidates, nothing drawn";
    culling.drawFrame(city.path(8, 97, 61).front());
    EXPECT_EQ(DepthCheck(drawing).compare(&culling).false_pixels, 0u) << "all may be drawn again";
  }
}

/// Commands are recorded once for frames that have them in common, and anew for other images and candidates;
/// no frame differs from one that draws everything.
TEST(GpuCulling, RecordsOnce) {
  SL_SKIP_WITHOUT_DRAWING();
  const City mixed(drawing_cases::withSurfaces(generateScene("city", 4000, 2), false));
  VulkanDrawing drawing("vulkan", mixed.scene, mixed.parts.drawables);
  DepthCheck check(drawing);
  for (const GpuMethod method : {GpuMethod::hiz, GpuMethod::boxes, GpuMethod::hizMeshlets}) {
    GpuCulling culling(drawing, method);
    const auto draw = [&](uint32_t frames, uint32_t width, uint32_t height) {
      const uint64_t before = drawing.ring().recordings();
      for (const Camera& camera : mixed.path(frames, width, height)) {
        culling.drawFrame(camera);
        EXPECT_EQ(check.compare(&culling).false_pixels, 0u);
      }
      return drawing.ring().recordings() - before;
    };
    EXPECT_EQ(draw(20, 97, 61), 2u) << "the first frame forgets";
    EXPECT_EQ(draw(20, 97, 61), 0u);
    EXPECT_EQ(draw(8, 160, 120), 1u);
    culling.forget();
    EXPECT_EQ(draw(8, 160, 120), 1u) << "what was recorded before is there still";
    // Frames under way: as many recordings, not more.
    const uint64_t before = drawing.ring().recordings();
    for (const Camera& camera : mixed.path(60, 160, 120)) {
      culling.drawFrame(camera);
      drawing.ring().gpuTimes(drawing.frame() - 2);
    }
    EXPECT_LE(drawing.ring().recordings() - before, 3u);
    // Candidates: recorded anew where they change.
    std::vector<uint32_t> all(mixed.parts.drawables.list.size());
    std::iota(all.begin(), all.end(), 0u);
    const uint64_t without = drawing.ring().recordings();
    for (int frame = 0; frame < 9; ++frame) {
      culling.drawFrame(mixed.path(8, 97, 61)[3], all, frame % 4 == 3);
      EXPECT_EQ(check.compare(&culling).false_pixels, 0u);
    }
    EXPECT_EQ(drawing.ring().recordings() - without, 4u) << "the first, two changes, and what is in common";
  }
}

/// Every triangle of an opaque drawable is in one meshlet, whose box holds it; the words of a meshlet name
/// the same.
TEST(CullUnits, MeshletsHoldTheDrawablesTriangles) {
  const City city;
  const CullUnits units = meshletUnits(city.scene, city.parts.drawables);
  EXPECT_LE(units.units.size(), mostMeshletUnits(city.parts.drawables));
  EXPECT_GT(units.units.size(), mostMeshletUnits(city.parts.drawables) / 4) << "and no wild guess";
  std::map<uint32_t, std::multiset<std::array<uint32_t, 3>>> found, expected;
  const auto add = [](auto& to, uint32_t drawable, glm::uvec3 t) {
    while (t.x > t.y || t.x > t.z) t = {t.y, t.z, t.x};  // which corner is first says nothing
    to[drawable].insert({t.x, t.y, t.z});
  };
  for (uint32_t d = 0; d < city.parts.drawables.list.size(); ++d) {
    for (const uint32_t id : city.parts.drawables.trianglesOf(d))
      add(expected, d, city.scene.vertexNumbers(id));
  }
  for (const CullUnit& unit : units.units) {
    const uint32_t* words = &units.words[unit.run.w];
    ASSERT_LE(words[0], kMeshletVertices);
    ASSERT_LE(unit.run.y, kMeshletTriangles);
    for (uint32_t i = 0; i < unit.run.y; ++i) {
      const uint32_t corners = words[1 + words[0] + i];
      glm::uvec3 t, by_words;
      for (int k = 0; k < 3; ++k) {
        t[k] = units.indices[3 * (unit.run.x + i) + uint32_t(k)];
        by_words[k] = words[1 + (corners >> 8 * k & 255)];
        const glm::vec3 p = city.scene.positions[t[k]];
        EXPECT_TRUE(glm::all(glm::lessThanEqual(glm::vec3(unit.low), p)) &&
                    glm::all(glm::lessThanEqual(p, glm::vec3(unit.high))));
      }
      EXPECT_EQ(t, by_words);
      add(found, unit.run.z, t);
    }
  }
  EXPECT_EQ(found, expected);
}

}  // namespace
}  // namespace sightline
