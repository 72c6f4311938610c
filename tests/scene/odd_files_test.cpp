// Files as careless writers, downloads and version control leave them: a row a kind, and what is right for
// it.
#include <gtest/gtest.h>

#include <cmath>

#include "core/formats/load_scene.h"
#include "tests/scene/files.h"
#include "tests/scene/gltf_files.h"

namespace sightline {
namespace {

using test::GltfFile;
using test::json;
using test::loadError;
using test::loadText;
using test::squareFile;

const std::string kSquareObj = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
const std::string kSquarePly =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 2\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n"
    "3 0 1 2\n3 0 2 3\n";

GltfFile square() {
  return squareFile<uint16_t>(5123);
}

std::string changed(const std::function<void(json&)>& change) {
  GltfFile file = square();
  change(file.document);
  return file.gltf();
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return at == std::string::npos ? text : text.replace(at, what.size(), by);
}

std::string glbWithWord(size_t offset, uint32_t value) {
  std::string bytes = square().glb();
  bytes.replace(offset, 4, reinterpret_cast<const char*>(&value), 4);
  return bytes;
}

/// ASCII text in UTF-16 with its mark.
std::string utf16(const std::string& text, bool big_endian) {
  std::string bytes = big_endian ? "\xfe\xff" : "\xff\xfe";
  for (const char c : text) bytes += big_endian ? std::string{'\0', c} : std::string{c, '\0'};
  return bytes;
}

/// A kind of file that holds the square, or a part of it.
struct Odd {
  const char* name;  ///< of the file
  std::string bytes;
  uint32_t triangles = 2;
  std::string warning = {};  ///< empty: none
};

void PrintTo(const Odd& odd, std::ostream* stream) {
  *stream << odd.name << " " << odd.bytes.substr(0, 60);
}

std::vector<Odd> oddFilesThatLoad() {
  const std::string gltf = square().gltf(), glb = square().glb();
  const auto binAt = uint32_t(glb.size() - square().bin.size() - 4);  // the type of the second chunk
  std::string broken_lines;
  for (size_t i = 0; i < gltf.size(); ++i) {
    broken_lines += gltf[i];
    if (i > gltf.find("base64,") + 7 && i < gltf.find('"', gltf.find("base64,")) && i % 16 == 0)
      broken_lines += "\\n";
  }
  std::vector<Odd> files = {
      {"a.obj", kSquareObj + "fo 1 2 3\nf 1 3 4\n"},
      {"a.obj", kSquareObj + "v nan nan nan\nv 1.#QNAN 1.#IND00 -1.#INF\nf 1 2 3\nf 1 3 4\n"},
      {"a.obj", utf16(kSquareObj + "f 1 2 3 4\n", false)},
      {"a.obj", utf16(kSquareObj + "f 1 2 3 4\n", true)},
      {"a.ply", utf16(kSquarePly, false)},
      {"a.ply", "\xef\xbb\xbf" + kSquarePly},
      {"a.obj", kSquarePly},
      {"a.gltf", glb},
      {"a.glb", gltf},
      {"a.vrm", glb},
      {"a", kSquarePly},
      {"a.gltf", "\xef\xbb\xbf \n" + gltf},
      {"a.glb", glbWithWord(8, 0), 2, "the GLB header says 0 bytes; all of the file's are read"},
      {"a.glb", glbWithWord(binAt, 1), 2,
       "no GLB chunk is marked as binary; the second is read as if it were"},
      {"a.gltf", changed([](json& d) {
         d["nodes"][0]["rotation"] = {0, 0, 0, 0};
       }),
       2, "nodes whose rotation is a quaternion of zeros, not turned: 1"},
      {"a.gltf", changed([](json& d) {
         d["nodes"][0]["name"] = nullptr;
         d["meshes"][0]["name"] = nullptr;
         d["nodes"][0]["extensions"] = nullptr;
         d["materials"] = nullptr;
       })},
      {"a.gltf", broken_lines},
      {"a.gltf", changed([](json& d) { d["scene"] = 0; })},
      {"a.ply", replaced(kSquarePly, "element", "Created by Blender3D 247 - www.blender.org\nelement")},
  };
  GltfFile padded = square();
  padded.document["buffers"] = {
      {{"byteLength", padded.bin.size() + 100},
       {"uri", "data:application/octet-stream;base64," + test::encodeBase64(padded.bin)}}};
  files.push_back({"a.gltf", padded.document.dump()});
  for (const char* word : {"NaN", "nan", "-NaN", "-Infinity", "Infinity", "inf", "-inf", "nan(ind)",
                           "-nan(ind)", "1.#QNAN", "-1.#IND"}) {
    const std::string text = changed([](json& d) {
      d["accessors"][0]["min"] = {"WORD", 0, 0};
      d["accessors"][0]["name"] = "is \"NaN, \\";
    });
    files.push_back(
        {"a.gltf", replaced(text, "\"WORD\"", word), 2, "words in the place of numbers (NaN), not read: 1"});
  }
  for (const char* extension : {"EXT_mesh_features",
                                "EXT_structural_metadata",
                                "EXT_instance_features",
                                "KHR_interactivity",
                                "KHR_audio_emitter",
                                "KHR_physics_rigid_bodies",
                                "VRMC_vrm",
                                "GODOT_single_root",
                                "MOZ_lightmap",
                                "CESIUM_primitive_outline",
                                "FB_ngon_encoding",
                                "EXT_mesh_manifold",
                                "KHR_materials_unlit",
                                "KHR_texture_transform",
                                "KHR_meshopt_compression",
                                "EXT_meshopt_compression",
                                "MSFT_lod",
                                "EXT_mesh_gpu_instancing",
                                "KHR_draco_mesh_compression",
                                "KHR_node_visibility"}) {
    files.push_back({"a.gltf", changed([&](json& d) { d["extensionsRequired"] = {extension}; })});
  }
  // Draco beside plain data.
  files.push_back({"a.gltf", changed([](json& d) {
                     d["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] = {
                         {"bufferView", 0}, {"attributes", {{"POSITION", 0}}}};
                   })});
  return files;
}

TEST(OddFiles, Load) {
  for (const Odd& odd : oddFilesThatLoad()) {
    SCOPED_TRACE(testing::PrintToString(odd));
    Scene scene;
    ASSERT_NO_THROW(scene = loadText(odd.name, odd.bytes));
    test::expectValid(scene);
    EXPECT_EQ(scene.triangles.size(), odd.triangles);
    EXPECT_EQ(std::vector<glm::vec3>(scene.positions.begin(), scene.positions.begin() + 4),
              test::squareCorners());
    EXPECT_EQ(scene.triangles, (std::vector<glm::uvec3>{{0, 1, 2}, {0, 2, 3}}));
    EXPECT_EQ(scene.warnings,
              odd.warning.empty() ? std::vector<std::string>() : std::vector<std::string>{odd.warning});
  }
}

TEST(OddFiles, SayWhatTheyAre) {
  using namespace std::string_literals;
  const std::pair<std::string, std::string> cases[] = {
      {"\x1f\x8b\x08", "is packed by gzip; unpack it (gunzip)"},
      {"PK\x03\x04zip", "is a ZIP archive; unpack it and give the scene in it"},
      {"\x64\x86\x03\0\0\0"s,
       "is an object file of a compiler (COFF), not Wavefront OBJ; export the scene under another name"},
      {"\x4c\x01\x03\0"s,
       "is an object file of a compiler (COFF), not Wavefront OBJ; export the scene under another name"},
      {"version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 1\n",
       "is a pointer of Git LFS, not the scene itself; fetch that (git lfs pull)"},
      {"\n<!DOCTYPE HTML>\n<html></html>",
       "is a web page (HTML), not a scene; a download gave the page about the file, or an error: fetch the "
       "file "
       "itself"},
      {"<html>",
       "is a web page (HTML), not a scene; a download gave the page about the file, or an error: fetch "
       "the file itself"},
      {"<?xml version=\"1.0\"?><COLLADA/>",
       "is XML (Collada, X3D or another), which is not read; export or convert it to glTF"},
      {"Kaydara FBX Binary  \0"s, "is FBX, which is not read; export or convert it to glTF"},
      {"DRACO\2\2", "is a bare Draco stream; put it into glTF (KHR_draco_mesh_compression)"},
      {"cmpt\1\0\0\0"s, "is a 3D Tile of a kind that is not read; only b3dm is, or convert it to glTF"},
      {"\xff\xfe\0\0v\0\0\0"s, "is text in UTF-32; save it as UTF-8"},
      {"", "is empty"},
  };
  for (const auto& [bytes, message] : cases) {
    for (const char* name : {"a.obj", "a.gltf", "a.glb", "a.ply"}) {
      EXPECT_EQ(loadError(name, bytes), name + (": " + message));
    }
  }
}

TEST(OddFiles, UnknownRequiredExtensionsAreLeftOutIfAsked) {
  const std::string text = changed([](json& d) { d["extensionsRequired"] = {"ACME_a", "ACME_b"}; });
  const auto refused = [](const std::string& name) {
    return "a.gltf: extensionsRequired: \"" + name +
           "\" is unknown; convert the file without it, or load it without what it adds (--ignore-extension)";
  };
  EXPECT_EQ(loadError("a.gltf", text), refused("ACME_a"));
  EXPECT_EQ(loadError("a.gltf", text, {.ignored_extensions = {"ACME_a"}}), refused("ACME_b"));
  EXPECT_EQ(loadError("a.gltf", text, {.ignored_extensions = {"ACME_"}}), refused("ACME_a"));
  EXPECT_EQ(loadText("a.gltf", text, {.ignored_extensions = {"ACME_b", "ACME_a"}}).triangles.size(), 2u);
}

TEST(OddFiles, RawNamesOfBuffers) {
  const test::Folder folder;
  const GltfFile file = square();
  std::filesystem::create_directories(folder / "a dir");
  for (const char* name : {"100%.bin", "a dir/\xc3\xa4 100%.bin", "%zz", "a%41.bin"}) {
    folder.write(name, file.bin);
    EXPECT_EQ(loadScene(folder.write("a.gltf", file.gltf(name))).triangles.size(), 2u) << name;
    std::filesystem::remove(folder / name);
  }
  folder.write("aA.bin", file.bin);
  folder.write("a%41.bin", "no");
  EXPECT_EQ(loadScene(folder.write("a.gltf", file.gltf("a%41.bin"))).triangles.size(), 2u) << "decoded first";
}

TEST(OddFiles, BuffersElsewhereOnlyIfAllowed) {
  const test::Folder folder;
  const GltfFile file = square();
  std::filesystem::create_directories(folder / "scene");
  const std::string outside = folder.write("b.bin", file.bin).string();
  std::filesystem::create_symlink("../b.bin", folder / "scene/link.bin");
  std::filesystem::create_directory_symlink("..", folder / "scene/up");
  folder.write("scene/in.bin", file.bin);
  std::filesystem::create_symlink("in.bin", folder / "scene/near.bin");
  std::filesystem::create_directory_symlink("scene", folder / "alias");
  const auto load = [&](const char* place, const std::string& uri, bool allow) {
    return loadScene(folder.write(std::string(place) + "/a.gltf", file.gltf(uri)), {.allow_external = allow});
  };
  for (const std::string& uri :
       {std::string("../b.bin"), outside, std::string("link.bin"), std::string("up/b.bin")}) {
    EXPECT_NE(test::errorOf([&] { load("scene", uri, false); }).find("lies outside of the scene's folder"),
              std::string::npos)
        << uri;
    EXPECT_EQ(load("scene", uri, true).triangles.size(), 2u) << uri;
  }
  for (const char* place : {"scene", "alias"}) {
    EXPECT_EQ(load(place, "in.bin", false).triangles.size(), 2u);
    EXPECT_EQ(load(place, "near.bin", false).triangles.size(), 2u);
  }
}

std::string tile(const std::string& table, const std::string& binary, const std::string& glb) {
  std::string bytes = "b3dm";
  const auto word = [&](size_t value) {
    const auto little = uint32_t(value);
    bytes.append(reinterpret_cast<const char*>(&little), 4);
  };
  word(1);
  word(28 + table.size() + binary.size() + 4 + glb.size());
  word(table.size());
  word(binary.size());
  word(2);
  word(2);
  return bytes + table + binary + "{}??" + glb;
}

TEST(OddFiles, TilesStandAroundTheirCenter) {
  // y up in the glTF, z up in the tile.
  const glm::dvec3 center(1215013.25, -4736316.5, 4081608.75);
  const std::string glb = square().glb();
  const glm::vec3 rounded(center);
  const std::string numbers = R"({"BATCH_LENGTH":0,"RTC_CENTER":[1215013.25,-4736316.5,4081608.75]})";
  const std::string bytes = test::bytesOf(std::vector<glm::vec3>{glm::vec3(7), rounded});
  for (const std::string& file :
       {tile(numbers, "", glb), tile(R"({"RTC_CENTER":{"byteOffset":12}})", bytes, glb)}) {
    const Scene scene = loadText("a.b3dm", file);
    EXPECT_NE(scene.offset, glm::dvec3(0));
    ASSERT_EQ(scene.positions.size(), 4u);
    const glm::dvec3 middle = file.find("1215013.25") != std::string::npos ? center : glm::dvec3(rounded);
    for (size_t i = 0; i < 4; ++i) {
      const glm::vec3 corner = test::squareCorners()[i];
      EXPECT_EQ(glm::dvec3(scene.positions[i]) + scene.offset,
                middle + glm::dvec3(corner.x, -corner.z, corner.y));
    }
  }
  // CESIUM_RTC says the same of a glTF alone, whose y stays up.
  GltfFile rtc = square();
  rtc.document["extensionsRequired"] = {"CESIUM_RTC"};
  rtc.document["extensions"]["CESIUM_RTC"]["center"] = {center.x, center.y, center.z};
  const Scene upright = loadText("a.glb", rtc.glb());
  EXPECT_EQ(glm::dvec3(upright.positions[2]) + upright.offset,
            glm::dvec3(center.x + 1, center.z + 1, -center.y));
  const Scene both = loadText("a.b3dm", tile("", "", rtc.glb()));
  EXPECT_EQ(glm::dvec3(both.positions[2]) + both.offset, center + glm::dvec3(1, 0, 1));
  const Scene plain = loadText("a.b3dm", tile("", "", glb));
  EXPECT_EQ(plain.positions[2], glm::vec3(1, 0, 1));
  EXPECT_EQ(plain.offset, glm::dvec3(0));
}

TEST(OddFiles, TilesOfOldVersions) {
  const std::string glb = square().glb();
  const auto words = [](const std::vector<uint32_t>& values) { return test::bytesOf(values); };
  const auto size = uint32_t(glb.size());
  // Batches, length of the batch table; length of the batch table, of its binary part, batches.
  for (const std::string& file :
       {"b3dm" + words({1, 22 + size, 5, 2}) + "{}" + glb, "b3dm" + words({1, 20 + size, 5, 0}) + glb,
        "b3dm" + words({1, 27 + size, 2, 1, 5}) + "{}?" + glb,
        "b3dm" + words({1, 24 + size, 0, 0, 5}) + glb}) {
    EXPECT_EQ(loadText("a.b3dm", file).positions[2], glm::vec3(1, 0, 1)) << file.substr(0, 30);
  }
}

TEST(OddFiles, DamagedTiles) {
  const std::string good = tile(R"({"RTC_CENTER":[1,2,3]})", "", square().glb());
  EXPECT_EQ(loadText("a.b3dm", good).triangles.size(), 2u);
  EXPECT_EQ(loadError("a.b3dm", good.substr(0, 20)), "a.b3dm: the tile's header is cut off");
  EXPECT_EQ(loadError("a.b3dm", good.substr(0, good.size() - 1)).find("a.b3dm: the header says"), 0u);
  const auto with = [&](size_t offset, uint32_t value) {
    std::string bytes = good;
    bytes.replace(offset, 4, reinterpret_cast<const char*>(&value), 4);
    return loadError("a.b3dm", bytes);
  };
  EXPECT_EQ(with(4, 2), "a.b3dm: b3dm version 2, only 1 is supported");
  EXPECT_NE(with(12, 0xfffffff0).find("is cut off after"), std::string::npos);
  EXPECT_EQ(loadError("a.b3dm", tile(R"({"RTC_CENTER":[1,2]})", "", square().glb())),
            "a.b3dm: feature table: RTC_CENTER: expected 3 numbers");
  EXPECT_EQ(loadError("a.b3dm", tile(R"({"RTC_CENTER":{"byteOffset":1}})", "????????????", square().glb())),
            "a.b3dm: feature table: RTC_CENTER.byteOffset: lies outside of the binary table");
}

}  // namespace
}  // namespace sightline
