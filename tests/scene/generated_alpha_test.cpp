// Generated scenes with leaves and panes: their files give back the same surfaces, and without the option
// nothing changes. What any scene has of surfaces survives being written again.
#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "core/base/error.h"
#include "core/export/export.h"
#include "core/formats/load_scene.h"
#include "core/formats/save_scene.h"
#include "core/generate/generate.h"
#include "core/scene/check_scene.h"
#include "core/scene/masked_triangle.h"
#include "tests/scene/files.h"

namespace sightline {
namespace {

using test::errorOf;
using test::Folder;

template <typename T>
bool sameBytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

void expectSameSurfaces(const Surfaces& a, const Surfaces& b) {
  EXPECT_EQ(a.words, b.words);
  EXPECT_TRUE(sameBytes(a.masked, b.masked));
  EXPECT_TRUE(sameBytes(a.masks, b.masks));
  EXPECT_EQ(a.texels, b.texels);
}

void expectSameObjects(const Scene& a, const Scene& b) {
  ASSERT_EQ(a.objects.size(), b.objects.size());
  for (size_t i = 0; i < a.objects.size(); ++i) {
    EXPECT_EQ(a.objects[i].name, b.objects[i].name);
    EXPECT_EQ(a.objects[i].first_triangle, b.objects[i].first_triangle);
    EXPECT_EQ(a.objects[i].triangle_count, b.objects[i].triangle_count);
    EXPECT_EQ(a.objects[i].single_sided, b.objects[i].single_sided);
  }
}

class GeneratedAlpha : public testing::TestWithParam<std::tuple<const char*, uint64_t>> {};

TEST_P(GeneratedAlpha, ComesBackFromItsFile) {
  const auto [name, triangles] = GetParam();
  const Scene scene = generateScene(name, triangles, 3, {.alpha = true});
  checkScene(scene);
  const SurfaceCounts counts = countSurfaces(scene);
  EXPECT_GT(counts.masked, 0u);
  EXPECT_GT(counts.glass, 0u);
  EXPECT_EQ(counts.masked + counts.glass, scene.alpha_triangles);
  EXPECT_LE(scene.triangles.size(), triangles);
  EXPECT_GE(double(scene.triangles.size()), (triangles < 10'000 ? 0.85 : 0.97) * double(triangles));
  const Folder folder;
  saveScene(scene, folder / "a.glb");
  const Scene loaded = loadScene(folder / "a.glb");
  EXPECT_EQ(loaded.positions, scene.positions);
  EXPECT_EQ(loaded.triangles, scene.triangles);
  EXPECT_EQ(loaded.alpha_triangles, scene.alpha_triangles);
  expectSameSurfaces(loaded.surfaces, scene.surfaces);
  expectSameObjects(loaded, scene);
  EXPECT_EQ(hashScene(loaded), hashScene(scene));
}

TEST_P(GeneratedAlpha, HasOneMatterAnObject) {
  const auto [name, triangles] = GetParam();
  const Scene scene = generateScene(name, triangles, 3, {.alpha = true});
  for (const SceneObject& object : scene.objects) {
    const uint32_t wanted = object.name.ends_with("-panes")    ? kSurfaceGlass
                            : object.name.ends_with("-leaves") ? kSurfaceMasked
                                                               : 0u;
    for (uint32_t i = 0; i < object.triangle_count; ++i) {
      ASSERT_EQ(scene.surfaces.of(object.first_triangle + i) & ~kSurfaceIndex, wanted) << object.name;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, GeneratedAlpha,
                         testing::Combine(testing::Values("city", "bistro"),
                                          testing::Values(20'000ull, 300'000ull)),
                         [](const auto& c) {
                           return std::string(std::get<0>(c.param)) + std::to_string(std::get<1>(c.param));
                         });

TEST(GeneratedAlphaErrors, OfScenesWithoutLeavesAndPanes) {
  EXPECT_EQ(errorOf([] { generateScene("plant", 20'000, 1, {.alpha = true}); }),
            "the scene 'plant' has neither leaves nor panes: city and bistro have");
}

/// A twig holds on a part of its card, in one piece with its lower edge.
TEST(LeafMask, IsATwig) {
  const Scene scene = generateScene("bistro", 20'000, 1, {.alpha = true});
  ASSERT_EQ(scene.surfaces.masks.size(), 1u);
  const uvec4 size = scene.surfaces.masks[0].size_wrap_first;
  std::vector<bool> holds(size_t(size.x) * size.y);
  size_t count = 0;
  for (size_t i = 0; i < holds.size(); ++i) {
    holds[i] = ((scene.surfaces.texels[i / 32] >> (i % 32)) & 1u) != 0;
    count += holds[i] ? 1 : 0;
  }
  EXPECT_GT(double(count), 0.3 * double(holds.size()));
  EXPECT_LT(double(count), 0.7 * double(holds.size()));
  std::vector<size_t> open = {holds.size() - size.x / 2};
  ASSERT_TRUE(holds[open[0]]);
  std::vector<bool> met(holds.size(), false);
  met[open[0]] = true;
  size_t connected = 0;
  while (!open.empty()) {
    const auto at = int64_t(open.back());
    open.pop_back();
    ++connected;
    const int64_t x = at % size.x, y = at / size.x;
    for (const auto& [dx, dy] :
         {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, 1}, {1, -1}, {-1, -1}}) {
      if (x + dx < 0 || x + dx >= size.x || y + dy < 0 || y + dy >= size.y) continue;
      const auto next = size_t((y + dy) * size.x + x + dx);
      if (!holds[next] || met[next]) continue;
      met[next] = true;
      open.push_back(next);
    }
  }
  EXPECT_EQ(connected, count);
}

/// Vertices that all kinds of triangles share, two masks, places that repeat, and every mixture of flags.
Scene mixedScene(uint64_t seed) {
  std::mt19937_64 random(seed);
  Scene scene;
  for (int i = 0; i < 60; ++i) {
    scene.positions.emplace_back(float(random() % 1000), float(random() % 1000), float(random() % 1000));
  }
  addMask(scene.surfaces, 7, 5, {kWrapRepeat, kWrapMirror}, [](uint64_t i) { return i % 3 == 0; });
  addMask(scene.surfaces, 64, 32, {kWrapClamp, kWrapRepeat}, [](uint64_t i) { return i % 5 == 0; });
  for (uint32_t object = 0; object < 12; ++object) {
    const auto first = uint32_t(scene.triangles.size());
    const uint32_t kind = object % 6;
    for (int i = 0; i < 7; ++i) {
      const auto a = uint32_t(random() % 20), b = uint32_t(20 + random() % 20),
                 c = uint32_t(40 + random() % 20);
      scene.triangles.emplace_back(a, b, c);
      uint32_t word = kind == 1 || kind == 4 ? kSurfaceGlass : 0u;
      if (kind >= 2 && kind <= 4) {
        const uint32_t mask = kind == 2 ? 0 : 1;
        const auto place = [&] {
          return glm::dvec2(float(random() % 4096) / 512, float(random() % 4096) / 512);
        };
        scene.surfaces.masked.push_back(*maskedTriangle(scene.surfaces, mask, {place(), place(), place()}));
        word |= kSurfaceMasked | uint32_t(scene.surfaces.masked.size() - 1);
      }
      scene.surfaces.words.push_back(word);
    }
    scene.objects.push_back({"object " + std::to_string(object), first, 7});
    scene.objects.back().single_sided = object >= 6;
    if (object >= 6) scene.single_sided_triangles += 7;
  }
  return scene;
}

TEST(SaveSurfaces, ComeBackOfAnyScene) {
  const Folder folder;
  for (uint64_t seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Scene scene = mixedScene(seed);
    saveScene(scene, folder / "a.glb");
    const Scene loaded = loadScene(folder / "a.glb");
    expectSameSurfaces(loaded.surfaces, scene.surfaces);
    expectSameObjects(loaded, scene);
    EXPECT_EQ(loaded.single_sided_triangles, scene.single_sided_triangles);
    ASSERT_EQ(loaded.triangleCount(), scene.triangleCount());
    for (uint32_t id = 0; id < scene.triangleCount(); ++id) {
      ASSERT_EQ(loaded.corners(id), scene.corners(id)) << id;
    }
    // Sides are those of single objects, not of all.
    const Scene culled = loadScene(folder / "a.glb", {.cull_back_faces = true});
    for (uint32_t id = 0; id < scene.triangleCount(); ++id) {
      EXPECT_EQ((culled.surfaces.of(id) & kSurfaceFrontOnly) != 0, id >= 42) << id;
    }
    // Written again, it is the same file, with its sides, too.
    saveScene(loaded, folder / "b.glb");
    saveScene(loadScene(folder / "b.glb"), folder / "c.glb");
    EXPECT_EQ(test::readText(folder / "b.glb"), test::readText(folder / "c.glb"));
    saveScene(culled, folder / "d.glb");
    expectSameSurfaces(loadScene(folder / "d.glb", {.cull_back_faces = true}).surfaces, culled.surfaces);
  }
}

/// Doors open: glass among the triangles of an object.
TEST(SaveSurfaces, AnObjectOfSeveralKindsComesBackAsSeveral) {
  const Folder folder;
  Scene scene = mixedScene(1);
  for (uint32_t id = 2; id < 5; ++id) scene.surfaces.words[id] |= kSurfaceGlass;
  saveScene(scene, folder / "a.glb");
  const Scene loaded = loadScene(folder / "a.glb");
  expectSameSurfaces(loaded.surfaces, scene.surfaces);
  ASSERT_EQ(loaded.objects.size(), scene.objects.size() + 2);
  EXPECT_EQ(loaded.objects[1].name, "object 0/1");
  EXPECT_EQ(loaded.objects[1].triangle_count, 3u);
}

TEST(SaveSurfaces, NotInAnObj) {
  const Folder folder;
  EXPECT_EQ(errorOf([&] { saveScene(mixedScene(1), folder / "a.obj"); }),
            "a.obj: an OBJ holds no masks, glass or sides, which the scene has; write .glb");
}

TEST(SaveSurfaces, OfWhatACellSees) {
  const Scene scene = mixedScene(2);
  CellPvs cell;
  for (uint32_t id = 1; id < scene.triangleCount(); id += 2) cell.triangles.push_back(id);
  const Folder folder;
  saveScene(visibleScene(scene, cell), folder / "seen.glb");
  const Scene seen = loadScene(folder / "seen.glb");
  ASSERT_EQ(seen.triangleCount(), cell.triangles.size());
  for (uint32_t i = 0; i < seen.triangleCount(); ++i) {
    const uint32_t id = cell.triangles[i];
    EXPECT_EQ(seen.corners(i), scene.corners(id));
    const uint32_t word = seen.surfaces.of(i), wanted = scene.surfaces.of(id);
    ASSERT_EQ(word & ~kSurfaceIndex, wanted & ~kSurfaceIndex);
    if ((word & kSurfaceMasked) == 0) continue;
    const MaskedTriangle &a = seen.surfaces.masked[word & kSurfaceIndex],
                         &b = scene.surfaces.masked[wanted & kSurfaceIndex];
    EXPECT_EQ(a.corners_ab, b.corners_ab);
    EXPECT_EQ(glm::uvec2(a.corner_c_mask), glm::uvec2(b.corner_c_mask));
    const AlphaMask &mask = seen.surfaces.masks[a.corner_c_mask.z],
                    &its = scene.surfaces.masks[b.corner_c_mask.z];
    EXPECT_EQ(glm::uvec3(mask.size_wrap_first), glm::uvec3(its.size_wrap_first));
  }
}

}  // namespace
}  // namespace sightline
