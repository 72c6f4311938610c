// Instances in files: what several nodes of a glTF show is stored once where that pays, and stands for the
// same scene; what is saved with instances comes back with them.
#include <gtest/gtest.h>

#include <bit>
#include <cstring>
#include <random>

#include "core/formats/mask_image.h"
#include "core/formats/save_scene.h"
#include "core/generate/generate.h"
#include "core/scene/check_scene.h"
#include "core/scene/instances.h"
#include "core/scene/masked_triangle.h"
#include "tests/scene/files.h"
#include "tests/scene/gltf_files.h"
#include "tests/support/instanced_scene.h"

namespace sightline {
namespace {

using test::bytesOf;
using test::Folder;
using test::GltfFile;
using test::json;
using testing_support::TestRandom;

constexpr uint32_t kTriangles = 4000;

/// Nodes that show a mesh of 4,000 triangles, turned, scaled, sheared and mirrored, below a parent that does
/// so too; before, between and behind them nodes with a mesh of their own.
GltfFile forest(uint32_t nodes, uint64_t seed = 1) {
  TestRandom random(seed);
  GltfFile file;
  const Scene tree = testing_support::randomMesh(random, kTriangles, 1.0f);
  const auto addMesh = [&](const Scene& mesh) {
    const size_t positions = file.addPositions(mesh.positions);
    const size_t indices =
        file.addAccessor(file.addView(bytesOf(mesh.triangles)), 5125, mesh.triangles.size() * 3, "SCALAR");
    file.addMesh(positions, int64_t(indices));
  };
  addMesh(tree);
  addMesh(testing_support::randomMesh(random, 10, 1.0f));
  json list = json::array();
  json children = json::array();
  for (uint32_t i = 0; i < nodes; ++i) {
    if (i == nodes / 2) {
      children.push_back(list.size());
      list.push_back({{"mesh", 1}, {"name", "rock"}, {"translation", {3, 2, 1}}});
    }
    const Placement place = testing_support::randomPlacement(random, 50);
    json matrix = json::array();
    for (const vec4* column : {&place.x, &place.y, &place.z, &place.origin}) {
      for (int row = 0; row < 3; ++row) matrix.push_back((*column)[row]);
      matrix.push_back(column == &place.origin ? 1 : 0);
    }
    children.push_back(list.size());
    list.push_back({{"mesh", 0}, {"name", "tree " + std::to_string(i)}, {"matrix", matrix}});
  }
  list.push_back({{"children", children}, {"scale", {1, -1.5, 2}}, {"rotation", {0.6, 0, 0, 0.8}}});
  file.document["nodes"] = list;
  file.document["scenes"] = {{{"nodes", {list.size() - 1}}}};
  file.document["scene"] = 0;
  return file;
}

bool sameBits(const glm::vec3& a, const glm::vec3& b) {
  for (int i = 0; i < 3; ++i) {
    if (std::bit_cast<uint32_t>(a[i]) != std::bit_cast<uint32_t>(b[i])) return false;
  }
  return true;
}

void expectSameScene(const Scene& a, const Scene& b) {
  ASSERT_EQ(a.triangleCount(), b.triangleCount());
  EXPECT_EQ(a.vertexCount(), b.vertexCount());
  EXPECT_EQ(hashScene(a), hashScene(b));
  EXPECT_EQ(a.degenerate_triangles, b.degenerate_triangles);
  EXPECT_EQ(a.single_sided_triangles, b.single_sided_triangles);
  ASSERT_EQ(a.objects.size(), b.objects.size());
  for (size_t i = 0; i < a.objects.size(); ++i) {
    EXPECT_EQ(a.objects[i].name, b.objects[i].name);
    EXPECT_EQ(a.objects[i].first_triangle, b.objects[i].first_triangle);
    EXPECT_EQ(a.objects[i].triangle_count, b.objects[i].triangle_count);
  }
  for (uint32_t id = 0; id < a.triangleCount(); id += 997) {
    for (size_t c = 0; c < 3; ++c) ASSERT_TRUE(sameBits(a.corners(id)[c], b.corners(id)[c])) << id;
  }
}

Scene load(const GltfFile& file, bool flatten) {
  const Folder folder;
  return loadScene(folder.write("forest.glb", file.glb()), {.flatten = flatten});
}

TEST(InstancesInFiles, AreStoredOnceWhereThatPays) {
  const GltfFile file = forest(300);
  const Scene scene = load(file, false), flat = load(file, true);
  ASSERT_TRUE(scene.hasInstances());
  checkScene(scene);
  EXPECT_EQ(scene.instances.size(), 300u);
  EXPECT_EQ(scene.meshes.size(), 1u);
  EXPECT_EQ(scene.triangles.size(), kTriangles + 10);
  EXPECT_FALSE(flat.hasInstances());
  EXPECT_EQ(flat.triangles.size(), 300 * kTriangles + 10);
  expectSameScene(scene, flat);
  EXPECT_EQ(scene.objects[150].name, "rock");
  EXPECT_EQ(scene.objects[150].first_triangle, 150 * kTriangles);
}

/// The same vertices, to a few units in the last place, and the same corners' order as by the nodes' matrices
/// in double.
TEST(InstancesInFiles, StandWhereTheirNodesPutThem) {
  const GltfFile file = forest(300);
  const Scene scene = load(file, false);
  GltfFile single = file;
  for (const uint32_t node : {0u, 7u, 120u}) {
    // Alone, the mesh is no instance.
    json kept = file.document["nodes"];
    const json children = kept.back()["children"];
    kept.back()["children"] = json::array({children[node < 150 ? node : node + 1]});
    single.document["nodes"] = kept;
    single.document["scenes"] = {{{"nodes", {kept.size() - 1}}}};
    const Scene plain = load(single, false);
    ASSERT_FALSE(plain.hasInstances());
    ASSERT_EQ(plain.triangleCount(), kTriangles);
    for (uint32_t i = 0; i < kTriangles; ++i) {
      const auto got = scene.corners(node * kTriangles + i), wanted = plain.corners(i);
      for (size_t c = 0; c < 3; ++c) {
        ASSERT_LT(glm::length(glm::dvec3(got[c]) - glm::dvec3(wanted[c])), 200 * 0x1p-21) << node << " " << i;
      }
    }
  }
}

TEST(InstancesInFiles, AreWrittenOutWhereThatDoesNotPay) {
  EXPECT_FALSE(load(forest(2), false).hasInstances());
  EXPECT_FALSE(load(forest(200), false).hasInstances()) << "less than 2^20 triangles";
}

/// Nodes that squeeze the mesh flat, or put it on the spot in spite of a far place, are written out; others
/// stay instances, in one scene, in the order of the file.
TEST(InstancesInFiles, WhatCannotBePlacedIsPlain) {
  GltfFile file = forest(300);
  file.document["nodes"][5]["matrix"] = {1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  const Scene scene = load(file, false);
  ASSERT_TRUE(scene.hasInstances());
  checkScene(scene);
  EXPECT_EQ(scene.instances.size(), 299u);
  EXPECT_EQ(scene.plainTriangles(), kTriangles + 10);
  EXPECT_EQ(scene.degenerate_triangles, load(file, true).degenerate_triangles);
  expectSameScene(scene, load(file, true));
}

/// The forest with holes in its trees, and a rock of glass.
GltfFile leafyForest() {
  GltfFile file = forest(300);
  TestRandom random(5);
  Surfaces surfaces;
  addMask(surfaces, 8, 4, {kWrapRepeat, kWrapRepeat}, [](uint64_t i) { return i % 3 == 0; });
  const std::vector<uint8_t> png = maskImage(surfaces, 0);
  json& primitive = file.document["meshes"][0]["primitives"][0];
  const size_t positions = primitive["attributes"]["POSITION"];
  const size_t count = file.document["accessors"][positions]["count"];
  std::vector<glm::vec2> places(count);
  for (glm::vec2& place : places) {
    place.x = random.between(-3, 3);
    place.y = random.between(-3, 3);
  }
  primitive["attributes"]["TEXCOORD_0"] =
      file.addAccessor(file.addView(bytesOf(places)), 5126, count, "VEC2");
  primitive["material"] = 0;
  file.document["meshes"][1]["primitives"][0]["material"] = 1;
  file.document["materials"] = {
      {{"alphaMode", "MASK"}, {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}},
      {{"alphaMode", "BLEND"}, {"doubleSided", true}}};
  file.document["textures"] = {{{"source", 0}}};
  file.document["images"] = {{{"bufferView", file.addView(bytesOf(png))}, {"mimeType", "image/png"}}};
  return file;
}

Scene loadCulled(const GltfFile& file, bool flatten) {
  const Folder folder;
  return loadScene(folder.write("forest.glb", file.glb()), {.cull_back_faces = true, .flatten = flatten});
}

TEST(InstancesInFiles, HaveHolesGlassAndSides) {
  const GltfFile file = leafyForest();
  const Scene scene = loadCulled(file, false), flat = loadCulled(file, true);
  ASSERT_TRUE(scene.hasInstances());
  EXPECT_FALSE(flat.hasInstances());
  checkScene(scene);
  checkScene(flat);
  EXPECT_EQ(scene.triangles.size(), kTriangles + 10);
  EXPECT_EQ(scene.surfaces.masked.size(), kTriangles) << "once";
  expectSameScene(scene, flat);
  for (const Scene* its : {&scene, &flat}) {
    EXPECT_EQ(its->alpha_triangles, 300u * kTriangles + 10);
    EXPECT_EQ(its->single_sided_triangles, 300u * kTriangles);
    const SurfaceCounts counts = countSurfaces(*its);
    EXPECT_EQ(counts.masked, 300u * kTriangles);
    EXPECT_EQ(counts.front_only, 300u * kTriangles);
    EXPECT_EQ(counts.glass, 10u);
  }
  // Alone, the mesh is no instance: the loader itself places and turns its triangles.
  size_t mirrored = 0;
  for (uint32_t node = 0; node < 8; ++node) {
    GltfFile single = file;
    json& nodes = single.document["nodes"];
    nodes.back()["children"] = json::array({nodes.back()["children"][node]});
    const Scene plain = loadCulled(single, false);
    ASSERT_FALSE(plain.hasInstances());
    mirrored += scene.instances[node].mirrors ? 1 : 0;
    for (uint32_t i = 0; i < kTriangles; ++i) {
      const uint32_t id = node * kTriangles + i;
      ASSERT_EQ(scene.surfaceOf(id) & ~kSurfaceIndex, plain.surfaceOf(i) & ~kSurfaceIndex);
      const MaskedTriangle got = scene.maskPlaces(id), wanted = plain.maskPlaces(i);
      ASSERT_EQ(std::memcmp(&got, &wanted, sizeof got), 0) << node << " " << i;
    }
  }
  EXPECT_TRUE(mirrored > 0 && mirrored < 8) << mirrored;
}

/// Where no place can be an instance the scene is the one that it always was, to the last record.
TEST(InstancesInFiles, LeaveNoSurfacesOfMeshesThatArePlain) {
  GltfFile file = leafyForest();
  for (json& node : file.document["nodes"]) {
    if (node.contains("matrix")) node["matrix"] = {1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  }
  const Scene scene = load(file, false);
  EXPECT_FALSE(scene.hasInstances());
  EXPECT_EQ(scene.surfaces.masked.size(), 300u * kTriangles);
  EXPECT_EQ(scene.surfaceOf(0), kSurfaceMasked);
}

/// Far out, where floats step by half a metre: the places lose the offset, and are those of the same forest
/// near the origin.
TEST(InstancesInFiles, FarFromTheOriginAreThoseNearIt) {
  GltfFile near_file = forest(300), far_file = near_file;
  const glm::dvec3 far_away(500'000, 0, 5'500'000);
  const auto under = [](GltfFile& file, const glm::dvec3& place) {
    json& nodes = file.document["nodes"];
    nodes.push_back({{"children", {nodes.size() - 1}}, {"translation", {place.x, place.y, place.z}}});
    file.document["scenes"] = {{{"nodes", {nodes.size() - 1}}}};
  };
  under(near_file, {0, 0, 0});
  under(far_file, far_away);
  const Scene near_scene = load(near_file, false), scene = load(far_file, false), flat = load(far_file, true);
  ASSERT_TRUE(near_scene.hasInstances() && scene.hasInstances());
  EXPECT_EQ(near_scene.offset, glm::dvec3(0));
  EXPECT_GT(scene.offset.z, 5'000'000);
  checkScene(scene);
  EXPECT_EQ(scene.instances.size(), 300u);
  expectSameScene(scene, flat);
  for (uint32_t id = 0; id < scene.triangleCount(); id += 101) {
    for (size_t c = 0; c < 3; ++c) {
      const glm::dvec3 got = glm::dvec3(scene.corners(id)[c]) + scene.offset - far_away;
      ASSERT_LT(glm::length(got - glm::dvec3(near_scene.corners(id)[c])), 1e-3) << id;
    }
  }
  // Written again, they are where they were.
  const Folder folder;
  saveScene(scene, folder / "again.glb");
  const Scene again = loadScene(folder / "again.glb");
  EXPECT_EQ(again.offset, scene.offset);
  expectSameScene(again, scene);
}

TEST(InstancesInFiles, RepairDropsInEachPlace) {
  GltfFile file = forest(300);
  // The last triangle's corner is out of range.
  const size_t accessor = file.document["meshes"][0]["primitives"][0]["indices"];
  const size_t view = file.document["accessors"][accessor]["bufferView"];
  const size_t begin = file.document["bufferViews"][view].value("byteOffset", 0);
  for (int i = 0; i < 4; ++i) file.bin[begin + (kTriangles * 3 - 1) * 4 + size_t(i)] = '\x7f';
  const Folder folder;
  const std::filesystem::path path = folder.write("forest.glb", file.glb());
  EXPECT_THROW(loadScene(path), Error);
  const Scene scene = loadScene(path, {.repair = true});
  EXPECT_EQ(scene.repaired_triangles, 300u);
  ASSERT_TRUE(scene.hasInstances());
  EXPECT_EQ(scene.triangleCount(), 300 * (kTriangles - 1) + 10);
  expectSameScene(scene, loadScene(path, {.repair = true, .flatten = true}));
}

TEST(InstancesInFiles, ComeBackFromAGlb) {
  for (const char* name : {"plant", "city"}) {
    const Scene scene = generateRepeated(name, 3'000'000, 3, 2);
    checkScene(scene);
    ASSERT_TRUE(scene.hasInstances()) << name;
    EXPECT_LE(scene.triangleCount(), 3'000'000u) << name;
    EXPECT_GE(scene.triangleCount(), 2'900'000u) << name;
    const Folder folder;
    const std::filesystem::path path = folder / "repeated.glb";
    saveScene(scene, path);
    const Scene loaded = loadScene(path), flat = loadScene(path, {.flatten = true});
    EXPECT_TRUE(loaded.hasInstances()) << name;
    ASSERT_EQ(loaded.triangleCount(), scene.triangleCount());
    expectSameScene(loaded, flat);
    expectSameScene(loaded, flatten(scene));
  }
}

TEST(InstancesInFiles, RepeatedScenesAreTheSameEveryTime) {
  const Scene a = generateRepeated("plant", 200'000, 3, 2), b = generateRepeated("plant", 200'000, 3, 2);
  EXPECT_EQ(hashScene(a), hashScene(b));
  EXPECT_NE(hashScene(a), hashScene(generateRepeated("plant", 200'000, 4, 2)));
  EXPECT_THROW(generateRepeated("bistro", 200'000, 3, 2), Error);
  EXPECT_THROW(generateRepeated("plant", 200'000, 3, 0), Error);
  EXPECT_TRUE(std::ranges::any_of(a.instances, [](const SceneInstance& i) { return i.mirrors; }));
}

}  // namespace
}  // namespace sightline
