// What extensions of glTF make of geometry: streams of Draco (written by libdraco's own encoder) and
// meshoptimizer, instances, levels of detail.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <random>
#include <set>

#include "core/formats/load_scene.h"
#include "tests/scene/files.h"
#include "tests/scene/gltf_draco.h"
#include "tests/scene/gltf_files.h"

namespace sightline {
namespace {

using test::bytesOf;
using test::GltfFile;
using test::json;
using test::loadError;
using test::loadText;
using test::squareFile;

/// A triangle's corners, the lowest first, whatever order the codec leaves them in (it keeps the front).
std::array<glm::vec3, 3> turned(std::array<glm::vec3, 3> corners) {
  const auto less = [](const glm::vec3& a, const glm::vec3& b) {
    return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
  };
  std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end(), less), corners.end());
  return corners;
}

using Corners = std::array<float, 9>;

std::multiset<Corners> trianglesOf(const std::vector<glm::vec3>& positions,
                                   const std::vector<glm::uvec3>& triangles) {
  std::multiset<Corners> result;
  for (const glm::uvec3& t : triangles) {
    const auto c = turned({positions[t.x], positions[t.y], positions[t.z]});
    result.insert({c[0].x, c[0].y, c[0].z, c[1].x, c[1].y, c[1].z, c[2].x, c[2].y, c[2].z});
  }
  return result;
}

TEST(Draco, MeshesOfBothMethodsComeBack) {
  for (const bool edgebreaker : {true, false}) {
    for (const int side : {1, 2, 40}) {
      const test::DracoGrid grid(side);
      const GltfFile file = grid.file(edgebreaker);
      const Scene scene = loadText("a.glb", file.glb());
      test::expectValid(scene);
      EXPECT_TRUE(scene.warnings.empty());
      EXPECT_EQ(trianglesOf(scene.positions, scene.triangles), trianglesOf(grid.positions, grid.triangles));
      const Scene text = loadText("a.gltf", file.gltf());
      EXPECT_EQ(text.positions, scene.positions);
      EXPECT_EQ(text.triangles, scene.triangles);
    }
  }
}

TEST(Draco, MovesWithItsNodeAndSharesItsVertices) {
  const test::DracoGrid grid(3);
  GltfFile file = grid.file(true);
  file.document["nodes"] = {{{"mesh", 0}, {"translation", {10, 0, 0}}}, {{"mesh", 0}, {"scale", {-1, 1, 1}}}};
  const Scene scene = loadText("a.glb", file.glb());
  ASSERT_EQ(scene.objects.size(), 2u);
  std::vector<glm::vec3> right = grid.positions, left = grid.positions;
  for (glm::vec3& p : right) p.x += 10;
  for (glm::vec3& p : left) p.x = -p.x;
  std::vector<glm::uvec3> fronts = grid.triangles;  // a mirror's front stays the front
  for (glm::uvec3& t : fronts) std::swap(t.y, t.z);
  const auto split = scene.triangles.begin() + std::ptrdiff_t(grid.triangles.size());
  EXPECT_EQ(trianglesOf(scene.positions, {scene.triangles.begin(), split}),
            trianglesOf(right, grid.triangles));
  EXPECT_EQ(trianglesOf(scene.positions, {split, scene.triangles.end()}), trianglesOf(left, fronts));
}

TEST(Draco, CountsOfTheStreamWin) {
  GltfFile file = test::DracoGrid(3).file(true);
  file.document["accessors"][0]["count"] = 1000;
  file.document["accessors"][1]["count"] = 3;
  const Scene scene = loadText("a.glb", file.glb());
  EXPECT_EQ(scene.triangles.size(), 18u);
  EXPECT_EQ(scene.warnings, std::vector<std::string>{
                                "accessors whose count is not that of their Draco stream, which holds: 2"});
}

TEST(Draco, SkinsAreRead) {
  const test::DracoGrid grid(2);
  GltfFile file = grid.file(false, true);
  file.document["skins"] = {{{"joints", {1, 2}}}};
  file.document["nodes"] = {{{"mesh", 0}, {"skin", 0}, {"translation", {5, 5, 5}}},
                            {{"translation", {1, 0, 0}}},
                            {{"translation", {0, 0, 7}}}};
  const Scene scene = loadText("a.glb", file.glb());
  std::vector<glm::vec3> placed = grid.positions;
  for (size_t i = 0; i < placed.size(); ++i)
    placed[i] += i % 2 == 0 ? glm::vec3(1, 0, 0) : glm::vec3(0, 0, 7);
  EXPECT_EQ(trianglesOf(scene.positions, scene.triangles), trianglesOf(placed, grid.triangles));
}

TEST(Draco, DamagedStreamsAreOneLine) {
  for (const bool edgebreaker : {true, false}) {
    const GltfFile good = test::DracoGrid(8).file(edgebreaker);
    const size_t bytes = good.document["bufferViews"][0]["byteLength"];
    const std::string place = "a.glb: meshes[0].primitives[0].extensions.KHR_draco_mesh_compression: ";
    for (size_t length = 0; length < bytes; ++length) {
      GltfFile cut = good;
      cut.document["bufferViews"][0]["byteLength"] = length;
      const std::string error = loadError("a.glb", cut.glb());
      EXPECT_EQ(error.find(place), 0u) << error;
    }
    // Where the numbers of points and triangles stand, and everywhere else: never a crash, and no memory for
    // what the stream cannot hold.
    std::mt19937_64 random(5);
    for (int round = 0; round < 4000; ++round) {
      GltfFile bad = good;
      for (int change = 0; change < 3; ++change) {
        const size_t at = round % 2 == 0 ? random() % 24 : random() % bytes;
        bad.bin[at] = round % 3 == 0 ? '\xff' : char(random());
      }
      try {
        test::expectValid(loadText("a.glb", bad.glb()));
      } catch (const Error& error) {
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
      }
    }
  }
}

TEST(Draco, ErrorsNameThePlace) {
  const std::string place = "a.glb: meshes[0].primitives[0].extensions.KHR_draco_mesh_compression";
  const auto with = [&](const std::function<void(json&, std::string&)>& change) {
    GltfFile file = test::DracoGrid(3).file(true);
    change(file.document, file.bin);
    return loadError("a.glb", file.glb());
  };
  const auto extension = [](json& d) -> json& {
    return d["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"];
  };
  EXPECT_EQ(with([&](json& d, std::string&) { extension(d)["bufferView"] = 3; }),
            place + ".bufferView: 3 is out of range, there are 1 in the file");
  EXPECT_EQ(with([&](json& d, std::string&) { extension(d)["attributes"]["POSITION"] = 9; }),
            place + ": the Draco stream has no attribute of the number 9; export the file again");
  EXPECT_EQ(with([&](json& d, std::string&) { d["meshes"][0]["primitives"][0].erase("indices"); }),
            place + ": the primitive has no indices");
  EXPECT_EQ(with([&](json& d, std::string&) { d["accessors"][0]["type"] = "VEC2"; }),
            place + ": the Draco stream's attribute 0 has 3 components, its accessor 2");
  EXPECT_EQ(with([&](json& d, std::string&) { d["meshes"][0]["primitives"][0]["mode"] = 6; }),
            place + ": compresses triangles only, and the primitive's mode is neither 4 nor 5");
  EXPECT_EQ(with([&](json&, std::string& bin) { bin[6] = 1; }),
            place + ": Draco bitstream version 2.1, glTF has 2.2; export the file again")
      << "minor";
  EXPECT_EQ(with([&](json&, std::string& bin) { bin[7] = 0; }),
            place + ": the Draco stream holds points, not a mesh");
}

TEST(Meshopt, KhrStreamsOfVersion0AreRead) {
  for (const bool sequence : {false, true}) {
    GltfFile file = test::compressedSquare(sequence);
    const std::string text = file.document.dump();
    const Scene ext = loadText("a.glb", file.glb());
    for (json& view : file.document["bufferViews"]) {
      view["extensions"]["KHR_meshopt_compression"] = view["extensions"]["EXT_meshopt_compression"];
      view["extensions"].erase("EXT_meshopt_compression");
    }
    file.document["extensionsRequired"] = {"KHR_meshopt_compression"};
    const Scene khr = loadText("a.glb", file.glb());
    EXPECT_EQ(khr.positions, ext.positions);
    EXPECT_EQ(khr.triangles, ext.triangles);
    // The vertices' stream comes first.
    GltfFile newer = file;
    ASSERT_EQ(newer.bin[0], '\xa0');
    newer.bin[0] = '\xa1';
    EXPECT_EQ(
        loadError("a.glb", newer.glb()),
        "a.glb: bufferViews[0].extensions.KHR_meshopt_compression: version 1 of meshoptimizer's vertex "
        "streams is not read, only up to 0; compress the file for EXT_meshopt_compression, or not at all");
    file.document["bufferViews"][0]["extensions"]["KHR_meshopt_compression"]["filter"] = "COLOR";
    EXPECT_EQ(loadError("a.glb", file.glb()),
              "a.glb: bufferViews[0].extensions.KHR_meshopt_compression.filter: COLOR holds no positions");
  }
}

/// A triangle that a node places `places` times.
GltfFile instanced(const std::vector<glm::vec3>& translations, const std::vector<glm::vec4>& rotations,
                   const std::vector<glm::vec3>& scales) {
  GltfFile file;
  file.addMesh(file.addPositions({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}), -1);
  json attributes;
  if (!translations.empty()) attributes["TRANSLATION"] = file.addPositions(translations);
  if (!rotations.empty()) {
    attributes["ROTATION"] =
        file.addAccessor(file.addView(bytesOf(rotations)), 5126, rotations.size(), "VEC4");
  }
  if (!scales.empty()) attributes["SCALE"] = file.addPositions(scales);
  file.document["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = attributes;
  file.document["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
  return file;
}

TEST(GpuInstancing, PlacesAreTranslationTimesRotationTimesScale) {
  std::mt19937_64 random(3);
  const auto number = [&] { return float(double(random() >> 11) * 0x1p-53 - 0.5); };
  std::vector<glm::vec3> translations, scales;
  std::vector<glm::vec4> rotations;
  for (int i = 0; i < 50; ++i) {
    translations.emplace_back(number(), number(), number());
    scales.emplace_back(number(), number(), number());
    rotations.push_back(glm::normalize(glm::vec4(number(), number(), number(), number())));
  }
  GltfFile file = instanced(translations, rotations, scales);
  file.document["nodes"][0]["translation"] = {1, 2, 3};
  file.document["nodes"][0]["scale"] = {1, -2, 1};
  file.document["nodes"][0]["name"] = "tree";
  const Scene scene = loadText("a.glb", file.glb());
  test::expectValid(scene);
  ASSERT_EQ(scene.triangles.size(), 50u);
  for (uint32_t i = 0; i < 50; ++i) {
    EXPECT_EQ(scene.objects[i].name, fmt::format("tree#{}", i));
    const glm::dquat q(rotations[i].w, rotations[i].x, rotations[i].y, rotations[i].z);
    const auto place = [&](const glm::dvec3& p) {
      const glm::dvec3 placed = q * (glm::dvec3(scales[i]) * p) + glm::dvec3(translations[i]);
      return glm::vec3(glm::dvec3(1, 2, 3) + glm::dvec3(1, -2, 1) * placed);
    };
    const bool mirrored = double(scales[i].x) * scales[i].y * scales[i].z > 0;  // the node mirrors once more
    const glm::vec3 expected[] = {place({0, 0, 0}),
                                  place(mirrored ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0)),
                                  place(mirrored ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0))};
    for (size_t corner = 0; corner < 3; ++corner) {
      EXPECT_LT(glm::length(scene.corners(i)[corner] - expected[corner]), 1e-6f) << i << " " << corner;
    }
  }
}

TEST(GpuInstancing, NormalizedRotationsAndMissingAttributes) {
  GltfFile file = instanced({{0, 0, 0}, {5, 0, 0}}, {}, {});
  const std::vector<int16_t> turns = {0, 0, 32767, 0, 0, 0, 0, 32767};  // by 180 degrees about z; not
  const size_t rotation = file.addAccessor(file.addView(bytesOf(turns)), 5122, 2, "VEC4");
  file.document["accessors"][rotation]["normalized"] = true;
  file.document["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["ROTATION"] = rotation;
  const Scene scene = loadText("a.glb", file.glb());
  EXPECT_EQ(scene.corners(0)[1], glm::vec3(-1, 0, 0));
  EXPECT_EQ(scene.corners(1)[1], glm::vec3(6, 0, 0));
  const Scene scaled = loadText("a.glb", instanced({}, {}, {{2, 2, 2}, {3, 3, 3}}).glb());
  EXPECT_EQ(scaled.corners(0)[1], glm::vec3(2, 0, 0));
  EXPECT_EQ(scaled.corners(1)[1], glm::vec3(3, 0, 0));
}

TEST(GpuInstancing, BadInstances) {
  const glm::vec3 nan(NAN, 0, 0);
  const std::string place = "a.glb: nodes[0].extensions.EXT_mesh_gpu_instancing";
  const GltfFile bad = instanced({{0, 0, 0}, nan, {1, 0, 0}}, {}, {});
  EXPECT_EQ(loadError("a.glb", bad.glb()),
            place + ": the place of instance 1 is not finite; --repair leaves it out");
  const Scene repaired = loadText("a.glb", bad.glb(), {.repair = true});
  EXPECT_EQ(repaired.triangles.size(), 2u);
  EXPECT_EQ(repaired.objects[1].name, "node_0#2");
  EXPECT_EQ(repaired.warnings, std::vector<std::string>{"instances whose place is not finite, left out: 1"});

  const Scene flat = loadText("a.glb", instanced({{0, 0, 0}, {1, 0, 0}}, {}, {{1, 1, 1}, {0, 0, 0}}).glb());
  EXPECT_EQ(flat.triangles.size(), 2u);
  EXPECT_EQ(flat.degenerate_triangles, 1u);
  EXPECT_EQ(flat.warnings,
            std::vector<std::string>{"instances without volume, which cannot be seen (a scale of 0): 1"});
  EXPECT_EQ(loadText("a.glb", instanced({{0, 0, 0}}, {{0, 0, 0, 0}}, {}).glb()).warnings,
            std::vector<std::string>{"instances whose rotation is a quaternion of zeros, not turned: 1"});

  GltfFile file = instanced({{0, 0, 0}, {1, 0, 0}}, {}, {{1, 1, 1}});
  EXPECT_EQ(loadError("a.glb", file.glb()),
            place + ".attributes.TRANSLATION: 2 elements, another attribute has 1");
  json& attributes = file.document["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
  attributes = json::object();
  EXPECT_EQ(loadError("a.glb", file.glb()), place + ".attributes: expected TRANSLATION, ROTATION or SCALE");
  attributes = {{"ROTATION", 1}};
  EXPECT_EQ(loadError("a.glb", file.glb()),
            place + ".attributes.ROTATION: accessors[1] needs a bufferView and type VEC4");
  file.document["accessors"].push_back({{"componentType", 5126}, {"count", 1'000'000'000}, {"type", "VEC3"}});
  attributes = {{"TRANSLATION", file.document["accessors"].size() - 1}};
  EXPECT_NE(loadError("a.glb", file.glb()).find("needs a bufferView"), std::string::npos);
}

TEST(GpuInstancing, AMillionInstancesOfNothing) {
  GltfFile file = instanced(std::vector<glm::vec3>(1'000'000, glm::vec3(0)), {}, {});
  file.document["meshes"][0]["primitives"][0]["mode"] = 0;
  EXPECT_EQ(loadError("a.glb", file.glb()), "a.glb: holds no triangles");
  // And of something, by many nodes that name the same places.
  GltfFile many = instanced(std::vector<glm::vec3>(10'000, glm::vec3(0)), {}, {});
  const json node = many.document["nodes"][0];
  for (int i = 1; i < 10'000; ++i) many.document["nodes"].push_back(node);
  EXPECT_EQ(loadError("a.glb", many.glb()).find("a.glb: places its meshes so often"), 0u);
}

TEST(MsftLod, OnlyTheFinestLevelIsRead) {
  GltfFile file = squareFile<uint8_t>(5121);
  const auto levels = [](const json& ids) { return json{{"MSFT_lod", {{"ids", ids}}}}; };
  file.document["nodes"] = {{{"mesh", 0}, {"name", "fine"}, {"extensions", levels({1, 2})}},
                            {{"mesh", 0}, {"name", "coarse"}, {"children", {3}}},
                            {{"mesh", 0}, {"name", "coarsest"}},
                            {{"mesh", 0}, {"name", "part of coarse"}},
                            {{"mesh", 0}, {"name", "other"}}};
  file.document["scenes"] = {{{"nodes", {0, 1, 4}}}};
  const Scene scene = loadText("a.glb", file.glb());
  ASSERT_EQ(scene.objects.size(), 2u);
  EXPECT_EQ(scene.objects[0].name, "fine");
  EXPECT_EQ(scene.objects[1].name, "other");
  EXPECT_EQ(scene.warnings, std::vector<std::string>{"coarser levels of detail (MSFT_lod), left out: 2"});
  file.document["nodes"][0]["extensions"] = levels({9});
  EXPECT_EQ(loadError("a.glb", file.glb()),
            "a.glb: nodes[0].extensions.MSFT_lod.ids[0]: expected an index below 5");
}

}  // namespace
}  // namespace sightline
