// Stripped files: exactly the triangles that should stay, read back by the loader, and all else of the file
// as it was.
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <map>
#include <random>
#include <tuple>

#include "core/formats/glb.h"
#include "core/strip/strip_scene.h"
#include "files.h"
#include "gltf_files.h"

namespace sightline {
namespace {

using namespace test;

/// Whole numbers of 32 bits.
class StripRandom {
 public:
  explicit StripRandom(uint32_t seed) : engine_(seed) {}
  uint32_t operator()() { return static_cast<uint32_t>(engine_()); }

 private:
  std::mt19937 engine_;
};

using StripCorners = std::array<glm::vec3, 3>;

/// A file that was stripped: what was written, and what is read of that.
struct StrippedText {
  std::string text;
  Scene scene;
  StripReport report;
};

/// The triangles of these objects' runs that are kept, by where their corners are.
std::vector<StripCorners> cornersOf(const Scene& scene, const std::vector<bool>& kept = {}) {
  std::vector<StripCorners> corners;
  for (uint32_t id = 0; id < scene.triangleCount(); ++id) {
    if (kept.empty() || kept[id]) corners.push_back(scene.corners(id));
  }
  return corners;
}

/// Each triangle begins with its least corner: compressed lists of indices turn triangles.
std::vector<StripCorners> turned(std::vector<StripCorners> triangles) {
  const auto less = [](const glm::vec3& a, const glm::vec3& b) {
    return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
  };
  for (StripCorners& t : triangles)
    std::rotate(t.begin(), std::min_element(t.begin(), t.end(), less), t.end());
  return triangles;
}

StrippedText stripFile(const Folder& folder, const std::string& name, const std::vector<bool>& seen,
                       const StripOptions& options = {}) {
  const Scene scene = loadScene(folder / name, {.faces = true});
  const std::string out = "out" + name.substr(name.find('.'));
  const StripReport report = stripScene(scene, folder / name, seen, options, folder / out);
  StrippedText left{readText(folder / out), loadScene(folder / out), report};
  EXPECT_EQ(turned(cornersOf(left.scene)), turned(cornersOf(scene, report.kept)));
  return left;
}

StrippedText stripText(const std::string& name, const std::string& text, const std::vector<bool>& seen,
                       const StripOptions& options = {}) {
  const Folder folder;
  folder.write(name, text);
  return stripFile(folder, name, seen, options);
}

std::vector<bool> randomBits(size_t count, StripRandom& random, uint32_t of = 2) {
  std::vector<bool> bits(count);
  for (size_t i = 0; i < count; ++i) bits[i] = random() % of == 0;
  bits[random() % count] = true;
  return bits;
}

/// Of OBJ and PLY: all triangles of a face stay if any is seen.
std::vector<bool> byFace(const Scene& scene, const std::vector<bool>& seen) {
  std::map<uint32_t, bool> faces;
  for (size_t id = 0; id < seen.size(); ++id) faces[scene.faces[id]] = faces[scene.faces[id]] || seen[id];
  std::vector<bool> kept;
  for (const uint32_t face : scene.faces) kept.push_back(faces[face]);
  return kept;
}

/// Of glTF: a primitive's triangle stays if any use of it is seen.
std::vector<bool> byPart(const Scene& scene, const std::vector<bool>& seen) {
  const auto key = [&](const SceneObject& object, uint32_t id) {
    return std::tuple(object.part->mesh, object.part->primitive, id - object.first_triangle);
  };
  std::map<std::tuple<uint32_t, uint32_t, uint32_t>, bool> parts;
  std::vector<bool> kept(seen.size());
  for (const bool second : {false, true}) {
    for (const SceneObject& object : scene.objects) {
      for (uint32_t id = object.first_triangle; id < object.first_triangle + object.triangle_count; ++id) {
        if (second) {
          kept[id] = parts[key(object, id)];
        } else if (seen[id]) {
          parts[key(object, id)] = true;
        }
      }
    }
  }
  return kept;
}

constexpr const char* kObj =
    "\xef\xbb\xbf# cube\r\nmtllib none.mtl\nv 0 0 0\nv 1 0 0 # corner\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nv 0 "
    "1 0\n"
    "v 9 9 9\no a\nusemtl red\nf 1/1 2/2 3/3 4/1\n# between\ng b\nf -5/-3/ 2 \\\n  3/3 # end\nf 1 2 4\r\n"
    "v 0 0 1\nvn 0 0 1\nvn 0 1 0\nl 1 3\no c\nf -1//-1 1//2 2//1\nf +1 2 6\n";

TEST(StripObj, TakesTheLinesOfFacesAndNothingElse) {
  // Triangles: face 0 gives 0 and 1, face 1 (two lines) 2, face 2 3, face 3 4, face 4 5.
  const StrippedText left = stripText("a.obj", kObj, {false, true, false, true, false, false});
  EXPECT_EQ(
      left.text,
      "\xef\xbb\xbf# cube\r\nmtllib none.mtl\nv 0 0 0\nv 1 0 0 # corner\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\n"
      "v 0 1 0\nv 9 9 9\no a\nusemtl red\nf 1/1 2/2 3/3 4/1\n# between\ng b\nf 1 2 4\r\n"
      "v 0 0 1\nvn 0 0 1\nvn 0 1 0\nl 1 3\no c\n");
  EXPECT_EQ(left.report.triangles, 3u);
  EXPECT_EQ(left.report.objects_gone, 1u);
  EXPECT_EQ(left.report.bytes, left.text.size());
  EXPECT_EQ(left.report.bytes_before, std::string(kObj).size());
}

TEST(StripObj, CompactRenumbersWhatIsLeft) {
  const StrippedText left =
      stripText("a.obj", kObj, {false, false, true, false, true, false}, {.compact = true});
  EXPECT_EQ(left.text,
            "\xef\xbb\xbf# cube\r\nmtllib none.mtl\nv 0 0 0\nv 1 0 0 # corner\nv 1 1 0\nvt 0 0\nvt 1 1\n"
            "o a\nusemtl red\n# between\ng b\nf -3/-2/ 2 \\\n  3/2 # end\n"
            "v 0 0 1\nvn 0 0 1\nvn 0 1 0\nl 1 3\no c\nf -1//-1 1//2 2//1\n");
}

TEST(StripObj, KeepsAFaceOfEachObjectIfAsked) {
  const StrippedText left =
      stripText("a.obj", kObj, {false, true, false, false, false, false}, {.keep_objects = true});
  EXPECT_EQ(left.report.objects_gone, 0u);
  EXPECT_EQ(left.scene.objects.size(), 3u);
  EXPECT_EQ(left.scene.triangleCount(), 4u);
}

TEST(StripObj, LeavesExactlyWhatIsSeen) {
  StripRandom random(3);
  for (int round = 0; round < 30; ++round) {
    std::string text;
    int vertices = 0;
    const int faces = 1 + int(random() % 20);
    for (int f = 0; f < faces; ++f) {
      for (int i = 0; i < 4; ++i, ++vertices) {
        text += "v " + std::to_string(random() % 100) + " " + std::to_string(random() % 100) + " 7\n";
      }
      text += random() % 4 == 0 ? "g x\nf" : "f";
      const uint32_t corners = 3 + random() % 2;
      for (uint32_t i = 0; i < corners; ++i) {
        const int vertex = int(random() % uint32_t(vertices));
        text += " " + std::to_string(random() % 2 ? vertex + 1 : vertex - vertices);
      }
      text += "\n";
    }
    const Scene scene = loadText("a.obj", text, {.faces = true});
    const std::vector<bool> seen = randomBits(scene.triangleCount(), random);
    for (const bool compact : {false, true}) {
      const StrippedText left = stripText("a.obj", text, seen, {.compact = compact});
      ASSERT_EQ(cornersOf(left.scene), cornersOf(scene, byFace(scene, seen))) << "round " << round << text;
      if (compact) {
        ASSERT_LE(left.scene.vertexCount(), 4 * left.scene.triangleCount());
      }
    }
  }
}

/// A PLY file of a vertex, face and tristrips element, in each format.
std::string plyText(const std::string& format, const std::vector<std::vector<int>>& faces,
                    const std::vector<std::vector<int>>& strips, int vertices) {
  std::string text =
      "ply\nformat " + format + " 1.0\ncomment element of surprise 3\nelement vertex " +
      std::to_string(vertices) +
      "\nproperty float x\nproperty uchar red\nproperty float y\nproperty float z\nelement face " +
      std::to_string(faces.size()) +
      "\nproperty short kind\nproperty list uchar int vertex_indices\nproperty float q\n"
      "element tristrips " +
      std::to_string(strips.size()) + "\nproperty list int int vertex_indices\nend_header\n";
  const bool ascii = format == "ascii";
  const auto put = [&](auto value) {
    if (ascii) {
      text += std::to_string(value) + " ";
      return;
    }
    std::string bytes(reinterpret_cast<const char*>(&value), sizeof(value));
    if (format == "binary_big_endian") std::reverse(bytes.begin(), bytes.end());
    text += bytes;
  };
  const auto end = [&] { text += ascii ? "\n" : ""; };
  for (int v = 0; v < vertices; ++v, end()) {
    put(float(v % 5));
    put(uint8_t(v));
    put(float(v / 5));
    put(float(v * v % 7));
  }
  for (const auto& face : faces) {
    put(int16_t(-3));
    put(uint8_t(face.size()));
    for (const int corner : face) put(int32_t(corner));
    put(0.5f);
    end();
  }
  for (const auto& strip : strips) {
    put(int32_t(strip.size()));
    for (const int corner : strip) put(int32_t(corner));
    end();
  }
  return text;
}

TEST(StripPly, LeavesExactlyWhatIsSeenInEachFormat) {
  StripRandom random(4);
  for (int round = 0; round < 60; ++round) {
    const int vertices = 25;
    std::vector<std::vector<int>> faces(1 + random() % 9), strips(random() % 4);
    const auto fill = [&](std::vector<int>& list, size_t count) {
      for (size_t i = 0; i < count; ++i) list.push_back(int(random() % vertices));
    };
    for (auto& face : faces) fill(face, 3 + random() % 2);
    for (auto& strip : strips) {
      fill(strip, random() % 7);
      if (random() % 2) strip.push_back(-1);
      fill(strip, random() % 5);
    }
    const std::string format =
        std::array{"ascii", "binary_little_endian", "binary_big_endian"}[size_t(round % 3)];
    const std::string text = plyText(format, faces, strips, vertices);
    const Scene scene = loadText("a.ply", text, {.faces = true});
    const std::vector<bool> seen = randomBits(scene.triangleCount(), random);
    for (const bool compact : {false, true}) {
      const StrippedText left = stripText("a.ply", text, seen, {.compact = compact});
      ASSERT_EQ(cornersOf(left.scene), cornersOf(scene, byFace(scene, seen)))
          << format << ", round " << round;
      if (compact && strips.empty()) {  // strips of two corners use vertices, too
        ASSERT_LE(left.scene.vertexCount(), 4 * left.scene.triangleCount());
      }
    }
    // Nothing goes: the same bytes.
    ASSERT_EQ(stripText("a.ply", text, std::vector<bool>(seen.size(), true)).text, text);
  }
}

TEST(StripPly, TakesRowsAndCountsAndNothingElse) {
  const std::string text = plyText("ascii", {{0, 1, 6}, {1, 2, 7}, {2, 3, 8}}, {}, 10);
  std::string expected = plyText("ascii", {{0, 1, 6}, {2, 3, 8}}, {}, 10);
  EXPECT_EQ(stripText("a.ply", text, {true, false, true}).text, expected);
}

TEST(StripPly, KeepsVerticesThatOtherElementsMayNumber) {
  const std::string text =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 2\nproperty list uchar int vertex_indices\nelement edge 1\nproperty int vertex1\n"
      "property int vertex2\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n1 3\n";
  const StrippedText left = stripText("a.ply", text, {true, false}, {.compact = true});
  EXPECT_EQ(left.scene.vertexCount(), 4u);
  ASSERT_EQ(left.report.notes.size(), 1u);
  EXPECT_NE(left.report.notes[0].find("element edge"), std::string::npos);
}

json documentOf(const std::string& glb) {
  return json::parse(splitGlb(glb, "a.glb").json);
}

/// A glTF file of random primitives: lists, strips and fans, with and without indices, of one, two and four
/// bytes; interleaved or not; shared and own vertices; meshes that several nodes show.
GltfFile randomFile(StripRandom& random) {
  GltfFile file;
  file.document["asset"]["generator"] = "test \"quoted\" {[";
  file.document["materials"] = {{{"name", "red"}, {"pbrMetallicRoughness", {{"metallicFactor", 0.25}}}}};
  const size_t meshes = 1 + random() % 3;
  for (size_t m = 0; m < meshes; ++m) {
    const uint32_t vertices = 8 + random() % 30;
    const bool interleaved = random() % 2 == 0;
    std::vector<glm::vec3> positions, normals, both;
    for (uint32_t v = 0; v < vertices; ++v) {
      positions.push_back(glm::vec3(random() % 50, random() % 50, random() % 50) / 7.0f);
      normals.push_back(glm::vec3(float(v), 0, 1));
      both.insert(both.end(), {positions.back(), normals.back()});
    }
    size_t position = 0, normal = 0;
    if (interleaved) {
      const size_t view = file.addView(bytesOf(both), 24);
      position = file.addAccessor(view, 5126, vertices, "VEC3");
      normal = file.addAccessor(view, 5126, vertices, "VEC3");
      file.document["accessors"].back()["byteOffset"] = 12;
    } else {
      position = file.addPositions(positions);
      normal = file.addPositions(normals);
    }
    file.document["accessors"][position]["min"] = {0, 0, 0};
    file.document["accessors"][position]["max"] = {8, 8, 8};
    const size_t primitives = 1 + random() % 3;
    for (size_t p = 0; p < primitives; ++p) {
      const int mode = 4 + int(random() % 3);
      json primitive = {{"attributes", {{"POSITION", position}, {"NORMAL", normal}}}, {"mode", mode}};
      if (p != 0 || random() % 3 != 0) {
        const uint32_t count = mode == 4 ? 3 * (1 + random() % 9) : 3 + random() % 9;
        std::string bytes;
        const int size = std::array{1, 2, 4}[random() % 3];
        for (uint32_t i = 0; i < count; ++i) {
          const uint32_t index = random() % vertices;
          bytes.append(reinterpret_cast<const char*>(&index), size_t(size));
        }
        primitive["indices"] = file.addAccessor(file.addView(bytes),
                                                size == 1   ? 5121
                                                : size == 2 ? 5123
                                                            : 5125,
                                                count, "SCALAR");
      } else if (mode == 4) {
        file.document["accessors"][position]["count"] = vertices / 3 * 3;
        file.document["accessors"][normal]["count"] = vertices / 3 * 3;
      }
      if (p == 0) {
        file.document["meshes"].push_back({{"name", "m"}, {"primitives", json::array({primitive})}});
      } else {
        json& list = file.document["meshes"][m]["primitives"];
        if (file.document["accessors"][position]["count"] != vertices) primitive.erase("indices");
        if (!primitive.contains("indices")) primitive["mode"] = 5;
        list.push_back(primitive);
      }
    }
    const size_t nodes = 1 + random() % 2;
    for (size_t n = 0; n < nodes; ++n) {
      file.document["nodes"].push_back({{"mesh", m}, {"name", "n\\u00e9"}, {"translation", {n * 100, m, 0}}});
      if (random() % 4 == 0) file.document["nodes"].back()["scale"] = {-1, 1, 1};
    }
  }
  return file;
}

/// All of the document but the places where stripping may change it.
json untouchedParts(json document) {
  document.erase("buffers");
  document.erase("bufferViews");
  document.erase("accessors");
  for (json& mesh : document["meshes"]) mesh.erase("primitives");
  for (json& node : document["nodes"]) node.erase("mesh");
  return document;
}

/// Checks what the loader does not look at.
void expectSound(const std::string& glb) {
  const Glb chunks = splitGlb(glb, "a.glb");
  const json document = json::parse(chunks.json);
  const uint64_t length = document["buffers"][0]["byteLength"];
  ASSERT_LE(length, chunks.bin.size());
  ASSERT_LT(chunks.bin.size() - length, 4u);
  for (const json& view : document["bufferViews"]) {
    ASSERT_GE(view["byteLength"].get<uint64_t>(), 1u);
    ASSERT_LE(view.value("byteOffset", uint64_t(0)) + view["byteLength"].get<uint64_t>(), length) << view;
  }
  for (const json& accessor : document["accessors"]) {
    ASSERT_GE(accessor["count"].get<uint64_t>(), 1u);
    if (!accessor.contains("bufferView")) continue;
    const json& view = document["bufferViews"][accessor["bufferView"].get<size_t>()];
    const uint64_t bytes =
        std::map<int, uint64_t>{{5121, 1}, {5123, 2}, {5125, 4}, {5126, 4}}[accessor["componentType"]];
    const uint64_t element = bytes * (accessor["type"] == "VEC3" ? 3 : 1);
    const uint64_t offset = accessor.value("byteOffset", uint64_t(0));
    ASSERT_EQ((view.value("byteOffset", uint64_t(0)) + offset) % bytes, 0u) << accessor;
    const uint64_t stride = view.value("byteStride", element);
    ASSERT_LE(offset + stride * (accessor["count"].get<uint64_t>() - 1) + element,
              view["byteLength"].get<uint64_t>())
        << accessor << view;
  }
  for (const json& mesh : document["meshes"]) ASSERT_FALSE(mesh["primitives"].empty());
}

TEST(StripGltf, LeavesExactlyWhatIsSeen) {
  StripRandom random(5);
  for (int round = 0; round < 80; ++round) {
    const std::string glb = randomFile(random).glb();
    const Scene scene = loadText("a.glb", glb);
    const std::vector<bool> seen = randomBits(scene.triangleCount(), random, 2 + random() % 12);
    const std::vector<bool> kept = byPart(scene, seen);
    for (const bool compact : {false, true}) {
      SCOPED_TRACE(testing::Message() << "round " << round << ", compact " << compact);
      const StrippedText left = stripText("a.glb", glb, seen, {.compact = compact});
      ASSERT_EQ(cornersOf(left.scene), cornersOf(scene, kept));
      ASSERT_EQ(left.report.triangles, left.scene.triangleCount());
      ASSERT_NO_FATAL_FAILURE(expectSound(left.text));
      ASSERT_EQ(untouchedParts(documentOf(left.text)), untouchedParts(documentOf(glb)));
    }
  }
}

TEST(StripGltf, CompactLeavesOnlyVerticesInUseAndTheirNumbersWithThem) {
  StripRandom random(6);
  for (int round = 0; round < 30; ++round) {
    const std::string glb = randomFile(random).glb();
    const Scene scene = loadText("a.glb", glb);
    const StrippedText left =
        stripText("a.glb", glb, randomBits(scene.triangleCount(), random, 8), {.compact = true});
    std::vector<bool> used(left.scene.vertexCount(), false);
    for (uint32_t id = 0; id < left.scene.triangleCount(); ++id) {
      for (int c = 0; c < 3; ++c) used[left.scene.vertexNumbers(id)[c]] = true;
    }
    ASSERT_EQ(std::count(used.begin(), used.end(), false), 0) << "round " << round;
    // The normals, which number the vertices, went the same way: position by position as before.
    const json before = documentOf(glb), after = documentOf(left.text);
    const auto numbers = [&](const std::string& file, const json& document, size_t mesh) {
      std::multimap<std::tuple<float, float, float>, float> pairs;
      const json& attributes = document["meshes"][mesh]["primitives"][0]["attributes"];
      const std::string_view bin = splitGlb(file, "a").bin;
      const auto read = [&](const char* name, uint64_t i) {
        const json& accessor = document["accessors"][attributes[name].get<size_t>()];
        const json& view = document["bufferViews"][accessor["bufferView"].get<size_t>()];
        glm::vec3 value;
        std::memcpy(&value,
                    bin.data() + view.value("byteOffset", uint64_t(0)) +
                        accessor.value("byteOffset", uint64_t(0)) +
                        i * view.value("byteStride", uint64_t(12)),
                    12);
        return value;
      };
      const uint64_t count = document["accessors"][attributes["POSITION"].get<size_t>()]["count"];
      for (uint64_t i = 0; i < count; ++i) {
        const glm::vec3 p = read("POSITION", i);
        pairs.emplace(std::tuple(p.x, p.y, p.z), read("NORMAL", i).x);
      }
      return pairs;
    };
    for (size_t m = 0; m < before["meshes"].size(); ++m) {
      const auto all = numbers(glb, before, m);
      for (const auto& pair : numbers(left.text, after, m)) {
        const auto [first, last] = all.equal_range(pair.first);
        ASSERT_TRUE(std::any_of(first, last, [&](const auto& other) { return other.second == pair.second; }));
      }
    }
  }
}

TEST(StripGltf, BoundsOfPositionsAreThoseOfWhatIsLeft) {
  GltfFile file = squareFile<uint16_t>(5123);
  file.document["accessors"][0]["min"] = {0, 0, 0};
  file.document["accessors"][0]["max"] = {1, 1, 0};
  file.document["nodes"].push_back({{"mesh", 0}, {"translation", {0, 0, 1}}});
  const json left =
      documentOf(stripText("a.glb", file.glb(), {true, false, false, false}, {.compact = true}).text);
  EXPECT_EQ(left["accessors"][0]["count"], 3);
  EXPECT_EQ(left["accessors"][0]["min"], json({0, 0, 0}));
  EXPECT_EQ(left["accessors"][0]["max"], json({1, 1, 0}));
}

TEST(StripGltf, ChangesNoByteThatItNeedNot) {
  GltfFile file = squareFile<uint16_t>(5123);
  file.document["materials"] = {{{"name", "a"}, {"extras", {{"t", "}{"}}}}};
  const std::string glb = file.glb();
  EXPECT_EQ(stripText("a.glb", glb, {true, true}).text, glb);
  // One triangle goes: count, type and place of one accessor, the length of its view and of the buffer.
  const std::string text(splitGlb(glb, "a").json);
  const std::string left(splitGlb(stripText("a.glb", glb, {true, false}).text, "a").json);
  const json changes = json::diff(json::parse(text), json::parse(left));
  for (const json& change : changes) {
    const std::string path = change["path"];
    EXPECT_TRUE(path.starts_with("/accessors/1/") || path.starts_with("/bufferViews/1/") ||
                path.starts_with("/buffers/0/"))
        << change;
  }
  const std::string tail = text.substr(text.find("\"materials\""));
  EXPECT_NE(left.find(tail.substr(0, tail.find_last_of('}') + 1)), std::string::npos) << left;
}

TEST(StripGltf, CompressedViewsStayCompressed) {
  for (const bool sequence : {false, true}) {
    for (const bool compact : {false, true}) {
      const std::string glb = compressedSquare(sequence).glb();
      const Scene scene = loadText("a.glb", glb);
      const StrippedText left = stripText("a.glb", glb, {false, true}, {.compact = compact});
      EXPECT_EQ(turned(cornersOf(left.scene)), turned(cornersOf(scene, {false, true})));
      EXPECT_EQ(left.scene.vertexCount(), compact ? 3u : 4u);
      const json document = documentOf(left.text);
      for (const json& view : document["bufferViews"]) {
        EXPECT_TRUE(view.contains("extensions")) << view;
      }
      EXPECT_LE(left.text.size(), glb.size() + 64);  // of numbers in the JSON
    }
  }
}

TEST(StripGltf, AMeshOfWhichNothingIsLeftIsShownByNoNode) {
  GltfFile file = squareFile<uint16_t>(5123);
  file.addMesh(0, 1);
  file.document["nodes"][1]["name"] = "gone";
  file.document["nodes"][1]["extensions"] = {{"KHR_node_visibility", {{"visible", true}}}};
  const std::string glb = file.glb();
  const StrippedText left = stripText("a.glb", glb, {true, true, false, false});
  const json after = documentOf(left.text);
  EXPECT_EQ(after["nodes"][1],
            json({{"name", "gone"}, {"extensions", {{"KHR_node_visibility", {{"visible", true}}}}}}));
  EXPECT_EQ(after["nodes"][0], documentOf(glb)["nodes"][0]);
  EXPECT_EQ(after["meshes"].size(), 2u);
  EXPECT_EQ(left.scene.triangleCount(), 2u);
  EXPECT_EQ(left.report.objects_gone, 1u);
  // The list of indices is the other mesh's, too, and stays that.
  EXPECT_EQ(after["meshes"][0], documentOf(glb)["meshes"][0]);

  const StrippedText all = stripText("a.glb", glb, {true, true, false, false}, {.keep_objects = true});
  EXPECT_EQ(all.scene.triangleCount(), 3u);
  EXPECT_EQ(all.scene.objects.size(), 2u);
  EXPECT_EQ(all.report.objects_gone, 0u);
}

TEST(StripGltf, PrimitivesOfWhichNothingIsLeftLeaveTheirMesh) {
  GltfFile file = squareFile<uint16_t>(5123);
  json& primitives = file.document["meshes"][0]["primitives"];
  const json first = primitives[0];
  primitives.push_back(first);
  primitives.push_back({{"attributes", {{"POSITION", 0}}}, {"mode", 1}});
  const StrippedText left = stripText("a.glb", file.glb(), {false, false, false, true});
  const json after = documentOf(left.text)["meshes"][0]["primitives"];
  ASSERT_EQ(after.size(), 2u);
  EXPECT_EQ(after[1]["mode"], 1);
  EXPECT_EQ(left.scene.triangleCount(), 1u);
}

/// What is said about a file whose triangles 2 and 3 are not seen, with this change of the document.
StripReport reportWith(const std::function<void(json&)>& change, uint32_t triangles_left) {
  GltfFile file = squareFile<uint16_t>(5123);
  file.addMesh(0, 1);
  change(file.document);
  const std::string glb = file.glb();
  std::vector<bool> seen(loadText("a.glb", glb).triangleCount(), false);
  seen[0] = seen[1] = true;
  const StrippedText left = stripText("a.glb", glb, seen);
  EXPECT_EQ(left.scene.triangleCount(), triangles_left);
  return left.report;
}

TEST(StripGltf, WhatMovesStaysWhole) {
  const auto moved = [](json target) {
    return [target](json& document) {
      document["nodes"].push_back({{"children", {1}}});
      document["scenes"] = {{{"nodes", {0, 2}}}};
      document["animations"] = {
          {{"samplers", json::array()}, {"channels", {{{"sampler", 0}, {"target", target}}}}}};
    };
  };
  for (const json& target :
       {json{{"node", 2}, {"path", "translation"}}, json{{"node", 1}, {"path", "rotation"}},
        json{{"path", "pointer"},
             {"extensions", {{"KHR_animation_pointer", {{"pointer", "/nodes/2/translation"}}}}}}}) {
    const StripReport report = reportWith(moved(target), 4);
    ASSERT_EQ(report.notes.size(), 1u) << target;
    EXPECT_NE(report.notes[0].find("1 primitive stay whole, since animations"), std::string::npos)
        << report.notes[0];
  }
  reportWith(moved({{"node", 0}, {"path", "translation"}}), 2);
  const StripReport morphed = reportWith(
      [](json& document) {
        document["meshes"][1]["primitives"][0]["targets"] = {{{"POSITION", 0}}};
      },
      4);
  EXPECT_EQ(morphed.notes.size(), 1u);
}

TEST(StripGltf, WhatOtherNodesShowStaysWhole) {
  const auto hidden = [](json& document) {
    document["nodes"].push_back(
        {{"mesh", 1}, {"extensions", {{"KHR_node_visibility", {{"visible", false}}}}}});
  };
  EXPECT_EQ(reportWith(hidden, 4).notes.size(), 1u);
  const auto elsewhere = [](json& document) {
    document["nodes"].push_back({{"mesh", 1}});
    document["scenes"] = {{{"nodes", {0, 1}}}, {{"nodes", {2}}}};
  };
  EXPECT_EQ(reportWith(elsewhere, 4).notes.size(), 1u);
}

TEST(StripGltf, PrimitivesWhoseExtensionsNeedTheirOrderStayWhole) {
  const auto with = [](const char* name) {
    return [name](json& document) {
      document["meshes"][1]["primitives"][0]["extensions"][name] = json::object();
    };
  };
  EXPECT_EQ(reportWith(with("FB_ngon_encoding"), 4).notes.size(), 1u);
  EXPECT_TRUE(reportWith(with("KHR_materials_variants"), 2).notes.empty());
}

TEST(StripGltf, BuffersBesideAreWrittenBesideTheOutput) {
  const Folder folder;
  const GltfFile file = squareFile<uint16_t>(5123);
  folder.write("data.bin", file.bin);
  folder.write("a b.gltf", file.gltf("data.bin"));
  const Scene scene = loadScene(folder / "a b.gltf");
  const StripReport report = stripScene(scene, folder / "a b.gltf", {true, false}, {}, folder / "c d.gltf");
  EXPECT_EQ(readText(folder / "data.bin"), file.bin);
  ASSERT_EQ(report.buffers.size(), 1u);
  EXPECT_EQ(report.buffers[0], folder / "c d.bin");
  EXPECT_EQ(json::parse(readText(folder / "c d.gltf"))["buffers"][0]["uri"], "c%20d.bin");
  EXPECT_EQ(cornersOf(loadScene(folder / "c d.gltf")), cornersOf(scene, {true, false}));
  EXPECT_EQ(report.bytes, readText(folder / "c d.gltf").size() + readText(folder / "c d.bin").size());
  EXPECT_EQ(report.bytes_before, readText(folder / "a b.gltf").size() + file.bin.size());

  // A name that a buffer of the scene has is not taken.
  stripScene(scene, folder / "a b.gltf", {true, false}, {}, folder / "data.gltf");
  EXPECT_EQ(readText(folder / "data.bin"), file.bin);
  EXPECT_EQ(json::parse(readText(folder / "data.gltf"))["buffers"][0]["uri"], "data-1.bin");
  // Nor is one that is there, unless it may be.
  EXPECT_NE(errorOf([&] {
              stripScene(scene, folder / "a b.gltf", {true, false}, {}, folder / "c d.gltf");
            }).find("c d.bin: is there already"),
            std::string::npos);
  stripScene(scene, folder / "a b.gltf", {true, false}, {.overwrite = true}, folder / "c d.gltf");

  // In another folder the buffers come along, also where nothing goes.
  std::filesystem::create_directory(folder / "sub");
  stripScene(scene, folder / "a b.gltf", {true, true}, {}, folder / "sub/x.gltf");
  EXPECT_EQ(cornersOf(loadScene(folder / "sub/x.gltf")), cornersOf(scene));
}

TEST(StripGltf, DataUrisStayDataUris) {
  const GltfFile file = squareFile<uint16_t>(5123);
  const Scene scene = loadText("a.gltf", file.gltf());
  const StrippedText left = stripText("a.gltf", file.gltf(), {false, true});
  EXPECT_EQ(cornersOf(left.scene), cornersOf(scene, {false, true}));
  const std::string uri = json::parse(left.text)["buffers"][0]["uri"];
  EXPECT_TRUE(uri.starts_with("data:application/octet-stream;base64,"));
}

/// What loads is stripped, too: words in the place of numbers stay where nothing changes.
TEST(StripGltf, KeepsWordsInThePlaceOfNumbers) {
  GltfFile file = squareFile<uint16_t>(5123);
  file.document["extras"] = {{"bound", "WORD"}, {"text", "is \"NaN, \\"}};
  std::string text = file.gltf();
  for (const char* word : {"NaN", "-Infinity", "nan(ind)", "1.#QNAN"}) {
    std::string odd = text;
    odd.replace(odd.find("\"WORD\""), 6, word);
    for (const bool compact : {false, true}) {
      const StrippedText left = stripText("a.gltf", odd, {false, true}, {.compact = compact});
      EXPECT_EQ(left.scene.triangleCount(), 1u);
      EXPECT_EQ(left.scene.warnings.size(), 1u);
      const std::string expected = "\"bound\":" + std::string(word) + ',';
      EXPECT_NE(left.text.find(expected), std::string::npos) << left.text;
    }
  }
}

/// Changes, adds or takes out something somewhere in the document.
void mutate(json& value, StripRandom& random) {
  if ((value.is_object() || value.is_array()) && !value.empty() && random() % 8 != 0) {
    auto at = value.begin();
    std::advance(at, random() % value.size());
    if (random() % 12 == 0) {
      value.erase(at);
    } else {
      mutate(*at, random);
    }
    return;
  }
  const json others[] = {0,
                         1,
                         2,
                         3,
                         5,
                         255,
                         5121,
                         5126,
                         -1,
                         0.5,
                         "x",
                         nullptr,
                         json::array(),
                         json::object(),
                         {{"extensions", {{"A_b", 1}}}},
                         {0, 1}};
  value = others[random() % std::size(others)];
}

TEST(Strip, DamagedDocumentsAreErrorsOrStripped) {
  StripRandom random(8);
  int stripped = 0, refused = 0;
  for (int round = 0; round < 400; ++round) {
    GltfFile file = round % 3 == 0 ? posedFile() : round % 3 == 1 ? richFile() : randomFile(random);
    file.document["animations"] = {
        {{"samplers", {{{"input", 0}, {"output", 1}}}},
         {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}}}};
    if (round % 2 == 0) file.document["buffers"] = {{{"byteLength", file.bin.size()}}};
    for (uint32_t i = 0; i <= random() % 3; ++i) {
      auto at = file.document.begin();
      std::advance(at, random() % file.document.size());
      mutate(*at, random);
    }
    const std::string glb = file.glb();
    std::optional<Scene> scene;
    try {
      scene = loadText("a.glb", glb);
    } catch (const Error&) {
      continue;
    }
    try {
      const std::vector<bool> seen = randomBits(scene->triangleCount(), random, 4);
      const StrippedText left = stripText("a.glb", glb, seen, {.compact = round % 2 == 0});
      ASSERT_GE(left.scene.triangleCount(), 1u);
      ++stripped;
    } catch (const Error& error) {
      ASSERT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      ++refused;
    }
  }
  EXPECT_GT(stripped, 50);
  EXPECT_LT(refused, stripped / 4);
}

TEST(Strip, RefusesWhatWouldNotBeAScene) {
  EXPECT_EQ(errorOf([] { stripText("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", {false}); }),
            "a.obj: no triangle of it is seen, so nothing would be left; check the cells");
  const Folder folder;
  const auto file = folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const Scene scene = loadScene(file, {.faces = true});
  EXPECT_EQ(errorOf([&] { stripScene(scene, file, {true}, {}, folder / "b.glb"); }),
            "b.glb: must end with .obj, as the scene does: a stripped scene stays of its kind");
}

}  // namespace
}  // namespace sightline
