// The method raster: drawn hemicubes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/base/error.h"
#include "core/device/registry/make_device.h"
#include "core/generate/generate.h"
#include "core/sampling/hemicube.h"
#include "core/shared/vector.h"
#include "core/vulkan/vulkan_devices.h"
#include "tests/support/bake_scene.h"
#include "tests/support/boxes.h"
#include "tests/support/random_triangles.h"
#include "tests/support/vulkan.h"

namespace sightline {
namespace {

using testing_support::bakeOn;
using testing_support::idRange;
using testing_support::quickParams;
using testing_support::Random;
using testing_support::SceneOfBoxes;

class Raster : public testing::Test {
 protected:
  void SetUp() override { SL_SKIP_WITHOUT_VULKAN(); }

  static BakeParams params(uint32_t resolution = 64) {
    BakeParams p = quickParams();
    p.method = Method::kRaster;
    p.raster_resolution = resolution;
    p.n_rand = 20 * hemicubeSamples(resolution);
    p.validation_rays = 20'000;
    return p;
  }
};

TEST_F(Raster, SeesAClosedRoomAndNothingBeyond) {
  SceneOfBoxes boxes;
  const uint32_t room = boxes.addBox({-5, 0, -5}, {5, 3, 5});
  boxes.addBox({-50, -1, 6}, {50, 40, 7});
  boxes.addBox({5.001f, 0, -5}, {6, 3, 5});
  const CellPvs pvs = bakeOn("vulkan", boxes.finish(), {"cell", {0, 1.5, 0}, {1, 1, 1}}, params());
  EXPECT_EQ(pvs.triangles, idRange(room, 12));
  EXPECT_EQ(pvs.stats.missing_rays, 0u);
  EXPECT_EQ(pvs.stats.random.rays, uint64_t(pvs.stats.iterations) * 20 * hemicubeSamples(64));
  EXPECT_EQ(pvs.stats.border.rays + pvs.stats.reverse.rays, 0u);
}

TEST_F(Raster, SeesBothSidesOfATriangleAndAFlatCellLooksAlongItsNormal) {
  for (const bool flipped : {false, true}) {
    SceneOfBoxes boxes;
    const glm::vec3 a(-1, -1, -5), b(1, -1, -5), c(0, 1, -5);
    boxes.addTriangle(a, flipped ? c : b, flipped ? b : c);
    boxes.addRectangle({-1, -1, 5}, {2, 0, 0}, {0, 2, 0});
    const CellPvs pvs =
        bakeOn("vulkan", boxes.finish(), {"cell", {0, 0, 0}, {1, 1, 0}, {0, 180, 0}}, params());
    EXPECT_EQ(pvs.triangles, idRange(0, 1));
  }
}

TEST(RasterMethod, RefusesScenesWhoseSurfacesItWouldNotDraw) {
  for (const uint32_t surface : {kSurfaceGlass, kSurfaceFrontOnly}) {
    SceneOfBoxes boxes;
    boxes.addBox({-5, -5, -5}, {5, 5, 5});
    Scene scene = boxes.finish();
    scene.surfaces.words.assign(scene.triangleCount(), 0u);
    scene.surfaces.words[3] = surface;
    BakeParams raster = quickParams();
    raster.method = Method::kRaster;
    try {
      bakeOn("cpu", scene, {"cell", {0, 0, 0}, {1, 1, 1}}, raster);
      FAIL() << surface;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("draws every triangle as opaque"), std::string::npos)
          << error.what();
      EXPECT_EQ(error.exitCode(), kExitUsage);
    }
  }
}

/// All that is in front of the face is drawn, to the horizon on all sides; what is behind the face is not.
TEST_F(Raster, SeesTheWholeHemisphereInFrontOfAFace) {
  SceneOfBoxes boxes;
  const uint32_t room = boxes.addBox({-9, -9, -9}, {9, 9, 9});
  const CellPvs pvs = bakeOn("vulkan", boxes.finish(), {"cell", {0, 0, 0}, {1, 1, 0}}, params());
  // The cell looks along +z: the walls -x, +x, -y, +y and +z, not -z.
  std::vector<uint32_t> expected = idRange(room, 8);
  expected.insert(expected.end(), {room + 10, room + 11});
  EXPECT_EQ(pvs.triangles, expected);
}

TEST_F(Raster, LooksThroughADoor) {
  SceneOfBoxes boxes;
  boxes.addRectangle({0, 0, -10}, {0, 10, 0}, {0, 0, 9});  // wall x = 0, the door is -1 < z < 1
  boxes.addRectangle({0, 0, 1}, {0, 10, 0}, {0, 0, 9});
  boxes.addRectangle({0, 3, -1}, {0, 7, 0}, {0, 0, 2});
  const uint32_t opposite = boxes.addRectangle({10, 0, -10}, {0, 10, 0}, {0, 0, 20});
  const uint32_t hidden = boxes.addRectangle({0.5f, 0, 5}, {0, 2, 0}, {0, 0, 1});
  boxes.addRectangle({-10, 0, -10}, {20, 0, 0}, {0, 0, 20});
  const CellPvs pvs = bakeOn("vulkan", boxes.finish(), {"cell", {-3, 1, 0}, {1, 1, 1}}, params());
  const auto has = [&](uint32_t id) { return std::ranges::binary_search(pvs.triangles, id); };
  EXPECT_TRUE(has(opposite) && has(opposite + 1));
  EXPECT_FALSE(has(hidden) || has(hidden + 1));
}

TEST_F(Raster, SameSetAndWitnessesEveryTimeAndInAHashSet) {
  const Scene scene = generateScene("city", 5000, 7);
  const ViewCell cell = generateCells("city", 5000, 7).front();
  BakeParams p = params(100);
  p.threshold = 100;
  const CellPvs first = bakeOn("vulkan", scene, cell, p), again = bakeOn("vulkan", scene, cell, p);
  DeviceOptions hash;
  hash.set = SetKind::kHash;
  const CellPvs hashed = bakeOn("vulkan", scene, cell, p, hash);
  EXPECT_GT(first.triangles.size(), 300u);
  for (const CellPvs* other : {&again, &hashed}) {
    ASSERT_EQ(other->triangles, first.triangles);
    EXPECT_EQ(other->stats.random.rays, first.stats.random.rays);
    for (size_t i = 0; i < first.witnesses.size(); ++i) {
      ASSERT_EQ(other->witnesses[i].origin, first.witnesses[i].origin) << i;
      ASSERT_EQ(other->witnesses[i].direction, first.witnesses[i].direction) << i;
    }
  }
}

/// A hemicube shows what rays through its pixels meet, in all its images and for a scene of many chunks: each
/// triangle that is traced in a block of 3 by 3 pixels, so clear of its edges, is drawn.
TEST_F(Raster, ShowsWhatTracingShows) {
  constexpr uint32_t kResolution = 200;
  const Scene scene = generateScene("city", 100'000, 7);
  const Bvh bvh = buildBvh(scene.positions, scene.triangles);
  const auto device = makeDevice("vulkan", scene, bvh), cpu = makeDevice("cpu", scene, bvh);
  const std::vector<Face> faces = cellFaces({"cell", {-50, 12, 3}, {6, 2, 6}, {0, 25, 0}});
  for (const uint32_t f : {0u, 3u, 5u}) {
    const Hemicube hemicube = hemicubeAt(
        faces[f], xyz3(faces[f].corner) + 0.5f * xyz3(faces[f].edge_u) + 0.25f * xyz3(faces[f].edge_v));
    device->beginCell(faces, StageParams{});
    device->drawer().rasterize(hemicube, kResolution, hemicubeNear(scene, faces));
    EXPECT_EQ(device->counters().rays, hemicubeSamples(kResolution));
    device->collect(kStageRandom);
    std::vector<uint32_t> drawn;
    for (const PvsEntry& entry : device->readPvs()) drawn.push_back(entry.origin_triangle.w);
    EXPECT_TRUE(std::ranges::is_sorted(drawn));
    std::vector<uint32_t> traced(size_t(kHemicubeViews) * kResolution * kResolution);
    cpu->traceViews(hemicube, kResolution, traced);
    size_t blocks = 0;
    for (uint32_t place = 0; place < hemicubeSamples(kResolution); ++place) {
      const uint32_t pixel = hemicubePixel(place, kResolution), view = hemicubeView(place, kResolution);
      const uint32_t x = pixel % kResolution, y = pixel / kResolution;
      const uint32_t rows = view == 0 ? kResolution : kResolution / 2;
      if (x == 0 || y == 0 || x + 1 == kResolution || y + 1 >= rows) continue;
      const auto at = [&](int dx, int dy) {
        return traced[(size_t(view) * kResolution + size_t(int(y) + dy)) * kResolution + size_t(int(x) + dx)];
      };
      const uint32_t triangle = at(0, 0);
      bool block = triangle != kNoTriangle;
      for (int k = 0; k < 9; ++k) block &= at(k % 3 - 1, k / 3 - 1) == triangle;
      if (!block) continue;
      ++blocks;
      ASSERT_TRUE(std::ranges::binary_search(drawn, triangle))
          << triangle << ", face " << f << ", view " << view << ", pixel " << x << " " << y;
    }
    EXPECT_GT(blocks, 1000u) << "face " << f;
  }
}

/// By how many pixels the centre of the witness's pixel lies outside the triangle as it was drawn; negative:
/// inside. Nothing if part of the triangle is behind the image.
std::optional<double> pixelsOutside(const Scene& scene, uint32_t triangle, const Witness& witness,
                                    const std::vector<Face>& faces, uint32_t resolution) {
  const auto along = [](vec4 axis, glm::dvec3 v) { return glm::dot(glm::dvec3(xyz3(axis)), v); };
  const auto cross = [](glm::dvec2 a, glm::dvec2 b) { return a.x * b.y - a.y * b.x; };
  for (const Face& face : faces) {
    for (const ViewFrame& view : hemicubeAt(face, witness.origin)) {
      // The image of which this is the ray of a pixel's centre: viewRay goes `resolution` ahead.
      const double ahead = along(view.forward, witness.direction);
      const double x = along(view.right, witness.direction), y = along(view.up, witness.direction);
      if (std::fabs(ahead - resolution) > 0.01 || std::max(std::fabs(x), std::fabs(y)) > resolution) continue;
      std::array<glm::dvec2, 3> corners;
      for (int k = 0; k < 3; ++k) {
        const glm::dvec3 corner =
            glm::dvec3(scene.positions[scene.triangles[triangle][k]]) - glm::dvec3(witness.origin);
        const double w = along(view.forward, corner);
        if (w <= 0) return std::nullopt;
        corners[k] = glm::dvec2(along(view.right, corner), along(view.up, corner)) * (resolution / 2.0 / w);
      }
      const double sign = cross(corners[1] - corners[0], corners[2] - corners[0]) < 0 ? -1 : 1;
      double outside = -1e9;
      for (int k = 0; k < 3; ++k) {
        const glm::dvec2 edge = corners[(k + 1) % 3] - corners[k];
        const double inside = sign * cross(edge, glm::dvec2(x, y) / 2.0 - corners[k]) / glm::length(edge);
        outside = std::max(outside, -inside);
      }
      return outside;
    }
  }
  ADD_FAILURE() << "the witness of triangle " << triangle << " is no pixel's ray";
  return std::nullopt;
}

/// Corners are snapped to a grid of 1/256 of a pixel or finer (subPixelPrecisionBits is 8 on lavapipe and on
/// NVIDIA), so an edge moves by at most half the diagonal of a grid cell, 0.0028 pixels. Clip coordinates are
/// floats, which adds far less at these resolutions.
constexpr double kSnapPixels = 0.005;

TEST_F(Raster, EveryTriangleFoundCoversItsPixelsCentre) {
  Random random(11);
  const Scene scene = testing_support::soup(random, 3000, 0.3f, 0.3f);
  const ViewCell cell{"cell", {0, 0, 3}, {0.5, 0.5, 0.5}, {20, 30, 0}};
  const BakeParams p = params(200);
  const CellPvs pvs = bakeOn("vulkan", scene, cell, p);
  ASSERT_GT(pvs.triangles.size(), 500u);
  size_t checked = 0;
  for (size_t i = 0; i < pvs.triangles.size(); ++i) {
    if (pvs.witnesses[i].stage == kStageContained) continue;
    const auto outside =
        pixelsOutside(scene, pvs.triangles[i], pvs.witnesses[i], cellFaces(cell), p.raster_resolution);
    if (!outside) continue;
    ++checked;
    EXPECT_LT(*outside, kSnapPixels) << "triangle " << pvs.triangles[i];
  }
  EXPECT_GT(checked, pvs.triangles.size() * 9 / 10);
}

/// Hits of the witnesses' rays, by the reference.
std::vector<Hit> traced(const Scene& scene, const CellPvs& pvs) {
  std::vector<Ray> rays;
  for (const Witness& w : pvs.witnesses) rays.push_back({vec4(w.origin, 0), vec4(w.direction, 0)});
  std::vector<Hit> hits(rays.size());
  const Bvh bvh = buildBvh(scene.positions, scene.triangles);
  makeDevice("cpu", scene, bvh)->traceRays(rays, hits);
  return hits;
}

/// t at which the ray meets the triangle's plane.
double planeDistance(const Scene& scene, uint32_t triangle, const Witness& witness) {
  std::array<glm::dvec3, 3> corners;
  for (int k = 0; k < 3; ++k) corners[k] = scene.positions[scene.triangles[triangle][k]];
  const glm::dvec3 normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
  return glm::dot(normal, corners[0] - glm::dvec3(witness.origin)) /
         glm::dot(normal, glm::dvec3(witness.direction));
}

/// What a pixel shows is what the ray through its centre meets, unless an edge passes within kSnapPixels of
/// the centre, or triangles cross there and are equally far to 1/500. In a soup of small triangles few
/// witnesses are such pixels: a set keeps each triangle's first of many.
TEST_F(Raster, RaysProveWhatIsDrawnButForPixelsAtEdges) {
  Random random(13);
  const Scene scene = testing_support::soup(random, 3000, 0.3f, 0.3f);
  const ViewCell cell{"cell", {0, 0, 3}, {0.5, 0.5, 0.5}};
  const BakeParams p = params(200);
  const CellPvs pvs = bakeOn("vulkan", scene, cell, p);
  const std::vector<Hit> hits = traced(scene, pvs);
  size_t unproven = 0;
  for (size_t i = 0; i < hits.size(); ++i) {
    if (pvs.witnesses[i].stage == kStageContained || hits[i].triangle == pvs.triangles[i]) continue;
    ++unproven;
    double to_edge = 1e9;  // of the triangle that was drawn, or of the one that the ray meets
    for (const uint32_t triangle : {pvs.triangles[i], hits[i].triangle}) {
      if (triangle == kNoTriangle) continue;
      const auto outside =
          pixelsOutside(scene, triangle, pvs.witnesses[i], cellFaces(cell), p.raster_resolution);
      if (outside) to_edge = std::min(to_edge, std::fabs(*outside));
    }
    const double drawn_at = planeDistance(scene, pvs.triangles[i], pvs.witnesses[i]);
    if (hits[i].triangle != kNoTriangle && std::fabs(drawn_at / double(hits[i].t) - 1) < 0.002) continue;
    EXPECT_LT(to_edge, kSnapPixels) << "triangle " << pvs.triangles[i] << " drawn, " << hits[i].triangle
                                    << " met";
  }
  RecordProperty("unproven", int(unproven));
  EXPECT_LT(unproven, hits.size() * 3 / 100) << "of " << hits.size();
}

/// On a scene of boxes enough hemicubes find what enough random rays find, and more: where a face that looks
/// away meets its neighbour at a silhouette, a pixel's centre may lie on the snapped edge, where both are
/// equally far, and show the hidden one. Such an event takes one pixel in some hundred along the edge, so in
/// time most of these faces are found.
TEST_F(Raster, FindsWhatRandomRaysFindAndFacesAtSilhouettes) {
  SceneOfBoxes boxes;
  Random random(3);
  for (int i = 0; i < 40; ++i) {
    const glm::vec3 low = random.point(10);
    boxes.addBox(low, low + glm::vec3(1, 1, 1) + 0.5f * random.point(1));
  }
  const Scene scene = boxes.finish();
  const ViewCell cell{"cell", {0, 12, 0}, {4, 1, 4}};
  BakeParams drawn = params(128);
  drawn.threshold = 1;
  BakeParams rays = quickParams();
  rays.method = Method::kRandom;
  const CellPvs hemicubes = bakeOn("vulkan", scene, cell, drawn),
                random_set = bakeOn("cpu", scene, cell, rays);
  EXPECT_GT(random_set.triangles.size(), 150u);
  std::vector<uint32_t> missed, more;
  std::ranges::set_difference(random_set.triangles, hemicubes.triangles, std::back_inserter(missed));
  std::ranges::set_difference(hemicubes.triangles, random_set.triangles, std::back_inserter(more));
  EXPECT_LE(missed.size(), 2u);
  EXPECT_LT(more.size(), random_set.triangles.size() / 3);
  RecordProperty("more", int(more.size()));
  const std::vector<Hit> hits = traced(scene, hemicubes);
  for (size_t i = 0; i < hits.size(); ++i) {
    const uint32_t triangle = hemicubes.triangles[i];
    if (hits[i].triangle == triangle) continue;
    const auto outside = pixelsOutside(scene, triangle, hemicubes.witnesses[i], cellFaces(cell), 128);
    if (!outside) continue;
    EXPECT_LT(std::fabs(*outside), kSnapPixels) << "triangle " << triangle;
  }
}

TEST_F(Raster, StopsAtTheRayLimitAndTracesHowTheSetGrew) {
  const Scene scene = generateScene("city", 5000, 7);
  const ViewCell cell = generateCells("city", 5000, 7).front();
  const Bvh bvh = buildBvh(scene.positions, scene.triangles);
  const auto device = makeDevice("vulkan", scene, bvh);
  BakeParams p = params(100);
  p.max_rays = 5 * hemicubeSamples(100) - 1;
  BakeTrace trace;
  const CellPvs pvs = bakeCell(*device, scene, cell, 0, p, {.trace = &trace});
  EXPECT_EQ(pvs.stats.stop, StopReason::kRayLimit);
  EXPECT_EQ(pvs.stats.random.rays, 5 * hemicubeSamples(100));
  ASSERT_EQ(trace.curve.size(), 1u);
  EXPECT_EQ(trace.curve.back().rays[kStageRandom], pvs.stats.random.rays);
  // A traced bake on the same device is not disturbed by what was drawn before it.
  BakeParams traced = quickParams();
  traced.n_rand = 5'000;
  traced.n_abs_edge = traced.n_rs_edge = traced.n_rs_area = 2;
  traced.validation_rays = 1000;
  EXPECT_EQ(bakeCell(*device, scene, cell, 0, traced).triangles,
            bakeOn("vulkan", scene, cell, traced).triangles);
}

TEST_F(Raster, WhatDoesNotFitIsOneLine) {
  SceneOfBoxes boxes;
  boxes.addBox({-9, -9, -9}, {9, 9, 9});
  const Scene scene = boxes.finish();
  DeviceOptions options;
  options.memory_budget_bytes = 64u << 20;
  for (const uint32_t resolution : {2048u, 16384u}) {  // past the budget, and past a buffer's size as well
    BakeParams p = params(resolution);
    p.n_rand = 1000;
    try {
      bakeOn("vulkan", scene, {"cell", {0, 0, 0}, {1, 1, 1}}, p, options);
      FAIL() << "nothing was thrown";
    } catch (const Error& error) {
      const std::string line = error.what();
      EXPECT_EQ(line.find('\n'), std::string::npos) << line;
      EXPECT_NE(line.find("pixels of a hemicube"), std::string::npos) << line;
      EXPECT_NE(line.find("a smaller --raster-resolution"), std::string::npos) << line;
      EXPECT_EQ(line.find("opencl"), std::string::npos) << "no device that draws: " << line;
      const bool by_budget = line.find("give a larger --memory-budget or a smaller") != std::string::npos;
      EXPECT_TRUE(by_budget || resolution == 16384) << line;
    }
  }
}

TEST(RasterElsewhere, OtherDevicesRefuseInOneLine) {
  SceneOfBoxes boxes;
  boxes.addBox({-9, -9, -9}, {9, 9, 9});
  BakeParams p = quickParams();
  p.method = Method::kRaster;
  try {
    bakeOn("cpu", boxes.finish(), {"cell", {0, 0, 0}, {1, 1, 1}}, p);
    FAIL() << "nothing was thrown";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "cpu cannot rasterise: only Vulkan devices rasterise");
    EXPECT_EQ(error.exitCode(), kExitUsage);
  }
  EXPECT_THROW(requireMethodOn(Method::kRaster, "opencl:0"), Error);
  EXPECT_NO_THROW(requireMethodOn(Method::kRaster, "vulkan:lavapipe"));
  EXPECT_NO_THROW(requireMethodOn(Method::kRandom, "cpu"));
}

}  // namespace
}  // namespace sightline
