// Morph targets and skins: where the default pose puts vertices, against brute force in double that follows
// the specification's formulas and none of the loader's code.
#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <random>

#include "core/scene/scene.h"
#include "tests/scene/files.h"
#include "tests/scene/gltf_files.h"

namespace sightline {
namespace {

using test::bytesOf;
using test::expectValid;
using test::GltfFile;
using test::json;
using test::loadError;
using test::loadText;

class Random {
 public:
  explicit Random(uint64_t seed) : random_(seed) {}
  double number(double low, double high) { return low + double(random_() >> 11) * 0x1p-53 * (high - low); }
  uint32_t below(uint32_t n) { return uint32_t(random_() % n); }
  glm::dvec3 vec(double size) { return {number(-size, size), number(-size, size), number(-size, size)}; }

 private:
  std::mt19937_64 random_;
};

/// A node's transform, and the same as JSON.
struct Place {
  glm::dmat4 matrix;
  json node;
};

Place randomPlace(Random& random) {
  const glm::dvec3 t = random.vec(10), s = random.vec(2);
  const glm::dquat q = glm::angleAxis(random.number(0, 6), glm::normalize(random.vec(1)));
  const glm::dmat4 matrix = glm::scale(glm::translate(glm::dmat4(1), t) * glm::mat4_cast(q), s);
  return {matrix,
          {{"translation", {t.x, t.y, t.z}}, {"rotation", {q.x, q.y, q.z, q.w}}, {"scale", {s.x, s.y, s.z}}}};
}

/// Adds an accessor of whole numbers, four an element, in components of that type.
size_t addWhole(GltfFile& file, int component, const std::vector<uint32_t>& values, bool normalized) {
  const std::string bytes = component == 5121 ? bytesOf(std::vector<uint8_t>(values.begin(), values.end()))
                                              : bytesOf(std::vector<uint16_t>(values.begin(), values.end()));
  const size_t accessor = file.addAccessor(file.addView(bytes), component, values.size() / 4, "VEC4");
  if (normalized) file.document["accessors"][accessor]["normalized"] = true;
  return accessor;
}

constexpr uint32_t kVertices = 12;
constexpr uint32_t kJoints = 5;

/// A mesh of kVertices corners with a skin of kJoints joints in a hierarchy, and where its vertices belong.
struct SkinnedMesh {
  GltfFile file;
  std::vector<glm::dvec3> expected;
};

SkinnedMesh skinnedMesh(uint64_t seed, int joint_component, int weight_component, uint32_t sets,
                        bool inverse_bind) {
  Random random(seed);
  SkinnedMesh result;
  GltfFile& file = result.file;
  std::vector<glm::vec3> corners;
  for (uint32_t i = 0; i < kVertices; ++i) corners.emplace_back(random.vec(1));
  file.addMesh(file.addPositions(corners), -1);

  // Node 0: the mesh, somewhere that must not matter. Node 1: what holds the first joints. Joints: nodes 2,
  // 3, ...; the last one stands outside of the scene.
  file.document["nodes"] = json::array({randomPlace(random).node});
  file.document["nodes"][0].update(json{{"mesh", 0}, {"skin", 0}});
  file.document["scenes"] = {{{"nodes", {1}}}};
  std::vector<glm::dmat4> world(kJoints + 2);
  std::vector<size_t> parents(kJoints + 2, 0);
  for (uint32_t node = 1; node < kJoints + 2; ++node) {
    const Place place = randomPlace(random);
    file.document["nodes"].push_back(place.node);
    const bool outside = node == 1 || node == kJoints + 1;
    const uint32_t parent = outside ? 0 : 1 + random.below(node - 1);
    world[node] = outside ? place.matrix : world[parent] * place.matrix;
    if (!outside) file.document["nodes"][parent]["children"].push_back(node);
  }
  file.document["nodes"][1]["children"].push_back(0);

  json skin = {{"joints", json::array()}};
  std::vector<glm::mat4> inverse(kJoints, glm::mat4(1.0f));
  for (uint32_t joint = 0; joint < kJoints; ++joint) {
    skin["joints"].push_back(joint + 2);
    if (inverse_bind) inverse[joint] = glm::mat4(randomPlace(random).matrix);
  }
  if (inverse_bind) {
    skin["inverseBindMatrices"] = file.addAccessor(file.addView(bytesOf(inverse)), 5126, kJoints, "MAT4");
  }
  file.document["skins"] = json::array({skin});

  std::vector<glm::dmat4> sum(kVertices, glm::dmat4(0.0));
  std::vector<double> total(kVertices, 0.0);
  for (uint32_t set = 0; set < sets; ++set) {
    std::vector<uint32_t> joints, weights;
    std::vector<float> real_weights;
    for (uint32_t i = 0; i < 4 * kVertices; ++i) {
      joints.push_back(random.below(kJoints));
      weights.push_back(random.below(3) == 0 ? 0 : random.below(weight_component == 5121 ? 256 : 65536));
      if (i % 4 == 0) weights.back() |= 1;  // never all 0
      real_weights.push_back(float(weights.back()) / 65535.0f);
      if (weights.back() == 0) joints.back() = 200;  // no joint, and none is asked for
      const double weight = weight_component == 5126   ? double(real_weights.back())
                            : weight_component == 5121 ? weights.back() / 255.0
                                                       : weights.back() / 65535.0;
      if (weight == 0.0) continue;
      sum[i / 4] += weight * (world[joints.back() + 2] * glm::dmat4(inverse[joints.back()]));
      total[i / 4] += weight;
    }
    json& attributes = file.document["meshes"][0]["primitives"][0]["attributes"];
    const std::string number = std::to_string(set);
    attributes["JOINTS_" + number] = addWhole(file, joint_component, joints, false);
    attributes["WEIGHTS_" + number] =
        weight_component == 5126
            ? file.addAccessor(file.addView(bytesOf(real_weights)), 5126, kVertices, "VEC4")
            : addWhole(file, weight_component, weights, true);
  }
  for (uint32_t i = 0; i < kVertices; ++i) {
    result.expected.emplace_back((sum[i] * glm::dvec4(corners[i], 1.0)) / total[i]);
  }
  return result;
}

TEST(GltfPose, SkinsMatchBruteForce) {
  uint64_t seed = 0;
  for (const int joints : {5121, 5123}) {
    for (const int weights : {5126, 5121, 5123}) {
      for (const uint32_t sets : {1u, 2u}) {
        for (const bool inverse_bind : {true, false}) {
          SCOPED_TRACE("seed " + std::to_string(++seed));
          const SkinnedMesh mesh = skinnedMesh(seed, joints, weights, sets, inverse_bind);
          const Scene scene = loadText("a.glb", mesh.file.glb());
          expectValid(scene);
          EXPECT_TRUE(scene.warnings.empty());
          ASSERT_EQ(scene.positions.size(), kVertices);
          for (uint32_t i = 0; i < kVertices; ++i) {
            const double size = 1.0 + glm::length(mesh.expected[i]);
            EXPECT_LT(glm::distance(glm::dvec3(scene.positions[i]), mesh.expected[i]), 1e-6 * size) << i;
          }
        }
      }
    }
  }
}

TEST(GltfPose, NodeOfASkinnedMeshDoesNotMoveIt) {
  SkinnedMesh mesh = skinnedMesh(1, 5121, 5126, 1, true);
  const Scene scene = loadText("a.glb", mesh.file.glb());
  mesh.file.document["nodes"][0]["translation"] = {100, 50, 7};
  mesh.file.document["nodes"][0]["scale"] = {-3, 1, 1};
  const Scene moved = loadText("a.glb", mesh.file.glb());
  EXPECT_EQ(moved.positions, scene.positions);
  EXPECT_EQ(moved.triangles, scene.triangles);
}

TEST(GltfPose, MirroringJointsKeepTheFront) {
  GltfFile file = test::squareFile<uint8_t>(5121);
  json& attributes = file.document["meshes"][0]["primitives"][0]["attributes"];
  attributes["JOINTS_0"] = addWhole(file, 5121, std::vector<uint32_t>(16, 0), false);
  std::vector<uint32_t> weights(16, 0);
  for (size_t i = 0; i < 16; i += 4) weights[i] = 255;
  attributes["WEIGHTS_0"] = addWhole(file, 5121, weights, true);
  file.document["skins"] = {{{"joints", {1}}}};
  file.document["nodes"] = {{{"mesh", 0}, {"skin", 0}}, {{"scale", {-1, 1, 1}}}};
  const Scene scene = loadText("a.glb", file.glb());
  EXPECT_EQ(scene.positions[1], glm::vec3(-1, 0, 0));
  EXPECT_EQ(scene.triangles, (std::vector<glm::uvec3>{{0, 2, 1}, {0, 3, 2}}));
}

TEST(GltfPose, MeshesInSeveralPosesShareNoVertices) {
  SkinnedMesh mesh = skinnedMesh(3, 5121, 5126, 1, true);
  mesh.file.document["skins"].push_back({{"joints", {3, 2, 4, 5, 6}}});
  mesh.file.document["nodes"].push_back({{"mesh", 0}, {"skin", 1}});
  mesh.file.document["nodes"].push_back({{"mesh", 0}, {"skin", 0}, {"translation", {1, 0, 0}}});
  mesh.file.document["nodes"].push_back({{"mesh", 0}});
  mesh.file.document["scenes"][0]["nodes"] = {1, 7, 8, 9};
  const Scene scene = loadText("a.glb", mesh.file.glb());
  expectValid(scene);
  // The first and the third stand in the same pose.
  EXPECT_EQ(scene.positions.size(), 3 * kVertices);
  ASSERT_EQ(scene.triangles.size(), 4 * kVertices / 3);
  EXPECT_EQ(scene.triangles[0], scene.triangles[2 * kVertices / 3]);
}

TEST(GltfPose, WeightsAndJointsThatAreMissing) {
  SkinnedMesh mesh = skinnedMesh(4, 5121, 5121, 1, false);
  GltfFile& file = mesh.file;
  json& attributes = file.document["meshes"][0]["primitives"][0]["attributes"];
  // Without either the mesh stands as the file has it, whatever its node says.
  const json bound = attributes;
  attributes.erase("JOINTS_0");
  attributes.erase("WEIGHTS_0");
  const Scene unbound = loadText("a.glb", file.glb());
  EXPECT_LE(glm::length(unbound.positions[0]), 2.0f);
  EXPECT_EQ(unbound.warnings,
            (std::vector<std::string>{
                "primitives of skinned nodes without JOINTS_0 and WEIGHTS_0, left as they are: 1"}));
  // With weights of 0 alone it follows the first joint.
  attributes = bound;
  attributes["JOINTS_0"] = addWhole(file, 5121, std::vector<uint32_t>(4 * kVertices, 2), false);
  std::vector<uint32_t> weights(4 * kVertices, 0);
  attributes["WEIGHTS_0"] = addWhole(file, 5121, weights, true);
  const Scene unweighted = loadText("a.glb", file.glb());
  EXPECT_EQ(unweighted.warnings,
            (std::vector<std::string>{
                "skinned vertices whose weights are all 0, placed by their first joint: 12"}));
  for (size_t i = 0; i < weights.size(); i += 4) weights[i] = 255;
  attributes["WEIGHTS_0"] = addWhole(file, 5121, weights, true);
  EXPECT_EQ(loadText("a.glb", file.glb()).positions, unweighted.positions);
}

TEST(GltfPose, SkinErrorsNameThePlace) {
  using Change = std::function<void(GltfFile&)>;
  const auto attribute = [](GltfFile& f, const char* name) -> json& {
    return f.document["meshes"][0]["primitives"][0]["attributes"][name];
  };
  const auto accessor = [&](GltfFile& f, const char* name) -> json& {
    return f.document["accessors"][attribute(f, name).get<size_t>()];
  };
  const std::pair<Change, std::string> cases[] = {
      {[](GltfFile& f) { f.document["nodes"][0]["skin"] = 4; },
       "nodes[0].skin: 4 is out of range, there are 1 in the file"},
      {[](GltfFile& f) { f.document["skins"][0].erase("joints"); }, "skins[0].joints: expected at least one"},
      {[](GltfFile& f) {
         f.document["skins"][0]["joints"] = {1, 99};
       },
       "skins[0].joints[1]: expected an index below 7"},
      {[](GltfFile& f) {
         f.document["skins"][0]["joints"] = {2, 3};
       },
       "accessors[2], element 0: joint 2 is out of range, skins[0] has 2"},
      {[](GltfFile& f) {
         f.document["nodes"].push_back({{"children", {7}}});
         f.document["skins"][0]["joints"][0] = 7;
       },
       "skins[0].joints[0]: nodes[7] is its own ancestor"},
      {[&](GltfFile& f) { accessor(f, "JOINTS_0")["componentType"] = 5120; },
       "accessors[2]: joints need componentType 5121 or 5123, not normalized"},
      {[&](GltfFile& f) { accessor(f, "JOINTS_0")["normalized"] = true; },
       "accessors[2]: joints need componentType 5121 or 5123, not normalized"},
      {[&](GltfFile& f) { accessor(f, "JOINTS_0")["type"] = "VEC3"; }, "accessors[2].type: joints need VEC4"},
      {[&](GltfFile& f) { accessor(f, "JOINTS_0")["count"] = 11; },
       "accessors[2].count: 11 does not fit the 12 positions in accessors[0]"},
      {[&](GltfFile& f) { accessor(f, "WEIGHTS_0")["count"] = 13; },
       "accessors[3].count: 13 does not fit the 12 positions in accessors[0]"},
      {[&](GltfFile& f) { accessor(f, "WEIGHTS_0")["componentType"] = 5122; },
       "accessors[3]: weights need componentType 5121, 5123 or 5126"},
      {[&](GltfFile& f) { accessor(f, "WEIGHTS_0")["byteOffset"] = 4; },
       "accessors[3]: 12 elements from byte 4 on lie outside of the buffer view with its 192 bytes"},
      {[&](GltfFile& f) { attribute(f, "WEIGHTS_0") = 50; },
       "meshes[0].primitives[0].attributes.WEIGHTS_0: 50 is out of range, there are 4 in the file"},
      {[](GltfFile& f) { f.document["meshes"][0]["primitives"][0]["attributes"].erase("WEIGHTS_0"); },
       "meshes[0].primitives[0].attributes: key \"WEIGHTS_0\" is missing"},
      {[](GltfFile& f) { f.document["meshes"][0]["primitives"][0]["attributes"].erase("JOINTS_0"); },
       "meshes[0].primitives[0].attributes: key \"JOINTS_0\" is missing"},
      {[](GltfFile& f) { f.document["accessors"][1]["count"] = 4; },
       "accessors[1]: inverse bind matrices need a bufferView, componentType 5126 and a count of at least 5, "
       "one a joint "
       "of skins[0]"},
      {[](GltfFile& f) { f.document["accessors"][1].erase("bufferView"); },
       "accessors[1]: inverse bind matrices need a bufferView, componentType 5126 and a count of at least 5, "
       "one a joint "
       "of skins[0]"},
      {[](GltfFile& f) { f.document["accessors"][1]["type"] = "VEC4"; },
       "accessors[1].type: inverse bind matrices need MAT4"},
  };
  for (const auto& [change, message] : cases) {
    GltfFile file = skinnedMesh(5, 5121, 5126, 1, true).file;
    change(file);
    EXPECT_EQ(loadError("a.glb", file.glb()), "a.glb: " + message);
  }
}

/// Three morph targets over a square: of floats, of sparse values alone, of quantised values.
struct MorphedSquare {
  GltfFile file = test::squareFile<uint8_t>(5121);
  std::vector<std::vector<glm::dvec3>> targets;
};

MorphedSquare morphedSquare() {
  MorphedSquare square;
  GltfFile& file = square.file;
  const std::vector<glm::vec3> dense = {{1, 2, 3}, {-1, 0, 0.5f}, {0, 0, 0}, {7, 7, 7}};
  const size_t first = file.addPositions(dense);
  square.targets.emplace_back(dense.begin(), dense.end());
  const size_t indices = file.addView(bytesOf(std::vector<uint16_t>{1, 2}));
  const size_t values = file.addView(bytesOf(std::vector<float>{0, 0, 4, 5, 0, 0}));
  const json sparse = {{"count", 2},
                       {"indices", {{"bufferView", indices}, {"componentType", 5123}}},
                       {"values", {{"bufferView", values}}}};
  file.document["accessors"].push_back(
      {{"componentType", 5126}, {"count", 4}, {"type", "VEC3"}, {"sparse", sparse}});
  const size_t second = file.document["accessors"].size() - 1;
  square.targets.push_back({{0, 0, 0}, {0, 0, 4}, {5, 0, 0}, {0, 0, 0}});
  const std::vector<int8_t> quantized = {127, 0, -127, 0, 64, 1, 2, 0, 0, 0, 0, 0, -5, 5, 100, 0};
  const size_t third = file.addAccessor(file.addView(bytesOf(quantized), 4), 5120, 4, "VEC3");
  file.document["accessors"][third]["normalized"] = true;
  square.targets.emplace_back();
  for (size_t i = 0; i < 16; i += 4) {
    square.targets[2].emplace_back(glm::dvec3(quantized[i], quantized[i + 1], quantized[i + 2]) / 127.0);
  }
  file.document["meshes"][0]["primitives"][0]["targets"] = {
      {{"POSITION", first}}, {{"POSITION", second}, {"NORMAL", 0}}, {{"POSITION", third}}, {{"NORMAL", 0}}};
  return square;
}

TEST(GltfPose, MorphTargetsMatchBruteForce) {
  MorphedSquare square = morphedSquare();
  const auto expectWeights = [&](const std::vector<double>& weights) {
    const Scene scene = loadText("a.glb", square.file.glb());
    expectValid(scene);
    for (size_t i = 0; i < 4; ++i) {
      glm::dvec3 expected(test::squareCorners()[i]);
      for (size_t t = 0; t < 3; ++t) expected += weights[t] * square.targets[t][i];
      EXPECT_LT(glm::distance(glm::dvec3(scene.positions[i]), expected), 1e-5) << i;
    }
  };
  expectWeights({0, 0, 0});
  square.file.document["meshes"][0]["weights"] = {0.25, 1, -1.5, 1};
  expectWeights({0.25, 1, -1.5});
  square.file.document["nodes"][0]["weights"] = {0, 0.5, 2, 0};
  expectWeights({0, 0.5, 2});
  square.file.document["nodes"][0]["weights"] = {0, 0, 0, 0};
  expectWeights({0, 0, 0});
}

TEST(GltfPose, MorphTargetsComeBeforeTheSkin) {
  GltfFile file = test::posedFile();
  file.document["nodes"].erase(4);
  file.document["nodes"].erase(3);
  const Scene scene = loadText("a.glb", file.glb());
  ASSERT_EQ(scene.positions.size(), 4u);
  // Vertex 2 is (1, 1, 0) and half of (0, 0, 2), bound to joint 0 alone: 1 to the left, then (1, 2, 3) on.
  EXPECT_EQ(scene.positions[2], glm::vec3(1, 3, 4));
  // Vertex 1, (1, 0, 0), is bound to joint 1: twice as large, half a turn about z, (1, 2, 3) on.
  EXPECT_LT(glm::distance(scene.positions[1], glm::vec3(-1, 2, 3)), 1e-6f);
}

TEST(GltfPose, MorphErrorsNameThePlace) {
  using Change = std::function<void(json&)>;
  const std::pair<Change, std::string> cases[] = {
      {[](json& d) {
         d["meshes"][0]["weights"] = {1, 2};
       },
       "meshes[0].weights: 2 numbers for 4 morph targets"},
      {[](json& d) {
         d["nodes"][0]["weights"] = {1, 2, 3};
       },
       "nodes[0].weights: 3 numbers for 4 morph targets"},
      {[](json& d) {
         d["nodes"][0]["weights"] = {1, 2, 3, "x"};
       },
       "nodes[0].weights: expected 4 numbers"},
      {[](json& d) { d["meshes"][0]["primitives"][0]["targets"][0]["POSITION"] = 9; },
       "meshes[0].primitives[0].targets[0].POSITION: 9 is out of range, there are 5 in the file"},
      {[](json& d) { d["accessors"][2]["count"] = 3; },
       "accessors[2].count: 3 does not fit the 4 positions in accessors[0]"},
      {[](json& d) { d["accessors"][2]["type"] = "VEC4"; }, "accessors[2].type: positions need VEC3"},
      {[](json& d) { d["accessors"][2]["byteOffset"] = 8; },
       "accessors[2]: 4 elements from byte 8 on lie outside of the buffer view with its 48 bytes"},
  };
  for (const auto& [change, message] : cases) {
    GltfFile file = morphedSquare().file;
    file.document["meshes"][0]["weights"] = {1, 1, 1, 1};
    change(file.document);
    EXPECT_EQ(loadError("a.glb", file.glb()), "a.glb: " + message);
  }
}

}  // namespace
}  // namespace sightline
