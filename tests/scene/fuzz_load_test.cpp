// Damaged files: whatever the bytes, loading gives a valid Scene or one Error.
#include <gtest/gtest.h>

#include <random>

#include "core/cell/view_cell.h"
#include "core/formats/cells_file.h"
#include "core/formats/load_scene.h"
#include "core/scene/scene.h"
#include "tests/scene/files.h"
#include "tests/scene/gltf_files.h"

namespace sightline {
namespace {

using test::json;

/// A small valid file.
struct Sample {
  std::string name;
  std::string bytes;
};

std::string binaryPly(bool big_endian) {
  std::string bytes = std::string("ply\nformat binary_") + (big_endian ? "big" : "little") +
                      "_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty uchar z\n"
                      "element face 2\nproperty list uchar ushort vertex_indices\n"
                      "element tristrips 1\nproperty list int int vertex_indices\nend_header\n";
  for (int i = 0; i < 4; ++i) bytes.append(8, char(i)) += char(i * i);
  const auto number = [&](int value, int size) {
    for (int i = 0; i < size; ++i) bytes += (big_endian ? i == size - 1 : i == 0) ? char(value) : '\0';
  };
  for (const int last : {2, 3}) {
    bytes += char(3);
    for (const int corner : {0, last - 1, last}) number(corner, 2);
  }
  for (const int value : {4, 0, 1, 2, 3}) number(value, 4);
  return bytes;
}

std::vector<Sample> samples() {
  return {
      {"a.obj",
       "# c\nmtllib m.mtl\nv 0 0 0\nv 1.5e0 0 -0.25 # c\r\nv 1 1 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\no a\ng b c\n"
       "usemtl m\nf 1/1/1 2//1 3/1\nf -4 -3 \\\n -2 -1\ns off\nfo 1 2 3\nsurf 0 1 0 1 1 2 3\nend\n"},
      {"a.ply",
       "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty double y\nproperty int z\n"
       "element face 2\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0.5 0\n1 1 0\n-1 1e1 0\n"
       "3 0 1 2\n4 0 1 2 3\n"},
      {"l.ply", binaryPly(false)},
      {"b.ply", binaryPly(true)},
      {"a.glb", test::squareFile<uint8_t>(5121).glb()},
      {"r.glb", test::richFile().glb()},
      {"t.glb", test::compressedSquare(false).glb()},
      {"i.glb", test::compressedSquare(true).glb()},
      {"r.gltf", test::richFile().gltf()},
      {"p.glb", test::posedFile().glb()},
      {"p.gltf", test::posedFile().gltf()},
  };
}

/// Loads bytes as a file of the sample's kind, into the same file each time.
class Loader {
 public:
  /// True if it gave a scene, false for an Error; fails the test for anything else.
  bool load(const std::string& name, const std::string& bytes, bool repair) {
    const auto file = folder_.write(name, bytes);
    try {
      SceneLoadOptions options;
      options.repair = repair;
      test::expectValid(loadScene(file, options));
      return true;
    } catch (const Error& error) {
      const std::string line = error.what();
      EXPECT_EQ(line.find('\n'), std::string::npos) << line;
      EXPECT_EQ(line.find(file.string()), 0u) << line;
    }
    return false;
  }

 private:
  test::Folder folder_;
};

TEST(FuzzLoad, SamplesAreValid) {
  Loader loader;
  for (const Sample& sample : samples())
    EXPECT_TRUE(loader.load(sample.name, sample.bytes, false)) << sample.name;
}

TEST(FuzzLoad, TruncatedAtEveryLength) {
  Loader loader;
  for (const Sample& sample : samples()) {
    for (size_t length = 0; length < sample.bytes.size(); ++length) {
      SCOPED_TRACE(sample.name + " cut to " + std::to_string(length));
      const bool loaded = loader.load(sample.name, sample.bytes.substr(0, length), length % 2 == 0);
      EXPECT_FALSE(loaded && sample.name.ends_with(".glb"));  // its header knows the length
      if (testing::Test::HasFailure()) return;
    }
  }
}

TEST(FuzzLoad, MutatedBytes) {
  constexpr uint64_t kSeed = 42;
  constexpr int kRounds = 2500;
  std::mt19937_64 random(kSeed);
  Loader loader;
  int loaded = 0;
  for (const Sample& sample : samples()) {
    for (int round = 0; round < kRounds; ++round) {
      std::string bytes = sample.bytes;
      for (uint64_t changes = 1 + random() % 4; changes > 0; --changes) {
        const size_t at = random() % bytes.size();
        switch (random() % 5) {
          case 0:
            bytes[at] = char(random());
            break;
          case 1:
            bytes[at] = "0123456789-.e/ \n\"{}[],"[random() % 23];
            break;
          case 2:
            bytes[at] = char(bytes[at] ^ (1 << random() % 8));
            break;
          case 3:
            bytes.erase(at, 1 + random() % 3);
            break;
          default:
            bytes.insert(at, bytes.substr(random() % bytes.size(), 1 + random() % 8));
        }
        if (bytes.empty()) bytes.push_back(char(random()));
      }
      SCOPED_TRACE(sample.name + " seed " + std::to_string(kSeed) + " round " + std::to_string(round) +
                   " bytes as base64: " + test::encodeBase64(bytes));
      loaded += loader.load(sample.name, bytes, round % 2 == 0) ? 1 : 0;
      if (testing::Test::HasFailure()) return;
    }
  }
  EXPECT_GT(loaded, 1000);  // else the mutations never reach behind the first checks
}

/// Replaces one value somewhere in the document by another.
void mutate(json& value, std::mt19937_64& random) {
  if (value.is_structured() && !value.empty() && random() % 16 != 0) {
    auto child = value.begin();
    std::advance(child, std::ptrdiff_t(random() % value.size()));
    return mutate(*child, random);
  }
  const json replacements[] = {0,
                               1,
                               2,
                               3,
                               4,
                               5,
                               8,
                               12,
                               255,
                               65536,
                               -1,
                               1e30,
                               4294967295,
                               {},
                               true,
                               false,
                               0.5,
                               "VEC3",
                               "ATTRIBUTES",
                               "INDICES",
                               5121,
                               5123,
                               5125,
                               5126,
                               json::array(),
                               json::object(),
                               18446744073709551615ull,
                               9223372036854775807ll,
                               json::array({0, 0, 1}),
                               "data:;base64,AAAA",
                               1e-300,
                               6,
                               7,
                               16};
  value = replacements[random() % std::size(replacements)];
}

TEST(FuzzLoad, MutatedGltfDocuments) {
  constexpr uint64_t kSeed = 43;
  constexpr int kRounds = 5000;
  std::mt19937_64 random(kSeed);
  const test::GltfFile files[] = {test::squareFile<uint16_t>(5123), test::richFile(), test::posedFile(),
                                  test::compressedSquare(false), test::compressedSquare(true)};
  Loader loader;
  int loaded = 0;
  for (const test::GltfFile& file : files) {
    for (int round = 0; round < kRounds; ++round) {
      test::GltfFile bad = file;
      bad.document["buffers"] = json::array({{{"byteLength", bad.bin.size()}}, {{"byteLength", 1 << 20}}});
      for (uint64_t changes = 1 + random() % 2; changes > 0; --changes) mutate(bad.document, random);
      SCOPED_TRACE("seed " + std::to_string(kSeed) + " round " + std::to_string(round) + " " +
                   bad.document.dump());
      const std::string bytes = bad.document.is_object() ? bad.glb() : bad.document.dump();
      loaded += loader.load("a.glb", bytes, round % 2 == 0) ? 1 : 0;
      if (testing::Test::HasFailure()) return;
    }
  }
  EXPECT_GT(loaded, 500);
}

TEST(FuzzLoad, MutatedMaterials) {
  constexpr uint64_t kSeed = 45;
  constexpr int kRounds = 2000;
  const std::string good = "newmtl a\nd -halo 0.5\nTr 0.5\n\nnewmtl b c\nmap_d -s 1 1 1 x.png\nKd 1 0 0\n";
  std::mt19937_64 random(kSeed);
  const test::Folder folder;
  const auto scene = folder.write(
      "a.obj",
      "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\nusemtl b c\nf 1 2 3\nusemtl d\nf 1 2 3\n");
  for (int round = 0; round < kRounds + int(good.size()); ++round) {
    std::string bytes = good.substr(0, size_t(round) < good.size() ? size_t(round) : good.size());
    if (round >= int(good.size())) bytes[random() % bytes.size()] = char(random());
    SCOPED_TRACE("seed " + std::to_string(kSeed) + " round " + std::to_string(round) + " " +
                 test::encodeBase64(bytes));
    folder.write("a.mtl", bytes);
    const Scene loaded = loadScene(scene);
    ASSERT_EQ(loaded.triangles.size(), 3u);
    ASSERT_LE(loaded.glass_triangles, 2u);
    ASSERT_TRUE(bytes.empty() || loaded.warnings.empty());
  }
}

TEST(FuzzLoad, MutatedCells) {
  constexpr uint64_t kSeed = 44;
  constexpr int kRounds = 3000;
  const std::string good =
      R"({"cells":[{"name":"a","center":[1,2.5,-3],"size":[4,5,6],"rotation":[7,8,9]},{"name":"b","center":[0,0,0],"size":[1,1,0]}]})";
  std::mt19937_64 random(kSeed);
  const test::Folder folder;
  for (int round = 0; round < kRounds + int(good.size()); ++round) {
    std::string bytes = good.substr(0, size_t(round) < good.size() ? size_t(round) : good.size());
    if (round >= int(good.size())) {
      json document = json::parse(good);
      mutate(document, random);
      bytes = round % 2 == 0 ? document.dump() : good;
      if (round % 2 != 0) bytes[random() % bytes.size()] = char(random());
    }
    SCOPED_TRACE("seed " + std::to_string(kSeed) + " round " + std::to_string(round) + " " + bytes);
    try {
      for (const ViewCell& cell : loadCells(folder.write("c.json", bytes))) {
        ASSERT_FALSE(cellFaces(cell).empty());
        for (const Face& face : cellFaces(cell)) {
          ASSERT_TRUE(std::isfinite(face.corner.x + face.edge_u.x + face.edge_v.x));
          ASSERT_GT(glm::length(glm::dvec4(face.edge_u)), 0.0);
        }
      }
    } catch (const Error& error) {
      ASSERT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace sightline
