#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <random>

#include "core/formats/load_scene.h"
#include "core/scene/scene.h"
#include "tests/scene/files.h"
#include "tests/scene/gltf_files.h"

namespace sightline {
namespace {

using test::bytesOf;
using test::expectValid;
using test::Folder;
using test::GltfFile;
using test::json;
using test::loadError;
using test::loadText;
using test::squareFile;

using Positions = std::vector<glm::vec3>;
using Triangles = std::vector<glm::uvec3>;

const Positions kSquare = test::squareCorners();
const Triangles kTwo = {{0, 1, 2}, {0, 2, 3}};

TEST(LoadGltf, IndicesOfEveryWidthAndNone) {
  for (const GltfFile& file :
       {squareFile<uint8_t>(5121), squareFile<uint16_t>(5123), squareFile<uint32_t>(5125)}) {
    for (const Scene& scene : {loadText("a.glb", file.glb()), loadText("a.gltf", file.gltf())}) {
      expectValid(scene);
      EXPECT_EQ(scene.positions, kSquare);
      EXPECT_EQ(scene.triangles, kTwo);
    }
  }
  GltfFile file;
  file.addMesh(file.addPositions({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}}), -1);
  EXPECT_EQ(loadText("a.glb", file.glb()).triangles, (Triangles{{0, 1, 2}, {3, 4, 5}}));
}

TEST(LoadGltf, StripsFansAndNothingElse) {
  GltfFile file;
  const size_t positions = file.addPositions({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 2, 0}});
  for (const int mode : {0, 1, 5, 6, 3}) file.addMesh(positions, -1, mode);
  const Scene scene = loadText("a.glb", file.glb());
  expectValid(scene);
  // The five vertices occur once: all meshes name the same accessor in the same place.
  EXPECT_EQ(scene.positions.size(), 5u);
  EXPECT_EQ(scene.triangles, (Triangles{{0, 1, 2}, {1, 3, 2}, {2, 3, 4}, {1, 2, 0}, {2, 3, 0}, {3, 4, 0}}));
  ASSERT_EQ(scene.objects.size(), 2u);
  EXPECT_EQ(scene.objects[0].name, "node_2");
  EXPECT_EQ(scene.objects[1].name, "node_3");
}

TEST(LoadGltf, NestedTransforms) {
  GltfFile file = squareFile<uint8_t>(5121);
  const glm::dvec3 axis = glm::normalize(glm::dvec3(1, 2, 3));
  const glm::dquat q = glm::angleAxis(0.7, axis);
  glm::dmat4 matrix = glm::translate(glm::dmat4(1), glm::dvec3(4, 5, 6));
  matrix = glm::scale(matrix, glm::dvec3(1, -2, 3));
  std::vector<double> columns(&matrix[0][0], &matrix[0][0] + 16);
  file.document["nodes"] = {{{"children", {2, 1}},
                             {"translation", {1, 2, 3}},
                             {"rotation", {q.x, q.y, q.z, q.w}},
                             {"scale", {2, 3, 4}}},
                            {{"mesh", 0}},
                            {{"mesh", 0}, {"matrix", columns}, {"name", "inner"}}};
  const Scene scene = loadText("a.glb", file.glb());
  expectValid(scene);
  const glm::dmat4 outer =
      glm::scale(glm::translate(glm::dmat4(1), {1, 2, 3}) * glm::mat4_cast(q), {2, 3, 4});
  const glm::dmat4 inner = outer * matrix;
  ASSERT_EQ(scene.positions.size(), 8u);
  for (size_t i = 0; i < 4; ++i) {
    const glm::dvec4 corner(kSquare[i], 1.0);
    EXPECT_LT(glm::length(glm::dvec3(inner * corner) - glm::dvec3(scene.positions[i])), 1e-5) << i;
    EXPECT_LT(glm::length(glm::dvec3(outer * corner) - glm::dvec3(scene.positions[4 + i])), 1e-5) << i;
  }
  ASSERT_EQ(scene.objects.size(), 2u);
  EXPECT_EQ(scene.objects[0].name, "inner");
  EXPECT_EQ(scene.objects[1].name, "node_1");
}

TEST(LoadGltf, DefaultSceneOnly) {
  GltfFile file = squareFile<uint8_t>(5121);
  file.document["nodes"] = {{{"mesh", 0}, {"name", "a"}}, {{"mesh", 0}, {"name", "b"}}};
  file.document["scenes"] = {{{"nodes", {0}}}, {{"nodes", {1}}}};
  EXPECT_EQ(loadText("a.glb", file.glb()).objects[0].name, "a");
  file.document["scene"] = 1;
  EXPECT_EQ(loadText("a.glb", file.glb()).objects[0].name, "b");
  file.document["scenes"][1].erase("nodes");
  EXPECT_EQ(loadError("a.glb", file.glb()), "a.glb: holds no triangles");
}

TEST(LoadGltf, NamesOfNodesMeshesAndPrimitives) {
  GltfFile file = squareFile<uint8_t>(5121);
  json& mesh = file.document["meshes"][0];
  mesh["name"] = "wall";
  mesh["primitives"].push_back(mesh["primitives"][0]);
  file.document["nodes"] = {
      {{"mesh", 0}, {"name", "house\n"}}, {{"mesh", 0}, {"name", "wall"}}, {{"mesh", 0}}};
  const Scene scene = loadText("a.glb", file.glb());
  expectValid(scene);
  EXPECT_EQ(scene.positions.size(), 4u);
  const char* names[] = {"house_/wall/0", "house_/wall/1", "wall/0",
                         "wall/1",        "node_2/wall/0", "node_2/wall/1"};
  ASSERT_EQ(scene.objects.size(), 6u);
  for (size_t i = 0; i < 6; ++i) EXPECT_EQ(scene.objects[i].name, names[i]);
}

TEST(LoadGltf, QuantizedPositions) {
  const std::tuple<int, std::string, bool, Positions> cases[] = {
      {5120,
       bytesOf(std::vector<int8_t>{-128, -127, 127, 99, 0, 1, 2, 99, 9, 9, 9}),
       false,
       {{-128, -127, 127}, {0, 1, 2}, {9, 9, 9}}},
      {5120,
       bytesOf(std::vector<int8_t>{-128, -127, 127, 99, 0, 1, 2, 99, 9, 9, 9}),
       true,
       {{-1, -1, 1}, {0, float(1 / 127.0), float(2 / 127.0)}, glm::vec3(float(9 / 127.0))}},
      {5121,
       bytesOf(std::vector<uint8_t>{255, 0, 1, 99, 0, 1, 2, 99, 9, 9, 9}),
       true,
       {{1, 0, float(1 / 255.0)}, {0, float(1 / 255.0), float(2 / 255.0)}, glm::vec3(float(9 / 255.0))}},
      {5122,
       bytesOf(std::vector<int16_t>{-32768, 32767, 1, 99, 0, 1, 2, 99, 9, 9, 9}),
       false,
       {{-32768, 32767, 1}, {0, 1, 2}, {9, 9, 9}}},
      {5122,
       bytesOf(std::vector<int16_t>{-32768, 32767, 1, 99, 0, 1, 2, 99, 9, 9, 9}),
       true,
       {{-1, 1, float(1 / 32767.0)},
        {0, float(1 / 32767.0), float(2 / 32767.0)},
        glm::vec3(float(9 / 32767.0))}},
      {5123,
       bytesOf(std::vector<uint16_t>{65535, 0, 1, 99, 0, 1, 2, 99, 9, 9, 9}),
       true,
       {{1, 0, float(1 / 65535.0)},
        {0, float(1 / 65535.0), float(2 / 65535.0)},
        glm::vec3(float(9 / 65535.0))}},
  };
  for (const auto& [component, bytes, normalized, expected] : cases) {
    GltfFile file;
    const size_t accessor =
        file.addAccessor(file.addView(bytes, component < 5122 ? 4 : 8), component, 3, "VEC3");
    file.document["accessors"][accessor]["normalized"] = normalized;
    file.document["extensionsRequired"] = {"KHR_mesh_quantization"};
    file.addMesh(accessor, -1);
    EXPECT_EQ(loadText("a.glb", file.glb()).positions, expected) << component << normalized;
  }
}

TEST(LoadGltf, SparseAccessors) {
  const Scene scene = loadText("a.glb", test::richFile().glb());
  expectValid(scene);
  ASSERT_EQ(scene.positions.size(), 8u);
  const float half = float(16384 / 32767.0);
  // The first node turns by 180 degrees about z and moves by (1, 2, 3).
  EXPECT_EQ(scene.positions[0], glm::vec3(1, 2, 3));
  EXPECT_FLOAT_EQ(scene.positions[1].x, 1 - half);
  EXPECT_EQ(scene.positions[2], glm::vec3(0, 1, 3));
  EXPECT_FLOAT_EQ(scene.positions[3].y, 2 - half);
  EXPECT_EQ(scene.triangles, (Triangles{{0, 1, 3}, {1, 2, 3}, {5, 6, 4}, {6, 7, 4}}));
  EXPECT_EQ(scene.alpha_triangles, 2u);
  EXPECT_EQ(scene.single_sided_triangles, 2u);
}

TEST(LoadGltf, MeshoptCompression) {
  for (const bool sequence : {false, true}) {
    const Scene scene = loadText("a.glb", test::compressedSquare(sequence).glb());
    expectValid(scene);
    EXPECT_EQ(scene.positions, kSquare);
    ASSERT_EQ(scene.triangles.size(), 2u);
    for (size_t i = 0; i < 2; ++i) {  // the codec may turn a triangle's corners
      const glm::uvec3 t = scene.triangles[i];
      EXPECT_TRUE(t == kTwo[i] || glm::uvec3(t.y, t.z, t.x) == kTwo[i] ||
                  glm::uvec3(t.z, t.x, t.y) == kTwo[i]);
    }
  }
}

TEST(LoadGltf, MeshoptExponentialFilter) {
  std::vector<uint32_t> filtered(12);
  const Positions corners = kSquare;
  meshopt_encodeFilterExp(filtered.data(), 4, 12, 16, &corners[0].x);
  std::string packed(1000, '\0');
  packed.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(packed.data()), packed.size(),
                                           filtered.data(), 4, 12));
  GltfFile file;
  file.addMesh(
      file.addAccessor(file.addCompressed(packed, "ATTRIBUTES", 12, 4, "EXPONENTIAL"), 5126, 4, "VEC3"), -1,
      6);
  const Scene scene = loadText("a.glb", file.glb());
  EXPECT_EQ(scene.positions, kSquare);
}

TEST(LoadGltf, BuffersBesideTheFile) {
  const Folder folder;
  const GltfFile file = squareFile<uint16_t>(5123);
  folder.write("b \xc3\xa4.bin", file.bin + "more");
  const auto path = folder.write("a.gltf", file.gltf("b%20%c3%A4.bin"));
  EXPECT_EQ(loadScene(path).triangles, kTwo);
}

TEST(LoadGltf, TexturesAndOtherThingsAreNotNeeded) {
  GltfFile file = squareFile<uint16_t>(5123);
  file.document["images"] = {{{"uri", "missing.png"}}, {{"bufferView", 99}}, 7};
  file.document["textures"] = "nonsense";
  file.document["animations"] = {1};
  file.document["extensionsRequired"] = {"KHR_materials_unlit", "KHR_texture_basisu", "EXT_texture_webp"};
  EXPECT_EQ(loadText("a.glb", file.glb()).triangles, kTwo);
}

TEST(LoadGltf, BuffersOutsideTheFolderAreRefused) {
  const Folder folder;
  const GltfFile file = squareFile<uint16_t>(5123);
  const std::string outside = folder.write("b.bin", file.bin).string();
  std::filesystem::create_directories(folder / "scene/sub");
  folder.write("scene/b.bin", file.bin);
  folder.write("scene/..b.bin", file.bin);
  const auto load = [&](const std::string& uri) {
    return loadScene(folder.write("scene/a.gltf", file.gltf(uri)));
  };
  std::string encoded;
  for (const char c : outside) encoded += c == '/' ? "%2f" : std::string(1, c);
  for (const std::string& uri :
       {std::string("../b.bin"), std::string("%2E%2e/b.bin"), std::string("..%2fb.bin"),
        std::string("sub/../../b.bin"), std::string("./../scene/b.bin"), outside, encoded}) {
    EXPECT_EQ(test::errorOf([&] { load(uri); }),
              "scene/a.gltf: buffers[0].uri: lies outside of the scene's folder, where nothing is read; put "
              "it beside "
              "the scene, or load it with --allow-external")
        << uri;
  }
  for (const char* uri : {"b.bin", "./b.bin", "sub/../b.bin", "..b.bin"})
    EXPECT_EQ(load(uri).triangles, kTwo) << uri;
}

TEST(LoadGltf, MirroredNodesKeepTheirFront) {
  // Triangles of every kind of primitive under places of every kind; a front stays one if its normal in the
  // file, carried along by the inverse transposed matrix, is on the side of its normal in the scene.
  std::mt19937_64 random(7);
  const auto number = [&] { return double(random() >> 11) * 0x1p-53 - 0.5; };
  for (int round = 0; round < 40; ++round) {
    SCOPED_TRACE(round);
    GltfFile file;
    Positions corners;
    for (int i = 0; i < 6; ++i) corners.emplace_back(number(), number(), number());
    const size_t positions = file.addPositions(corners);
    for (const int mode : {4, 5, 6}) file.addMesh(positions, -1, mode);
    glm::dmat4 outer(1.0), inner(1.0);
    for (int i = 0; i < 12; ++i) {
      outer[i / 3][i % 3] = number();
      inner[i / 3][i % 3] = number();
    }
    file.document["nodes"] = {
        {{"matrix", std::vector<double>(&outer[0][0], &outer[0][0] + 16)}, {"children", {1, 3}}, {"mesh", 0}},
        {{"matrix", std::vector<double>(&inner[0][0], &inner[0][0] + 16)}, {"children", {2}}, {"mesh", 1}},
        {{"mesh", 2}},
        {{"mesh", 0}}};
    const Scene scene = loadText("a.glb", file.glb());
    const Triangles list = {{0, 1, 2}, {3, 4, 5}}, strip = {{0, 1, 2}, {1, 3, 2}, {2, 3, 4}, {3, 5, 4}},
                    fan = {{1, 2, 0}, {2, 3, 0}, {3, 4, 0}, {4, 5, 0}};
    size_t id = 0;
    for (const auto& [triangles, place] : {std::pair(list, outer), std::pair(strip, outer * inner),
                                           std::pair(fan, outer * inner), std::pair(list, outer)}) {
      for (const glm::uvec3& t : triangles) {
        ASSERT_LT(id, scene.triangles.size());
        const glm::uvec3 got = scene.triangles[id++];
        const auto normal = [](const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
          return glm::cross(b - a, c - a);
        };
        const glm::dvec3 expected = glm::inverse(glm::transpose(glm::dmat3(place))) *
                                    normal(corners[t.x], corners[t.y], corners[t.z]);
        EXPECT_GT(glm::dot(normal(scene.positions[got.x], scene.positions[got.y], scene.positions[got.z]),
                           expected),
                  0)
            << "triangle " << id - 1;
      }
    }
    EXPECT_EQ(id, scene.triangles.size());
  }
}

TEST(LoadGltf, InvisibleNodesAreLeftOutWithTheirChildren) {
  GltfFile file = squareFile<uint8_t>(5121);
  const auto visible = [](bool value) { return json{{"KHR_node_visibility", {{"visible", value}}}}; };
  file.document["nodes"] = {
      {{"mesh", 0}, {"name", "seen"}, {"extensions", visible(true)}, {"children", {1, 4}}},
      {{"mesh", 0}, {"extensions", visible(false)}, {"children", {2}}},
      {{"children", {3}}, {"extensions", visible(true)}},
      {{"mesh", 0}},
      {{"mesh", 0}, {"name", "last"}}};
  file.document["extensionsRequired"] = {"KHR_node_visibility"};
  const Scene scene = loadText("a.glb", file.glb());
  expectValid(scene);
  ASSERT_EQ(scene.objects.size(), 2u);
  EXPECT_EQ(scene.objects[0].name, "seen");
  EXPECT_EQ(scene.objects[1].name, "last");
  EXPECT_EQ(scene.hidden_nodes, 3u);
  EXPECT_EQ(
      scene.warnings,
      (std::vector<std::string>{"invisible nodes (KHR_node_visibility), left out with all below them: 3"}));
  file.document["nodes"][0]["extensions"] = visible(false);
  EXPECT_EQ(
      loadError("a.glb", file.glb()),
      "a.glb: holds no triangles; invisible nodes (KHR_node_visibility), left out with all below them: 5");
  file.document["nodes"][0]["extensions"]["KHR_node_visibility"]["visible"] = 0;
  EXPECT_EQ(loadError("a.glb", file.glb()),
            "a.glb: nodes[0].extensions.KHR_node_visibility.visible: expected true or false");
}

TEST(LoadGltf, CountsGlass) {
  GltfFile file = squareFile<uint8_t>(5121);
  const auto load = [&](const json& transmission, const char* mode) {
    file.document["materials"] = {
        {{"alphaMode", mode}, {"extensions", {{"KHR_materials_transmission", transmission}}}}};
    file.document["meshes"][0]["primitives"][0]["material"] = 0;
    return loadText("a.glb", file.glb());
  };
  EXPECT_EQ(load({{"transmissionFactor", 0.01}}, "OPAQUE").glass_triangles, 2u);
  EXPECT_EQ(
      load({{"transmissionFactor", 1}, {"transmissionTexture", {{"index", 0}}}}, "OPAQUE").glass_triangles,
      2u);
  EXPECT_EQ(load({{"transmissionFactor", 0.0}}, "OPAQUE").glass_triangles, 0u);
  EXPECT_EQ(load(json::object(), "OPAQUE").glass_triangles, 0u);
  const Scene blended = load({{"transmissionFactor", 1.0}}, "BLEND");
  EXPECT_EQ(blended.glass_triangles, 0u);  // counted once, as alpha
  EXPECT_EQ(blended.alpha_triangles, 2u);
  file.document["materials"][0]["extensions"]["KHR_materials_transmission"]["transmissionFactor"] = "much";
  EXPECT_EQ(
      loadError("a.glb", file.glb()),
      "a.glb: materials[0].extensions.KHR_materials_transmission.transmissionFactor: expected a number");
}

/// Sparse values over zeros that stand nowhere.
TEST(LoadGltf, ReadsAccessorsThatAreSparseAlone) {
  GltfFile file = squareFile<uint8_t>(5121);
  const Scene plain = loadText("a.glb", file.glb());
  const std::vector<uint8_t> which = {1, 2, 3}, corners = {1, 2, 4, 5}, values = {1, 2, 2, 3};
  const auto sparse = [](size_t count, size_t indices, size_t its_values) {
    return json{{"count", count},
                {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
                {"values", {{"bufferView", its_values}}}};
  };
  const std::vector<glm::vec3> places(plain.positions.begin() + 1, plain.positions.end());
  json& accessors = file.document["accessors"];
  accessors[0].erase("bufferView");
  accessors[0]["sparse"] = sparse(3, file.addView(bytesOf(which)), file.addView(bytesOf(places)));
  accessors[1].erase("bufferView");
  accessors[1]["sparse"] = sparse(4, file.addView(bytesOf(corners)), file.addView(bytesOf(values)));
  ASSERT_EQ(plain.positions[0], glm::vec3(0));
  const Scene scene = loadText("a.glb", file.glb());
  EXPECT_EQ(scene.positions, plain.positions);
  EXPECT_EQ(scene.triangles, plain.triangles);
}

TEST(LoadGltf, ErrorsNameThePlace) {
  using Change = std::function<void(json&)>;
  const std::pair<Change, std::string> cases[] = {
      {[](json& d) { d.erase("asset"); }, "key \"asset\" is missing"},
      {[](json& d) { d["asset"]["version"] = "1.0"; },
       "asset.version: \"1.0\" is not supported, only glTF 2; convert the file"},
      {[](json& d) { d["asset"]["version"] = 1.1; },
       "asset.version: \"1.1\" is not supported, only glTF 2; convert the file"},
      {[](json& d) { d["extensionsRequired"] = {"EXT_other"}; },
       "extensionsRequired: \"EXT_other\" is unknown; convert the file without it, or load it without what "
       "it "
       "adds (--ignore-extension)"},
      {[](json& d) {
         d["extensionsRequired"] = {"KHR_draco_mesh_compression"};
         d["accessors"][0].erase("bufferView");
       },
       "accessors[0]: positions without a bufferView"},
      {[](json& d) { d["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 7; },
       "meshes[0].primitives[0].attributes.POSITION: 7 is out of range, there are 2 in the file"},
      {[](json& d) { d["meshes"][0]["primitives"][0]["indices"] = -1; },
       "meshes[0].primitives[0].indices: expected a whole number of at least 0"},
      {[](json& d) { d["meshes"][0]["primitives"][0]["mode"] = 9; },
       "meshes[0].primitives[0].mode: expected 0 to 6"},
      {[](json& d) { d["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] = 1; },
       "meshes[0].primitives[0].extensions.KHR_draco_mesh_compression: expected an object"},
      {[](json& d) { d["meshes"][0]["primitives"] = 3; }, "meshes[0].primitives: expected a list"},
      {[](json& d) { d["accessors"][0]["count"] = 5; },
       "accessors[0]: 5 elements from byte 0 on lie outside of the buffer view with its 48 bytes"},
      {[](json& d) { d["accessors"][0]["count"] = 4611686018427387904ull; },
       "more than 4294967293 vertices or triangles"},
      {[](json& d) { d["accessors"][1]["count"] = 5; },
       "meshes[0].primitives[0]: 5 corners are no multiple of 3; --repair drops the last"},
      {[](json& d) { d["accessors"][0]["byteOffset"] = 4; },
       "accessors[0]: 4 elements from byte 4 on lie outside of the buffer view with its 48 bytes"},
      {[](json& d) { d["accessors"][0]["byteOffset"] = 18446744073709551615ull; },
       "accessors[0]: 4 elements from byte 18446744073709551615 on lie outside of the buffer view with its "
       "48 bytes"},
      {[](json& d) { d["accessors"][0]["type"] = "VEC2"; }, "accessors[0].type: positions need VEC3"},
      {[](json& d) { d["accessors"][0]["type"] = "VEC5"; },
       "accessors[0].type: expected SCALAR, VEC2, VEC3, VEC4, MAT2, MAT3 or MAT4"},
      {[](json& d) { d["accessors"][0]["componentType"] = 5124; },
       "accessors[0].componentType: 5124 is none of 5120, 5121, 5122, 5123, 5125, 5126"},
      {[](json& d) { d["accessors"][0].erase("bufferView"); },
       "accessors[0]: positions without a bufferView"},
      {[](json& d) { d["accessors"][1].erase("bufferView"); }, "accessors[1]: indices without a bufferView"},
      {[](json& d) { d["accessors"][1]["componentType"] = 5122; },
       "accessors[1]: indices need SCALAR of 5121, 5123 or 5125"},
      {[](json& d) { d["accessors"][0]["count"] = 3; },
       "meshes[0].primitives[0], indices in accessors[1], triangle 1: vertex index 3 is out of range 0..2; "
       "--repair "
       "drops the face"},
      {[](json& d) { d["bufferViews"][0]["byteLength"] = 61; },
       "bufferViews[0]: bytes 0 to 0 + 61 lie outside of buffers[0] with its 60 bytes"},
      {[](json& d) { d["bufferViews"][0]["byteStride"] = 8; },
       "accessors[0]: elements of 12 bytes do not fit byteStride 8"},
      {[](json& d) { d["bufferViews"][0]["buffer"] = 1; }, "buffers[1].uri: is missing"},
      {[](json& d) { d["bufferViews"][0]["buffer"] = 2; },
       "bufferViews[0].buffer: 2 is out of range, there are 2 in the file"},
      {[](json& d) {
         d["buffers"][0]["byteLength"] = 64;
         d["bufferViews"][1]["byteLength"] = 16;
       },
       "bufferViews[1]: bytes 48 to 48 + 16 are missing: buffers[0] has 60 bytes, its byteLength says 64; is "
       "the "
       "file truncated?"},
      {[](json& d) { d["buffers"][0]["uri"] = "data:;base64,AAA="; },
       "bufferViews[0]: bytes 0 to 0 + 48 are missing: buffers[0] has 2 bytes, its byteLength says 60; is "
       "the file "
       "truncated?"},
      {[](json& d) { d["buffers"][0]["uri"] = "data:;base64,AA*A"; }, "buffers[0].uri: bad base64"},
      {[](json& d) { d["buffers"][0]["uri"] = "data:,hello"; },
       "buffers[0].uri: expected data:...;base64,..."},
      {[](json& d) { d["buffers"][0]["uri"] = "http://a/b.bin"; },
       "buffers[0].uri: only data: and files beside the scene are supported"},
      {[](json& d) { d["nodes"][0]["children"] = {0}; }, "nodes[0]: occurs twice in the scene's tree"},
      {[](json& d) { d["nodes"][0]["children"] = {5}; }, "nodes[0].children[0]: expected an index below 1"},
      {[](json& d) {
         d["nodes"][0]["rotation"] = {0, 0, 1};
       },
       "nodes[0].rotation: expected 4 numbers"},
      {[](json& d) {
         d["nodes"][0]["scale"] = {0, 1e300, 1};
       },
       "accessors[0], element 2: vertex (0, inf, 0) is not finite; --repair drops its triangles"},
      {[](json& d) { d["scene"] = 3; }, "scene: 3 is out of range, there are 1 in the file"},
  };
  const GltfFile file = squareFile<uint16_t>(5123);
  for (const auto& [change, message] : cases) {
    GltfFile bad = file;
    const json buffers = {{{"byteLength", bad.bin.size()}}, {{"byteLength", 4}}};
    bad.document["buffers"] = buffers;
    bad.document["scenes"] = json::array();
    bad.document["scenes"] = {{{"nodes", {0}}}};
    change(bad.document);
    EXPECT_EQ(loadError("a.glb", bad.glb()), "a.glb: " + message) << bad.document.dump();
  }
}

TEST(LoadGltf, NonFiniteVerticesAndRepair) {
  GltfFile file;
  const size_t positions = file.addPositions({{0, 0, 0}, {1, 0, 0}, {NAN, 1, 0}, {0, 1, 0}});
  const std::vector<uint16_t> indices = {0, 1, 2, 0, 1, 3, 0, 1, 77, 0};
  file.addMesh(positions, int64_t(file.addAccessor(file.addView(bytesOf(indices)), 5123, 10, "SCALAR")));
  file.document["accessors"].back()["count"] = 9;
  EXPECT_EQ(loadError("a.glb", file.glb()),
            "a.glb: accessors[0], element 2: vertex (nan, 1, 0) is not finite; --repair drops its triangles");
  file.document["accessors"].back()["count"] = 10;
  SceneLoadOptions repair;
  repair.repair = true;
  const Scene scene = loadText("a.glb", file.glb(), repair);
  expectValid(scene);
  EXPECT_EQ(scene.triangles, (Triangles{{0, 1, 3}}));
  EXPECT_EQ(scene.repaired_triangles, 3u);
}

TEST(LoadGltf, ContainerErrors) {
  const std::string good = squareFile<uint16_t>(5123).glb();
  const auto with = [&](size_t offset, uint32_t value) {
    std::string bytes = good;
    std::memcpy(bytes.data() + offset, &value, 4);
    return loadError("a.glb", bytes);
  };
  const auto size = uint32_t(good.size());
  EXPECT_EQ(loadError("a.glb", "glTF"),
            "a.glb: is no GLB file: it does not start with \"glTF\" and a header");
  EXPECT_EQ(with(0, 7), "a.glb: is no GLB file: it does not start with \"glTF\" and a header");
  EXPECT_EQ(with(4, 1), "a.glb: GLB version 1, only 2 is supported; convert the file");
  EXPECT_EQ(with(8, size + 1), "a.glb: the header says " + std::to_string(size + 1) +
                                   " bytes, the file has " + std::to_string(size) + "; is it truncated?");
  EXPECT_EQ(with(16, 1), "a.glb: the first chunk is not JSON");
  EXPECT_NE(with(12, 0xfffffff0).find("is cut off after"), std::string::npos);
  EXPECT_EQ(loadError("a.glb", good.substr(0, good.size() - 1)).find("a.glb: the header says"), 0u);
  EXPECT_EQ(loadError("a.gltf", "{\"asset\":\n tru}").substr(0, 11), "a.gltf:2:5:");
  EXPECT_EQ(loadError("a.gltf", "[]"), "a.gltf: expected an object");
  EXPECT_NE(loadError("a.gltf", "{\"extras\":" + std::string(100'000, '[')).find("nested deeper"),
            std::string::npos);
}

TEST(LoadGltf, HugeClaimsTakeNoMemory) {
  // Compressed data that claims to unpack to 64 TiB, and a mesh of 1M vertices placed a million times.
  GltfFile file = test::compressedSquare(false);
  file.document["bufferViews"][0]["byteLength"] = 1ull << 46;
  file.document["bufferViews"][0]["extensions"]["EXT_meshopt_compression"]["count"] = (1ull << 46) / 12;
  EXPECT_NE(loadError("a.glb", file.glb()).find("does not fit the data"), std::string::npos);

  GltfFile indices = squareFile<uint16_t>(5123);
  indices.document["accessors"][1]["count"] = 3'000'000'000u;
  EXPECT_EQ(loadError("a.glb", indices.glb()),
            "a.glb: accessors[1]: 3000000000 elements from byte 0 on lie outside of the buffer view with its "
            "12 bytes");

  GltfFile many;
  const size_t view = many.addView(std::string(3'000'000, '\0'), 12);
  many.addMesh(many.addAccessor(view, 5120, 250'000, "VEC3"), -1, 5);
  json nodes = json::array();
  for (int i = 0; i < 100'000; ++i) nodes.push_back({{"mesh", 0}, {"translation", {i, 0, 0}}});
  many.document["nodes"] = nodes;
  EXPECT_EQ(loadError("a.glb", many.glb()), "a.glb: more than 4294967293 vertices or triangles");
}

TEST(LoadGltf, SmallFilesMakeNoLargeScenes) {
  // `nodes` place a mesh of `primitives` primitives that hold the same 3,000 triangles.
  const auto file = [](int nodes, int primitives, const std::string& name) {
    GltfFile many;
    const size_t positions = many.addPositions({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    const std::string triangles(9'000, '\1');
    many.addMesh(positions, int64_t(many.addAccessor(many.addView(triangles), 5121, 9'000, "SCALAR")));
    many.document["meshes"][0]["name"] = name;
    json& list = many.document["meshes"][0]["primitives"];
    for (int i = 1; i < primitives; ++i) list.push_back(json(list[0]));
    many.document["nodes"] = json(size_t(nodes), json{{"mesh", 0}});
    return many.glb();
  };
  const auto isTooMuch = [](const std::string& glb) {
    return loadError("a.glb", glb).find("a.glb: places its meshes so often that it makes too much of ") == 0;
  };
  EXPECT_EQ(loadText("a.glb", file(1000, 1, "m")).triangleCount(), 3'000'000u);
  EXPECT_TRUE(isTooMuch(file(1000, 10, "m")));                       // 30 million triangles of 20 KB
  EXPECT_TRUE(isTooMuch(file(600, 300, "m")));                       // too many objects
  EXPECT_TRUE(isTooMuch(file(200, 100, std::string(20'000, 'm'))));  // 400 MB of names
}

TEST(LoadGltf, ManyTargetsOfManyVerticesAreTooMuch) {
  GltfFile file;
  const size_t positions = file.addAccessor(file.addView(std::string(120'000, '\0')), 5120, 40'000, "VEC3");
  file.addMesh(positions, -1);
  json& mesh = file.document["meshes"][0];
  for (int i = 0; i < 3000; ++i) {
    mesh["primitives"][0]["targets"].push_back({{"POSITION", positions}});
    mesh["weights"].push_back(1);
  }
  EXPECT_EQ(loadError("a.glb", file.glb()).find("a.glb: places its meshes so often"), 0u);
}

TEST(LoadGltf, TheVersionIsQuotedInOneLine) {
  EXPECT_EQ(loadError("a.gltf", R"({"asset":{"version":"3\n\u001b[2J"}})"),
            "a.gltf: asset.version: \"3__[2J\" is not supported, only glTF 2; convert the file");
}

TEST(LoadGltf, NamesOfFilesHaveNoControlCharacters) {
  for (const char* uri : {"a%00.bin", "a%0A.bin", "a%1B[2J.bin"}) {
    EXPECT_EQ(loadError("a.gltf", squareFile<uint8_t>(5121).gltf(uri)),
              "a.gltf: buffers[0].uri: bad file name")
        << uri;
  }
}

}  // namespace
}  // namespace sightline
