#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/formats/load_scene.h"
#include "core/scene/scene.h"
#include "tests/scene/files.h"

namespace sightline {
namespace {

using test::expectValid;
using test::loadError;
using test::loadText;

const std::string kPlyVertices =
    "ply\nformat ascii 1.0\ncomment made by hand\nobj_info none\nelement vertex 4\nproperty uchar red\n"
    "property float x\nproperty float y\nproperty list uchar int tags\nproperty double z\n";
const std::string kRows = "7 0 0 1 5 0\n7 1 0 0 0\n7 1 1 2 1 2 0\n7 0 1 0 0.1\n";
const std::string kFace = "property list uchar int vertex_indices\n";

/// The ASCII file above with these faces.
std::string asciiFile(int faces, const std::string& rows) {
  return kPlyVertices + "element face " + std::to_string(faces) + "\n" + kFace + "end_header\n" + kRows +
         rows;
}

/// Appends a value's bytes in one of the two orders.
template <typename T>
void put(std::string& bytes, T value, bool big_endian) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  if (big_endian) std::reverse(raw, raw + sizeof(T));
  bytes.append(raw, sizeof(T));
}

std::string binaryFile(bool big_endian, float third_x = 1.0f, int last_index = 3) {
  std::string bytes =
      std::string("ply\nformat binary_") + (big_endian ? "big" : "little") +
      "_endian 1.0\nelement camera 1\nproperty short id\nelement vertex 4\nproperty double x\n"
      "property float y\nproperty int8 z\nelement face 2\nproperty uint8 material\n"
      "property list uint16 uint32 vertex_index\nproperty list char float weights\nend_header\n";
  put<int16_t>(bytes, 99, big_endian);
  const float xy[4][2] = {{0, 0}, {1, 0}, {third_x, 1}, {0.1f, 1}};
  for (int i = 0; i < 4; ++i) {
    put<double>(bytes, xy[i][0], big_endian);
    put<float>(bytes, xy[i][1], big_endian);
    put<int8_t>(bytes, int8_t(-i), big_endian);
  }
  for (int face = 0; face < 2; ++face) {
    put<uint8_t>(bytes, 5, big_endian);
    put<uint16_t>(bytes, uint16_t(face == 0 ? 3 : 4), big_endian);
    for (int i = 0; i < 3 + face; ++i) put<uint32_t>(bytes, uint32_t(i == 3 ? last_index : i), big_endian);
    put<int8_t>(bytes, 1, big_endian);
    put<float>(bytes, 0.5f, big_endian);
  }
  return bytes;
}

TEST(LoadPly, Ascii) {
  const std::string text = asciiFile(2, "3 0 1 2\n4 0 1 2 3");
  std::string crlf;
  for (const char c : text) {
    if (c == '\n') crlf += '\r';
    crlf += c;
  }
  for (const std::string& file : {text, crlf}) {
    const Scene scene = loadText("bunny.ply", file);
    expectValid(scene);
    EXPECT_EQ(scene.positions, (std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0.1f}}));
    EXPECT_EQ(scene.triangles, (std::vector<glm::uvec3>{{0, 1, 2}, {0, 1, 2}, {0, 2, 3}}));
    ASSERT_EQ(scene.objects.size(), 1u);
    EXPECT_EQ(scene.objects[0].name, "bunny");
  }
}

TEST(LoadPly, BinaryInBothByteOrders) {
  for (const bool big_endian : {false, true}) {
    const Scene scene = loadText("a.ply", binaryFile(big_endian));
    expectValid(scene);
    EXPECT_EQ(scene.positions, (std::vector<glm::vec3>{{0, 0, 0}, {1, 0, -1}, {1, 1, -2}, {0.1f, 1, -3}}));
    EXPECT_EQ(scene.triangles, (std::vector<glm::uvec3>{{0, 1, 2}, {0, 1, 2}, {0, 2, 3}}));
  }
}

TEST(LoadPly, TriangleStrips) {
  const std::string text =
      kPlyVertices + "element tristrips 1\n" + kFace + "end_header\n" + kRows + "8 0 1 2 3 -1 1 2 3\n";
  const Scene scene = loadText("a.ply", text);
  expectValid(scene);
  EXPECT_EQ(scene.triangles, (std::vector<glm::uvec3>{{0, 1, 2}, {2, 1, 3}, {1, 2, 3}}));
}

TEST(LoadPly, ErrorsNameElementAndRow) {
  const std::string head = "ply\nformat ascii 1.0\n";
  const std::pair<std::string, std::string> cases[] = {
      {"plx\n", "a.ply:1: expected \"ply\""},
      {"ply\n", "a.ply:2: the header is cut off, \"end_header\" is missing"},
      {"ply\nformat asci 1.0\n", "a.ply:2: expected format ascii, binary_little_endian or binary_big_endian"},
      {"ply\nformat ascii 2.0\n", "a.ply:2: expected format version 1.0"},
      {head + "element vertex -1\n", "a.ply:3: expected a whole number of rows"},
      {head + "property float x\n", "a.ply:3: property before any element"},
      {head + "element vertex 1\nproperty real x\n", "a.ply:4: unknown type"},
      {head + "element vertex 1\nproperty list float int x\n", "a.ply:4: a list's size needs a whole type"},
      {head + "element vertex 1\nproperty int x\nproperty int x\n",
       "a.ply:5: the element has a property of that name"},
      {head + "elemen vertex 1\n", "a.ply:3: expected comment, obj_info, element, property or end_header"},
      {head + "element vertex 1\nproperty float x\nproperty float y\nend_header\n1 2\n",
       "a.ply: element vertex has no property z"},
      {head + "element face 1\n" + kFace + "end_header\n3 0 1 2\n", "a.ply: has faces, but no vertices"},
      {kPlyVertices + "element face 1\nproperty int x\nend_header\n" + kRows + "1\n",
       "a.ply: element face has no list vertex_indices"},
      {asciiFile(2, "3 0 1 2\n3 0 1 4\n"),
       "a.ply: element face, row 1: vertex index 4 is out of range 0..3; --repair drops the face"},
      {asciiFile(1, "3 0 1 -1\n"),
       "a.ply: element face, row 0: vertex index -1 is out of range 0..3; --repair drops the face"},
      {asciiFile(1, "2 0 1\n"),
       "a.ply: element face, row 0: face has 2 vertices, needs at least 3; --repair drops it"},
      {asciiFile(2, "3 0 1 2\n3 0 1 x\n"),
       "a.ply: element face, row 1: property vertex_indices: expected a number"},
      {asciiFile(2, "3 0 1 2\n3 0 1 "),
       "a.ply: element face, row 1: property vertex_indices: the file ends here; is it truncated? --repair "
       "keeps the "
       "faces before"},
      {asciiFile(2, "3 0 1 2\n"),
       "a.ply: element face, row 1: property vertex_indices: the file ends here; is it truncated? --repair "
       "keeps the "
       "faces before"},
      {asciiFile(1, "200 0 1 2\n"),
       "a.ply: element face, row 0: property vertex_indices: a list of 200 values does not fit the 7 bytes "
       "left"},
      {asciiFile(1, "-3 0 1 2\n"),
       "a.ply: element face, row 0: property vertex_indices: a list of -3 values does not fit the 7 bytes "
       "left"},
      {asciiFile(0, ""), "a.ply: holds no triangles"},
      {binaryFile(false, NAN),
       "a.ply: element vertex, row 2: vertex (nan, 1, -2) is not finite; --repair drops "
       "its triangles"},
      {binaryFile(true, 1.0f, -1),
       "a.ply: element face, row 1: vertex index 4294967295 is out of range 0..3; "
       "--repair drops the face"},
      {head + "element vertex 4000000000\nproperty float x\nproperty float y\nproperty float "
              "z\nend_header\n1 2 3\n",
       "a.ply: element vertex, row 1: property x: the file ends here; is it truncated?"},
  };
  for (const auto& [text, message] : cases) EXPECT_EQ(loadError("a.ply", text), message) << text;
}

TEST(LoadPly, RepairDropsAndCounts) {
  SceneLoadOptions repair;
  repair.repair = true;
  const Scene scene = loadText("a.ply", asciiFile(4, "3 0 1 2\n4 0 1 2 9\n2 0 1\n3 1 2 3\n"), repair);
  expectValid(scene);
  EXPECT_EQ(scene.triangles, (std::vector<glm::uvec3>{{0, 1, 2}, {1, 2, 3}}));
  EXPECT_EQ(scene.repaired_triangles, 3u);
}

TEST(LoadPly, FacesBeforeTheirVertices) {
  const std::string head = "ply\nformat ascii 1.0\nelement face 2\n" + kFace;
  const std::string vertices = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string rows = "3 0 1 2\n3 2 1 0\n", corners = "0 0 0\n1 0 0\n0 1 0\n";
  const Scene scene = loadText("a.ply", head + vertices + "end_header\n" + rows + corners);
  expectValid(scene);
  EXPECT_EQ(scene.triangles, (std::vector<glm::uvec3>{{0, 1, 2}, {2, 1, 0}}));
  // More faces behind them: ids follow the file's order.
  const Scene both = loadText("a.ply", head + vertices + "element tristrips 1\n" + kFace + "end_header\n" +
                                           rows + corners + "3 1 2 0\n");
  EXPECT_EQ(both.triangles, (std::vector<glm::uvec3>{{0, 1, 2}, {2, 1, 0}, {1, 2, 0}}));
  EXPECT_EQ(loadError("a.ply", head + vertices + "end_header\n3 0 1 3\n3 0 1 2\n" + corners),
            "a.ply: element face, row 0: vertex index 3 is out of range 0..2; --repair drops the face");
  EXPECT_EQ(loadError("a.ply", head + vertices + "end_header\n3 0 1 2\n", {.repair = true}),
            "a.ply: element face, row 1: property vertex_indices: the file ends here; is it truncated? "
            "--repair keeps "
            "the faces before");
}

TEST(LoadPly, RepairKeepsTheFacesThatAreThere) {
  for (const std::string& rows :
       {std::string("3 0 1 2\n3 1 2 3\n"), std::string("3 0 1 2\n3 1 2 3\n3 0 1 ")}) {
    const Scene scene = loadText("a.ply", asciiFile(7, rows), {.repair = true});
    expectValid(scene);
    EXPECT_EQ(scene.triangles, (std::vector<glm::uvec3>{{0, 1, 2}, {1, 2, 3}}));
    EXPECT_EQ(scene.warnings, std::vector<std::string>{"the header promises 7 faces, the file ends after 2"});
  }
  const std::string whole = binaryFile(false, 1.0f);
  for (size_t cut = 1; cut < 8; ++cut) {
    EXPECT_NE(loadError("a.ply", whole.substr(0, whole.size() - cut)).find("element face, row 1"),
              std::string::npos);
    EXPECT_EQ(loadText("a.ply", whole.substr(0, whole.size() - cut), {.repair = true}).triangles.size(), 1u);
  }
}

TEST(LoadPly, NamesWithControlCharactersDoNotReachTheTerminal) {
  EXPECT_EQ(
      loadError("a.ply", "ply\nformat ascii 1.0\nelement a\x1b[2J\a 1\nproperty int p\x7f\nend_header\n?\n"),
      "a.ply: element a_[2J_, row 0: property p_: expected a number");
}

}  // namespace
}  // namespace sightline
