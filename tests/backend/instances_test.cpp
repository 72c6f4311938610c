// Scenes with instances against the plain scenes that they stand for: the same hash, corners, hits and sets,
// bit for bit.
#include "core/scene/instances.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <bit>
#include <cstring>

#include "core/base/error.h"
#include "core/scene/check_scene.h"
#include "core/scene/contained.h"
#include "core/scene/scene_tree.h"
#include "core/trace/cpu_tracer.h"
#include "tests/support/bake_scene.h"
#include "tests/support/instanced_scene.h"
#include "tests/support/vulkan.h"

namespace sightline {
namespace {

using testing_support::InstancedScene;
using testing_support::randomInstances;
using testing_support::randomMesh;
using testing_support::randomPlacement;
using testing_support::TestRandom;
using testing_support::withSurfaces;

bool sameBits(const glm::vec3& a, const glm::vec3& b) {
  for (int i = 0; i < 3; ++i) {
    if (std::bit_cast<uint32_t>(a[i]) != std::bit_cast<uint32_t>(b[i])) return false;
  }
  return true;
}

/// From anywhere in and around the scene: at triangles' corners and insides, along axes, and anywhere.
std::vector<Ray> raysAt(const Scene& scene, uint64_t seed, size_t count, float reach, bool corners = true) {
  TestRandom random(seed);
  std::vector<Ray> rays;
  while (rays.size() < count) {
    const glm::vec3 from = random.inCube(reach * (random.below(8) == 0 ? 30.0f : 1.5f));
    const auto t = scene.corners(random.below(scene.triangleCount()));
    glm::vec3 target = t[random.below(3)];
    if (random.below(3) > 0 || !corners) target = t[0] * 0.3f + t[1] * 0.3f + t[2] * 0.4f;
    glm::vec3 along = (target - from) * (random.below(4) == 0 ? 1e-6f : 1.0f);
    if (random.below(20) == 0) along = glm::vec3(0, random.below(2) ? 1 : -1, 0);
    if (random.below(40) == 0) along.x = 0;
    rays.push_back({vec4(from, 0), vec4(along, 0)});
  }
  return rays;
}

void expectSameHits(const std::vector<Ray>& rays, const std::vector<Hit>& got, const std::vector<Hit>& wanted,
                    const std::string& what) {
  size_t wrong = 0;
  for (size_t i = 0; i < rays.size() && wrong < 5; ++i) {
    if (got[i].triangle == wanted[i].triangle &&
        (got[i].triangle == kNoTriangle ||
         std::bit_cast<uint32_t>(got[i].t) == std::bit_cast<uint32_t>(wanted[i].t))) {
      continue;
    }
    ++wrong;
    ADD_FAILURE() << what << ": ray " << i << " hits " << got[i].triangle << " at " << got[i].t << ", not "
                  << wanted[i].triangle << " at " << wanted[i].t;
  }
}

TEST(Instances, StandForThePlainScene) {
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    const Scene scene = randomInstances(seed, 1 + uint32_t(seed) * 3, 60);
    checkScene(scene);
    const Scene flat = flatten(scene);
    ASSERT_FALSE(flat.hasInstances());
    checkScene(flat);
    ASSERT_EQ(scene.triangleCount(), flat.triangles.size()) << seed;
    ASSERT_EQ(scene.vertexCount(), flat.positions.size()) << seed;
    EXPECT_EQ(hashScene(scene), hashScene(flat)) << seed;
    const Bounds a = sceneBounds(scene), b = sceneBounds(flat);
    EXPECT_TRUE(sameBits(a.low, b.low) && sameBits(a.high, b.high)) << seed;
    uint32_t next = 0;
    scene.visitTriangles(0, scene.triangleCount(), [&](uint32_t id, const auto& corners) {
      ASSERT_EQ(id, next++);
      EXPECT_EQ(scene.vertexNumbers(id), flat.triangles[id]);
      for (size_t c = 0; c < 3; ++c) {
        ASSERT_TRUE(sameBits(corners[c], flat.corners(id)[c])) << seed << " triangle " << id;
        ASSERT_TRUE(sameBits(scene.corners(id)[c], corners[c])) << seed << " triangle " << id;
      }
    });
    EXPECT_EQ(next, scene.triangleCount());
    scene.visitTriangles(3, 5, [&](uint32_t id, const auto&) { EXPECT_TRUE(id == 3 || id == 4); });
  }
}

/// What is told of surfaces: by id, and in the hash.
TEST(Instances, HaveTheSurfacesOfThePlainScene) {
  for (uint64_t seed = 1; seed <= 10; ++seed) {
    const Scene scene = withSurfaces(randomInstances(seed, 1 + uint32_t(seed) * 3, 60), seed);
    checkScene(scene);
    const Scene flat = flatten(scene);
    checkScene(flat);
    EXPECT_EQ(hashScene(scene), hashScene(flat)) << seed;
    EXPECT_NE(hashScene(scene),
              hashScene(withSurfaces(randomInstances(seed, 1 + uint32_t(seed) * 3, 60), 99)));
    const SurfaceCounts counts = countSurfaces(scene), wanted = countSurfaces(flat);
    EXPECT_EQ(counts.masked, wanted.masked);
    EXPECT_EQ(counts.glass, wanted.glass);
    EXPECT_EQ(counts.front_only, wanted.front_only);
    EXPECT_EQ(flat.surfaces.masked.size(), wanted.masked);
    uint32_t mirrored = 0;
    for (uint32_t id = 0; id < scene.triangleCount(); ++id) {
      const StoredTriangle at = scene.stored(id);
      const uint32_t word = scene.surfaces.words[at.triangle], flat_word = flat.surfaces.words[id];
      ASSERT_EQ(scene.surfaceOf(id), word);
      ASSERT_EQ(word & ~kSurfaceIndex, flat_word & ~kSurfaceIndex);
      if ((word & kSurfaceMasked) == 0) continue;
      const MaskedTriangle &its = scene.surfaces.masked[word & kSurfaceIndex],
                           &plain = flat.surfaces.masked[flat_word & kSurfaceIndex];
      const auto places = [](const MaskedTriangle& t) {
        const uvec4 &ab = t.corners_ab, &c = t.corner_c_mask;
        return std::array{glm::uvec2(ab.x, ab.y), glm::uvec2(ab.z, ab.w), glm::uvec2(c.x, c.y),
                          glm::uvec2(c.z, c.w)};
      };
      auto expected = places(its);
      if (at.instance != kNoTriangle && scene.instances[at.instance].mirrors) {
        std::swap(expected[1], expected[2]);
        ++mirrored;
      }
      ASSERT_EQ(places(plain), expected) << seed << " triangle " << id;
    }
    EXPECT_TRUE(mirrored > 0 || seed < 3) << seed;
  }
}

TEST(Instances, RefuseSurfacesOfOtherTriangles) {
  Scene scene = withSurfaces(randomInstances(1, 5, 20), 1);
  scene.surfaces.words.pop_back();
  EXPECT_THROW(checkScene(scene), Error);
}

/// A mirrored instance shows the same side as the mesh.
TEST(Instances, KeepTheirFronts) {
  InstancedScene boxes{Scene()};
  Scene one;
  one.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  one.triangles = {{0, 1, 2}};
  boxes.addMesh(one);
  boxes.place(0, {vec4(-1, 0, 0, 0), vec4(0, 1, 0, 0), vec4(0, 0, 1, 0), vec4(0)});
  const auto t = boxes.finish().corners(0);
  EXPECT_GT(glm::cross(t[1] - t[0], t[2] - t[0]).z, 0.0f);
}

TEST(Instances, RefuseWhatRaysMightMiss) {
  const Bounds unit{glm::vec3(-1), glm::vec3(1)};
  const auto with = [](glm::vec3 x, glm::vec3 y, glm::vec3 z, glm::vec3 at) {
    return Placement{vec4(x, 0), vec4(y, 0), vec4(z, 0), vec4(at, 0)};
  };
  EXPECT_TRUE(canPlace(with({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {5, 6, 7}), unit));
  EXPECT_TRUE(canPlace(with({100, 0, 0}, {0, -1, 0}, {0, 0, 1}, {5, 6, 7}), unit));
  EXPECT_FALSE(canPlace(with({1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 0, 0}), unit)) << "singular";
  EXPECT_FALSE(canPlace(with({1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {0, 0, 0}), unit)) << "flat";
  EXPECT_FALSE(canPlace(with({1, 0, 0}, {0, 1, 0}, {0, 0, 1e-4f}, {0, 0, 0}), unit)) << "nearly flat";
  EXPECT_FALSE(canPlace(with({NAN, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}), unit));
  EXPECT_FALSE(canPlace(with({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {INFINITY, 0, 0}), unit));
  EXPECT_FALSE(canPlace(with({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0x1p41f, 0, 0}), unit));
  EXPECT_FALSE(canPlace(with({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-5000, 0, 0}), {{4999, -1, -1}, {5001, 1, 1}}))
      << "far off in its own space";
  EXPECT_TRUE(canPlace(with({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {5000, 0, 0}), unit));
}

class InstanceDevices : public testing::TestWithParam<const char*> {
 protected:
  static DeviceOptions options() {
    DeviceOptions options;
    if (std::string(GetParam()) == "opencl, single rays") options.rays_per_item = 1;
    return options;
  }
  static std::unique_ptr<Device> device(const Scene& scene, const Bvh& bvh) {
    const std::string name = GetParam();
    return makeDevice(name == "cpu" ? "cpu" : "opencl", scene, bvh, options());
  }
};

TEST_P(InstanceDevices, HitWhatPlainScenesHit) {
  for (uint64_t seed = 1; seed <= 12; ++seed) {
    // Far from the origin, small, and large.
    const float reach = seed % 4 == 3 ? 2e3f : seed % 4 == 2 ? 3.0f : 20.0f;
    const Scene scene = randomInstances(seed, 60, 200, reach), flat = flatten(scene);
    const Bvh flat_tree = buildBvh(flat.positions, flat.triangles);
    const Bvh tree = buildSceneTree(scene, {.spatial_splits = seed % 3 == 0});
    const std::vector<Ray> rays = raysAt(flat, seed + 100, 20'000, reach);
    std::vector<Hit> wanted(rays.size()), got(rays.size());
    CpuTracer(flat, flat_tree).tracePacket(rays.data(), wanted.data(), int(rays.size()));
    device(scene, tree)->traceRays(rays, got);
    expectSameHits(rays, got, wanted, fmt::format("{}, seed {}", GetParam(), seed));
    const auto hits = std::ranges::count_if(wanted, [](const Hit& h) { return h.triangle != kNoTriangle; });
    EXPECT_GT(hits, int64_t(rays.size() / 4)) << seed;
  }
}

/// With holes, glass and sides: hits, and all glass before them.
TEST_P(InstanceDevices, SeeWhatPlainScenesShowThroughHolesAndGlass) {
  size_t glass = 0;
  for (uint64_t seed = 1; seed <= 8; ++seed) {
    const float reach = seed % 4 == 3 ? 2e3f : seed % 4 == 2 ? 3.0f : 10.0f;
    const Scene scene = withSurfaces(randomInstances(seed, 60, 200, reach), seed), flat = flatten(scene);
    const Bvh flat_tree = buildBvh(flat.positions, flat.triangles);
    const Bvh tree = buildSceneTree(scene, {.spatial_splits = seed % 3 == 0});
    const std::vector<Ray> rays = raysAt(flat, seed + 100, 10'000, reach);
    std::vector<Hit> wanted(rays.size()), got(rays.size());
    const auto reference = makeDevice("cpu", flat, flat_tree), its = device(scene, tree);
    reference->traceRays(rays, wanted);
    its->traceRays(rays, got);
    expectSameHits(rays, got, wanted, fmt::format("{}, seed {}", GetParam(), seed));
    const std::vector<SeenThrough> through = reference->traceGlass(rays, wanted);
    EXPECT_EQ(its->traceGlass(rays, got), through) << seed;
    glass += through.size();
  }
  EXPECT_GT(glass, 20'000u);
}

/// Copies of a mesh in the same place: every hit is a tie, which the lowest id wins.
TEST_P(InstanceDevices, TheLowestIdWinsTies) {
  TestRandom random(7);
  InstancedScene builder(randomMesh(random, 5, 3));
  builder.addMesh(randomMesh(random, 50, 1));
  const Placement place = randomPlacement(random, 3);
  for (int i = 0; i < 5; ++i) builder.place(0, place);
  const Scene scene = builder.finish(), flat = flatten(scene);
  const std::vector<Ray> rays = raysAt(flat, 8, 5'000, 3);
  std::vector<Hit> wanted(rays.size()), got(rays.size());
  CpuTracer(flat, buildBvh(flat.positions, flat.triangles))
      .tracePacket(rays.data(), wanted.data(), int(rays.size()));
  device(scene, buildSceneTree(scene))->traceRays(rays, got);
  expectSameHits(rays, got, wanted, GetParam());
  EXPECT_TRUE(std::ranges::any_of(got, [](const Hit& h) { return h.triangle < 50; }));
  EXPECT_TRUE(std::ranges::none_of(got, [](const Hit& h) { return h.triangle >= 50 && h.triangle < 250; }));
}

/// Sets, witnesses and statistics of all methods, contained triangles among them.
TEST_P(InstanceDevices, BakeWhatPlainScenesBake) {
  for (const uint64_t seed : {1, 2, 11}) {
    Scene scene = randomInstances(seed % 10, 60, 120, 10);
    if (seed > 10) scene = withSurfaces(std::move(scene), seed);
    const Scene flat = flatten(scene);
    const ViewCell cell = {
        "cell", {1, 2, 3}, seed % 2 == 0 ? glm::dvec3(2, 2, 0) : glm::dvec3(3, 2, 1), {10, 20, 30}};
    EXPECT_EQ(containedTriangles(scene, cell), containedTriangles(flat, cell)) << seed;
    EXPECT_EQ(containedTriangles(scene, buildSceneTree(scene), cell), containedTriangles(flat, cell)) << seed;
    for (const Method method :
         seed == 1 ? std::vector{Method::kGvspp, Method::kGvs} : std::vector{Method::kGvspp}) {
      BakeParams params = testing_support::quickParams();
      params.method = method;
      params.n_rand = 20'000;
      params.validation_rays = 10'000;
      if (method == Method::kGvs) params.n_abs_edge = params.n_rs_edge = params.n_rs_area = 3;
      const std::string name = std::string(GetParam()) == "cpu" ? "cpu" : "opencl";
      const CellPvs got = testing_support::bakeOn(name, scene, cell, params, options());
      const CellPvs wanted = testing_support::bakeOn("cpu", flat, cell, params);
      EXPECT_GT(wanted.triangles.size(), 200u);
      ASSERT_EQ(got.triangles, wanted.triangles) << seed << " " << methodName(method);
      ASSERT_EQ(got.witnesses.size(), wanted.witnesses.size());
      EXPECT_EQ(std::memcmp(got.witnesses.data(), wanted.witnesses.data(),
                            got.witnesses.size() * sizeof got.witnesses[0]),
                0)
          << seed << " " << methodName(method);
      EXPECT_EQ(got.stats.border.rays, wanted.stats.border.rays);
      EXPECT_EQ(got.stats.reverse.rays, wanted.stats.reverse.rays);
      EXPECT_EQ(got.stats.missing_rays, wanted.stats.missing_rays);
    }
  }
}

/// The driver's intersection test rounds in its own way, and it takes rays to the mesh instead of vertices to
/// the world: nearly all hits are the same, and those that are not lie next to an edge.
TEST(VulkanInstances, HitNearlyWhatPlainScenesHit) {
  SL_SKIP_WITHOUT_VULKAN();
  for (const bool ray_queries : {false, true}) {
    DeviceOptions options;
    options.ray_queries = ray_queries;
    options.part_triangles = 64;  // meshes in several parts
    const Scene scene = randomInstances(5, 60, 200), flat = flatten(scene);
    const Bvh tree = buildSceneTree(scene);
    const std::vector<Ray> rays = raysAt(flat, 6, 20'000, 20, false);
    std::vector<Hit> wanted(rays.size()), got(rays.size());
    CpuTracer(flat, buildBvh(flat.positions, flat.triangles))
        .tracePacket(rays.data(), wanted.data(), int(rays.size()));
    makeDevice("vulkan", scene, tree, options)->traceRays(rays, got);
    size_t others = 0;
    for (size_t i = 0; i < rays.size(); ++i) others += got[i].triangle != wanted[i].triangle ? 1 : 0;
    EXPECT_LT(others, rays.size() / 50);
  }
}

TEST(VulkanInstances, SeeNearlyWhatPlainScenesShowThroughHolesAndGlass) {
  SL_SKIP_WITHOUT_VULKAN();
  const Scene scene = withSurfaces(randomInstances(5, 60, 200, 10), 5), flat = flatten(scene);
  const Bvh tree = buildSceneTree(scene), flat_tree = buildBvh(flat.positions, flat.triangles);
  const std::vector<Ray> rays = raysAt(flat, 6, 20'000, 10, false);
  std::vector<Hit> wanted(rays.size());
  const auto reference = makeDevice("cpu", flat, flat_tree);
  reference->traceRays(rays, wanted);
  const std::vector<SeenThrough> through = reference->traceGlass(rays, wanted);
  EXPECT_GT(through.size(), 5'000u);
  for (const bool ray_queries : {false, true}) {
    DeviceOptions options;
    options.ray_queries = ray_queries;
    options.part_triangles = 64;  // meshes in several parts
    std::vector<Hit> got(rays.size());
    const auto its = makeDevice("vulkan", scene, tree, options);
    its->traceRays(rays, got);
    size_t others = 0;
    for (size_t i = 0; i < rays.size(); ++i) others += got[i].triangle != wanted[i].triangle ? 1 : 0;
    EXPECT_LT(others, rays.size() / 50);
    std::vector<SeenThrough> beside;
    std::ranges::set_symmetric_difference(its->traceGlass(rays, wanted), through, std::back_inserter(beside));
    EXPECT_LT(beside.size(), through.size() / 50);
  }
}

TEST(VulkanInstances, BakeNearlyWhatPlainScenesBake) {
  SL_SKIP_WITHOUT_VULKAN();
  const Scene scene = randomInstances(2, 60, 120, 10), flat = flatten(scene);
  const ViewCell cell = {"cell", {1, 2, 3}, {3, 2, 1}, {10, 20, 30}};
  BakeParams params = testing_support::quickParams();
  params.n_rand = 20'000;
  params.validation_rays = 10'000;
  const CellPvs got = testing_support::bakeOn("vulkan", scene, cell, params);
  const CellPvs wanted = testing_support::bakeOn("cpu", flat, cell, params);
  std::vector<uint32_t> differ;
  std::ranges::set_symmetric_difference(got.triangles, wanted.triangles, std::back_inserter(differ));
  EXPECT_LT(differ.size(), wanted.triangles.size() / 20);
  EXPECT_GT(wanted.triangles.size(), 200u);
}

INSTANTIATE_TEST_SUITE_P(All, InstanceDevices, testing::Values("cpu", "opencl", "opencl, single rays"),
                         [](const auto& test) {
                           const std::string name = test.param;
                           return name == "cpu" ? "cpu" : name == "opencl" ? "packets" : "single";
                         });

}  // namespace
}  // namespace sightline
