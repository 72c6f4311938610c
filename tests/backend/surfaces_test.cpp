// Holes, glass and sides: what rays see, on every device, against brute force in double over all triangles
// with the mask sampled as it is.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "bvh/bvh.h"
#include "core/device/embree/embree_device.h"
#include "core/device/registry/make_device.h"
#include "core/gvs/bake_cell.h"
#include "core/scene/masked_triangle.h"
#include "core/trace/cpu_tracer.h"
#include "tests/support/make_cell.h"
#include "tests/support/vulkan.h"

namespace sightline {
namespace {

using glm::dvec2;
using glm::dvec3;

/// A triangle's corners in its mask's image, in texels, as they were before they were rounded.
using Places = std::array<dvec2, 3>;

struct SurfaceScene {
  Scene scene;
  std::vector<Places> places;  ///< of the masked triangles
};

uint32_t addTriangle(Scene& scene, vec3 a, vec3 b, vec3 c, uint32_t surface) {
  const auto first = uint32_t(scene.positions.size());
  scene.positions.insert(scene.positions.end(), {a, b, c});
  scene.triangles.emplace_back(first, first + 1, first + 2);
  scene.surfaces.words.push_back(surface);
  return uint32_t(scene.triangles.size() - 1);
}

uint32_t maskedWord(SurfaceScene& s, uint32_t mask, const Places& places, uint32_t flags = 0) {
  s.scene.surfaces.masked.push_back(
      *maskedTriangle(s.scene.surfaces, mask, {places[0], places[1], places[2]}));
  s.places.push_back(places);
  return flags | kSurfaceMasked | uint32_t(s.scene.surfaces.masked.size() - 1);
}

/// Triangles in a box of 2, of all kinds of surfaces, and masks of all wraps.
SurfaceScene randomScene(uint32_t seed, int count) {
  std::mt19937 random(seed);
  const auto unit = [&] { return float(random() >> 8) * 0x1p-24f; };
  const auto point = [&](float size) {
    const float x = unit(), y = unit(), z = unit();
    return (vec3(x, y, z) * 2.0f - 1.0f) * size;
  };
  SurfaceScene s;
  const glm::uvec2 sizes[] = {{4, 4}, {7, 3}, {1, 5}, {64, 33}};
  for (const glm::uvec2 size : sizes) {
    for (uint32_t wrap = 0; wrap < 3; ++wrap) {
      addMask(s.scene.surfaces, size.x, size.y, {wrap, (wrap + size.x) % 3},
              [&](uint64_t) { return random() % 2 == 0; });
    }
  }
  for (int i = 0; i < count; ++i) {
    const vec3 center = point(1.0f);
    uint32_t word = random() % 4 == 0 ? kSurfaceFrontOnly : 0u;
    if (random() % 3 == 0) word |= kSurfaceGlass;
    if (random() % 2 == 0) {
      const double tiles = std::exp2(double(random() % 12) - 2.0);
      Places places;
      for (dvec2& place : places) place = dvec2(unit() - 0.5, unit() - 0.5) * tiles * 8.0;
      word = maskedWord(s, uint32_t(random() % 12), places, word);
    }
    addTriangle(s.scene, center + point(0.5f), center + point(0.5f), center + point(0.5f), word);
  }
  s.scene.objects = {{"all", 0, uint32_t(count)}};
  return s;
}

std::vector<Ray> randomRays(uint32_t seed, size_t count) {
  std::mt19937 random(seed);
  const auto unit = [&] { return float(random() >> 8) * 0x1p-23f - 1.0f; };
  std::vector<Ray> rays(count);
  for (Ray& ray : rays) {
    const float ox = unit(), oy = unit(), oz = unit(), dx = unit(), dy = unit(), dz = unit();
    ray = {vec4(ox, oy, oz, 0), vec4(dx, dy, dz, 0)};
  }
  return rays;
}

/// What a ray does at a triangle, in double.
struct Meeting {
  bool hits = false;
  double t = 0;
  bool holds = false;
  bool sure = true;  ///< far from all edges, of triangle and texels, and from a change of sides
};

uint32_t texelOf(double place, uint32_t size, uint32_t wrap) {
  const auto whole = int64_t(std::floor(place));
  if (wrap == kWrapClamp) return uint32_t(std::clamp<int64_t>(whole, 0, size - 1));
  const int64_t period = wrap == kWrapMirror ? 2 * int64_t(size) : int64_t(size);
  const int64_t inside = ((whole % period) + period) % period;
  return uint32_t(inside < size ? inside : period - 1 - inside);
}

Meeting meet(const SurfaceScene& s, uint32_t id, const Ray& ray) {
  const Scene& scene = s.scene;
  const auto corners = scene.corners(id);
  const dvec3 o(ray.origin), d(ray.direction), a = dvec3(corners[0]) - o, b = dvec3(corners[1]) - o,
                                               c = dvec3(corners[2]) - o;
  const double u = glm::dot(d, glm::cross(b, c)), v = glm::dot(d, glm::cross(c, a)),
               w = glm::dot(d, glm::cross(a, b)), det = u + v + w;
  Meeting result;
  const double share[3] = {u / det, v / det, w / det};
  const double least = std::min({share[0], share[1], share[2]});
  const dvec3 normal = glm::cross(b - a, c - a);
  if (std::fabs(det) < 1e-3 * glm::length(normal) * glm::length(d)) result.sure = false;
  if (std::fabs(least) < 1e-4) result.sure = false;
  result.t = glm::dot(a, normal) / glm::dot(d, normal);
  if (std::fabs(result.t) < 1e-4) result.sure = false;
  result.hits = least >= 0 && result.t > 0;
  const uint32_t word = scene.surfaces.words[id];
  result.holds = true;
  if ((word & kSurfaceFrontOnly) != 0 && glm::dot(d, normal) > 0) result.holds = false;
  if ((word & kSurfaceMasked) == 0 || least < -1e-3 || result.t < -1e-3) return result;
  const Places& places = s.places[word & kSurfaceIndex];
  const uvec4 mask =
      scene.surfaces.masks[scene.surfaces.masked[word & kSurfaceIndex].corner_c_mask.z].size_wrap_first;
  const dvec2 place = places[0] * share[0] + places[1] * share[1] + places[2] * share[2];
  const double extent = glm::length(places[1] - places[0]) + glm::length(places[2] - places[0]);
  for (int axis = 0; axis < 2; ++axis) {
    const double beside = std::fabs(place[axis] - std::round(place[axis]));
    if (beside < 1e-4 + extent * 1e-5) result.sure = false;
  }
  const uint32_t x = texelOf(place.x, mask.x, mask.z & 3u), y = texelOf(place.y, mask.y, mask.z >> 2);
  const uint32_t bit = y * mask.x + x;
  if ((scene.surfaces.texels[mask.w + bit / 32] >> (bit % 32) & 1u) == 0) result.holds = false;
  return result;
}

/// What a ray sees, in double; nothing if that is not sure.
struct Sight {
  bool sure = true;
  uint32_t hit = kNoTriangle;
  std::set<uint32_t> glass;
};

Sight see(const SurfaceScene& s, const Ray& ray) {
  Sight sight;
  double nearest = HUGE_VAL;
  std::vector<std::pair<double, uint32_t>> glass;
  for (uint32_t id = 0; id < s.scene.triangleCount(); ++id) {
    const Meeting m = meet(s, id, ray);
    if (!m.sure) sight.sure = false;
    if (!m.hits || !m.holds) continue;
    if ((s.scene.surfaces.words[id] & kSurfaceGlass) != 0) {
      glass.emplace_back(m.t, id);
    } else if (m.t < nearest) {
      nearest = m.t;
      sight.hit = id;
    }
  }
  for (const auto& [t, id] : glass) {
    if (std::fabs(t - nearest) < 1e-5) sight.sure = false;
    if (t < nearest) sight.glass.insert(id);
  }
  return sight;
}

std::vector<std::string> tracers() {
  return {"cpu", "opencl", "opencl single", "vulkan", "vulkan parts", "vulkan queries"};
}

std::unique_ptr<Device> makeTracingDevice(const std::string& name, const Scene& scene, const Bvh& bvh) {
  DeviceOptions options;
  if (name == "opencl single") options.rays_per_item = 1;
  if (name == "vulkan parts") options.part_triangles = 40;
  if (name == "vulkan queries") options.ray_queries = true;
  return makeDevice(name.substr(0, name.find(' ')), scene, bvh, options);
}

bool isExact(const std::string& name) {
  return !name.starts_with("vulkan");
}

struct Answers {
  std::vector<Hit> hits;
  std::vector<SeenThrough> glass;
};

Answers answersOf(Tracer& tracer, const std::vector<Ray>& rays) {
  Answers answers;
  answers.hits.resize(rays.size());
  tracer.traceRays(rays, answers.hits);
  answers.glass = tracer.traceGlass(rays, answers.hits);
  return answers;
}

class SurfacesOn : public testing::TestWithParam<std::string> {};

TEST_P(SurfacesOn, AreWhatBruteForceInDoubleSees) {
  const SurfaceScene s = randomScene(7, 120);
  const Bvh bvh = buildBvh(s.scene.positions, s.scene.triangles);
  const std::vector<Ray> rays = randomRays(3, 6'000);
  const Answers got = answersOf(*makeTracingDevice(GetParam(), s.scene, bvh), rays);
  size_t sure = 0, through = 0, holes = 0, wrong = 0;
  for (size_t i = 0; i < rays.size(); ++i) {
    const Sight expected = see(s, rays[i]);
    if (!expected.sure) continue;
    ++sure;
    std::set<uint32_t> glass;
    for (const SeenThrough& seen : got.glass) {
      if (seen.ray == i) glass.insert(seen.triangle);
    }
    through += glass.empty() ? 0 : 1;
    holes += expected.hit == kNoTriangle ? 1 : 0;
    if (got.hits[i].triangle == expected.hit && glass == expected.glass) continue;
    if (++wrong < 5) {
      ADD_FAILURE() << "ray " << i << ": " << got.hits[i].triangle << " for " << expected.hit << ", glass "
                    << glass.size() << " for " << expected.glass.size();
    }
  }
  EXPECT_EQ(wrong, 0u);
  EXPECT_GT(sure, 3'000u);
  EXPECT_GT(through, 500u);
  EXPECT_GT(holes, 100u);
}

TEST_P(SurfacesOn, AreTheSameBitForBitOnExactDevices) {
  const SurfaceScene s = randomScene(11, 400);
  const Bvh bvh = buildBvh(s.scene.positions, s.scene.triangles);
  const std::vector<Ray> rays = randomRays(5, 20'000);
  const Answers expected = answersOf(*makeTracingDevice("cpu", s.scene, bvh), rays);
  const Answers got = answersOf(*makeTracingDevice(GetParam(), s.scene, bvh), rays);
  size_t hits = 0;
  for (size_t i = 0; i < rays.size(); ++i) {
    hits += got.hits[i].triangle != expected.hits[i].triangle ||
                    (got.hits[i].triangle != kNoTriangle && isExact(GetParam()) &&
                     got.hits[i].t != expected.hits[i].t)
                ? 1
                : 0;
  }
  std::vector<SeenThrough> beside;
  std::ranges::set_symmetric_difference(got.glass, expected.glass, std::back_inserter(beside));
  const size_t allowed = isExact(GetParam()) ? 0 : 8;  // the driver's own test of triangles
  EXPECT_LE(hits, allowed);
  EXPECT_LE(beside.size(), allowed);
  EXPECT_GT(expected.glass.size(), 4'000u);
}

BakeParams surfaceParams() {
  BakeParams params;
  params.n_rand = 20'000;
  params.threshold = 5;
  params.validation_rays = 10'000;
  return params;
}

TEST_P(SurfacesOn, MakeTheSameSets) {
  const SurfaceScene s = randomScene(13, 600);
  const Bvh bvh = buildBvh(s.scene.positions, s.scene.triangles);
  const ViewCell cell = testing_support::makeCell({0.1, 0.2, -0.1}, {0.3, 0.2, 0.4});
  const auto bake = [&](const std::string& name) {
    return bakeCell(*makeTracingDevice(name, s.scene, bvh), s.scene, cell, 0, surfaceParams());
  };
  const CellPvs expected = bake("cpu"), got = bake(GetParam());
  std::vector<uint32_t> beside;
  std::ranges::set_symmetric_difference(got.triangles, expected.triangles, std::back_inserter(beside));
  EXPECT_LE(beside.size(), isExact(GetParam()) ? 0u : 3u);
  if (isExact(GetParam())) {
    EXPECT_EQ(got.stats.missing_rays, expected.stats.missing_rays);
  }
  EXPECT_GT(expected.triangles.size(), 200u);
}

/// What is not opaque in a scene.
enum class Kind { kHoles, kGlass, kSides, kDoors };

/// Panels that stand in each other's way, those that are not opaque all of the kind.
SurfaceScene panels(Kind kind) {
  SurfaceScene s = randomScene(19, 450);
  uint32_t of_kind = 0;
  for (uint32_t id = 0; id < s.scene.triangleCount(); ++id) {
    uint32_t& word = s.scene.surfaces.words[id];
    if (kind == Kind::kHoles && (word & kSurfaceMasked) != 0) word &= kSurfaceMasked | kSurfaceIndex;
    if (kind == Kind::kHoles && (word & kSurfaceMasked) == 0) word = 0;
    if (kind == Kind::kGlass) word &= kSurfaceGlass;
    if (kind == Kind::kSides) word = kSurfaceFrontOnly;
    if (kind == Kind::kDoors) word = id % 50 < 20 ? kSurfaceGlass : 0u;  // whole objects
    of_kind += word != 0 ? 1 : 0;
  }
  EXPECT_GT(of_kind, 100u);
  return s;
}

class SurfaceKinds : public testing::TestWithParam<Kind> {};

/// Each kind by both of the driver's ways and by ours: sets, witnesses'
/// triangles, rays that miss, and images.
TEST_P(SurfaceKinds, AreTheSameByPipelinesQueriesAndOurTree) {
  SL_SKIP_WITHOUT_VULKAN();
  const SurfaceScene s = panels(GetParam());
  const Bvh bvh = buildBvh(s.scene.positions, s.scene.triangles);
  const ViewCell cell = testing_support::makeCell({0.1, 0.2, -0.1}, {0.3, 0.2, 0.4});
  const std::vector<ViewFrame> frames = {
      {vec4(0.1f, 0, 0, 0), vec4(0, 0, -1, 0), vec4(1, 0, 0, 0), vec4(0, 1, 0, 0)},
      {vec4(0.1f, 0.2f, 0, 0), vec4(1, 0, 0, 0), vec4(0, 0, 1, 0), vec4(0, 1, 0, 0)}};
  struct Result {
    CellPvs pvs;
    Answers answers;
    std::vector<uint32_t> images;
  };
  const std::vector<Ray> rays = randomRays(21, 20'000);
  const auto resultOf = [&](const std::string& name) {
    const auto device = makeTracingDevice(name, s.scene, bvh);
    Result result{bakeCell(*device, s.scene, cell, 0, surfaceParams()), answersOf(*device, rays), {}};
    result.images.resize(2 * 96 * 96);
    device->traceViews(frames, 96, result.images);
    return result;
  };
  const Result pipelines = resultOf("vulkan"), queries = resultOf("vulkan queries"), ours = resultOf("cpu");
  EXPECT_GT(ours.pvs.triangles.size(), 200u);
  EXPECT_EQ(pipelines.pvs.triangles, ours.pvs.triangles);
  EXPECT_EQ(pipelines.pvs.triangles, queries.pvs.triangles);
  EXPECT_EQ(pipelines.pvs.stats.missing_rays, queries.pvs.stats.missing_rays);
  EXPECT_EQ(pipelines.images, queries.images);
  size_t pixels = 0, hits = 0;
  for (size_t i = 0; i < ours.images.size(); ++i) pixels += ours.images[i] != pipelines.images[i] ? 1 : 0;
  EXPECT_LE(pixels, 4u);  // at edges
  for (size_t i = 0; i < rays.size(); ++i) {
    EXPECT_EQ(pipelines.answers.hits[i].triangle, queries.answers.hits[i].triangle) << "ray " << i;
    hits += pipelines.answers.hits[i].triangle != ours.answers.hits[i].triangle ? 1 : 0;
  }
  EXPECT_LE(hits, 4u);
  EXPECT_EQ(pipelines.answers.glass, queries.answers.glass);
  const bool glass = featuresOf(s.scene.surfaces).glass;
  EXPECT_EQ(pipelines.answers.glass.size() > 4'000u, glass);
}

constexpr const char* kKindNames[] = {"Holes", "Glass", "Sides", "Doors"};

INSTANTIATE_TEST_SUITE_P(Of, SurfaceKinds,
                         testing::Values(Kind::kHoles, Kind::kGlass, Kind::kSides, Kind::kDoors),
                         [](const auto& its) { return kKindNames[size_t(its.param)]; });

INSTANTIATE_TEST_SUITE_P(On, SurfacesOn, testing::ValuesIn(tracers()), [](const auto& name) {
  std::string text = name.param;
  std::ranges::replace(text, ' ', '_');
  return text;
});

TEST(Surfaces, EmbreeSeesTheSame) {
  if (!embreeDeviceInfo().unusable.empty()) GTEST_SKIP() << embreeDeviceInfo().unusable;
  const SurfaceScene s = randomScene(17, 500);
  const Bvh bvh = buildBvh(s.scene.positions, s.scene.triangles);
  const std::vector<Ray> rays = randomRays(9, 20'000);
  const Answers ours = answersOf(*makeDevice("cpu", s.scene, bvh), rays);
  const Answers theirs = answersOf(*makeEmbreeTracer(s.scene), rays);
  size_t hits = 0;
  for (size_t i = 0; i < rays.size(); ++i) hits += ours.hits[i].triangle != theirs.hits[i].triangle ? 1 : 0;
  std::vector<SeenThrough> beside;
  std::ranges::set_symmetric_difference(ours.glass, theirs.glass, std::back_inserter(beside));
  EXPECT_LT(hits, 100u);  // its shares of corners are floats: texels of large repeated masks differ
  EXPECT_LT(beside.size(), 200u);
  EXPECT_GT(ours.glass.size(), 4'000u);
}

/// A leaf before a wall of small squares: through each hole of the leaf the rays from the axis see one
/// square.
TEST(Surfaces, ACheckerboardShowsTheSquaresBehindItsHoles) {
  constexpr uint32_t kSide = 8;
  SurfaceScene s;
  const uint32_t mask = addMask(s.scene.surfaces, kSide, kSide, {kWrapClamp, kWrapClamp},
                                [](uint64_t i) { return (i % kSide + i / kSide) % 2 == 0; });
  const double side = kSide;
  addTriangle(s.scene, {0, 8, 1}, {0, 0, 1}, {8, 0, 1},
              maskedWord(s, mask, {dvec2(0, 0), dvec2(0, side), dvec2(side, side)}));
  addTriangle(s.scene, {0, 8, 1}, {8, 0, 1}, {8, 8, 1},
              maskedWord(s, mask, {dvec2(0, 0), dvec2(side, side), dvec2(side, 0)}));
  std::set<uint32_t> expected = {0, 1};
  for (uint32_t row = 0; row < kSide; ++row) {
    for (uint32_t column = 0; column < kSide; ++column) {
      const float x = float(column), y = float(kSide - 1 - row);
      for (const uint32_t id : {addTriangle(s.scene, {x, y, 0}, {x + 1, y, 0}, {x + 1, y + 1, 0}, 0),
                                addTriangle(s.scene, {x, y, 0}, {x + 1, y + 1, 0}, {x, y + 1, 0}, 0)}) {
        if ((row + column) % 2 != 0) expected.insert(id);
      }
    }
  }
  const Bvh bvh = buildBvh(s.scene.positions, s.scene.triangles);
  for (const std::string& name : tracers()) {
    std::vector<Ray> rays;  // straight on, from each texel
    for (int i = 0; i < 64 * 64; ++i) {
      rays.push_back(
          {vec4((float(i % 64) + 0.37f) / 8, (float(i / 64) + 0.41f) / 8, 5, 0), vec4(0, 0, -1, 0)});
    }
    std::vector<Hit> hits(rays.size());
    makeTracingDevice(name, s.scene, bvh)->traceRays(rays, hits);
    std::set<uint32_t> seen;
    for (const Hit& hit : hits) seen.insert(hit.triangle);
    EXPECT_EQ(seen, expected) << name;
  }
}

TEST(Surfaces, FrontsAreCounterClockwiseAndBacksAreNotThere) {
  SurfaceScene s;
  addTriangle(s.scene, {-1, -1, 0}, {1, -1, 0}, {0, 1, 0}, kSurfaceFrontOnly);
  const Bvh bvh = buildBvh(s.scene.positions, s.scene.triangles);
  const glm::mat3 turns[] = {glm::mat3(1), glm::mat3(0, 1, 0, 0, 0, 1, 1, 0, 0),
                             glm::mat3(0, 0, 1, 1, 0, 0, 0, 1, 0)};
  for (const glm::mat3& turn : turns) {
    Scene turned = s.scene;
    for (vec3& p : turned.positions) p = turn * p;
    const Bvh tree = buildBvh(turned.positions, turned.triangles);
    const CpuTracer tracer(turned, tree);
    EXPECT_EQ(tracer.trace({vec4(turn * vec3(0.1f, 0, 3), 0), vec4(turn * vec3(0, 0, -1), 0)}).triangle, 0u);
    EXPECT_EQ(tracer.trace({vec4(turn * vec3(0.1f, 0, -3), 0), vec4(turn * vec3(0, 0, 1), 0)}).triangle,
              kNoTriangle);
  }
}

}  // namespace
}  // namespace sightline
