#include <gtest/gtest.h>

#include <cfloat>
#include <clocale>

#include "core/scene/scene.h"
#include "tests/scene/files.h"

namespace sightline {
namespace {

using test::expectValid;
using test::loadError;
using test::loadText;

const std::string kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST(LoadObj, TrianglesAndObjects) {
  const Scene scene = loadText("a.obj", "# a comment\nmtllib none.mtl\n" + kSquare +
                                            "vt 0 0\nvn 0 0 1\nf 1 2 3\n"
                                            "o house\nusemtl brick\nf 1/1 2/1 3/1\nf 1//1 3//1 4//1\n"
                                            "g  walls north \nf 1/1/1 2/1/1 3/1/1 4/1/1\n"
                                            "o tree\ng tree\ns off\nf -4 -3 -2\ng empty\ng \nf 2 3 4");
  expectValid(scene);
  const std::vector<glm::uvec3> expected = {{0, 1, 2}, {0, 1, 2}, {0, 2, 3}, {0, 1, 2},
                                            {0, 2, 3}, {0, 1, 2}, {1, 2, 3}};
  EXPECT_EQ(scene.triangles, expected);
  ASSERT_EQ(scene.objects.size(), 5u);
  EXPECT_EQ(scene.objects[0].name, "default");
  EXPECT_EQ(scene.objects[1].name, "house");
  EXPECT_EQ(scene.objects[1].triangle_count, 2u);
  EXPECT_EQ(scene.objects[2].name, "house/walls north");
  EXPECT_EQ(scene.objects[3].name, "tree");
  EXPECT_EQ(scene.objects[4].name, "tree");
}

TEST(LoadObj, CoordinatesAreCorrectlyRounded) {
  const Scene scene = loadText("a.obj",
                               "v 0.1 +0.2 -.3 1.0\nv 1e-50 1.0995116e12 1.17549435E-38\n"
                               "v 16777217 0.30000001192092896 1.00000005960464477539062500001\nf 1 2 3\n");
  EXPECT_EQ(scene.positions[0], glm::vec3(0.1f, 0.2f, -0.3f));
  EXPECT_EQ(scene.positions[1], glm::vec3(0.0f, kLargestCoordinate, FLT_MIN));
  EXPECT_EQ(scene.positions[2], glm::vec3(16777216.0f, 0.3f, 1.00000012f));
}

TEST(LoadObj, LineEndsContinuationsAndComments) {
  const std::string lf =
      "v 0 0 0\nv 1 0 0 # second\nv 1 1 0\nv 0 1 0\nf 1 2 \\\n 3 # cut\no name\nf 1 \\\n3 \\\n4\n";
  std::string crlf;
  std::string cr;
  for (const char c : lf) {
    if (c == '\n') crlf += '\r';
    crlf += c;
    cr += c == '\n' ? '\r' : c;
  }
  for (const std::string& text : {lf, crlf, cr}) {
    const Scene scene = loadText("a.obj", text);
    EXPECT_EQ(scene.triangles, (std::vector<glm::uvec3>{{0, 1, 2}, {0, 2, 3}}));
    ASSERT_EQ(scene.objects.size(), 2u);
    EXPECT_EQ(scene.objects[1].name, "name");
  }
}

TEST(LoadObj, ByteOrderMarkIsSkipped) {
  const Scene scene = loadText("a.obj", "\xef\xbb\xbf" + kSquare + "f 1 2 3\n");
  ASSERT_EQ(scene.positions.size(), 4u);
  EXPECT_EQ(scene.triangles, (std::vector<glm::uvec3>{{0, 1, 2}}));
}

TEST(LoadObj, FacesMayStandBeforeTheirVertices) {
  const Scene scene =
      loadText("a.obj", "v 9 9 9\no first\nf 2 3 4\nv 0 0 0\nv 1 0 0\nv 1 1 0\no second\nf -1 -2 1\n");
  expectValid(scene);
  EXPECT_EQ(scene.triangles, (std::vector<glm::uvec3>{{1, 2, 3}, {3, 2, 0}}));
  EXPECT_EQ(scene.objects[1].name, "second");
}

TEST(LoadObj, ErrorsNameTheLine) {
  const std::pair<std::string, std::string> cases[] = {
      {kSquare + "\nf 1 2 5\n", "a.obj:6: vertex index 5 is out of range 1..4; --repair drops the face"},
      {kSquare + "f 1 2 \\\n 3\nf 1 2 0\n",
       "a.obj:7: vertex index 0 is out of range 1..4; --repair drops the face"},
      {kSquare + "f 1 -5 3\n", "a.obj:5: vertex index 0 is out of range 1..4; --repair drops the face"},
      {kSquare + "f 1 x 3\n", "a.obj:5: vertex index 0 is out of range 1..4; --repair drops the face"},
      {kSquare + "f 4294967297 2 3\n",
       "a.obj:5: vertex index 4294967297 is out of range 1..4; --repair drops the face"},
      {kSquare + "f 99999999999999999999/1 2 3\n",
       "a.obj:5: vertex index 4611686018427387904 is out of range 1..4; --repair drops the face"},
      {kSquare + "f 1 2\n", "a.obj:5: face has 2 vertices, needs at least 3; --repair drops it"},
      {"f 1 2 3\n", "a.obj:1: face without any vertex in the file"},
      {"v 0 0\n", "a.obj:1: expected three numbers after \"v\""},
      {"v 0 0,5 1\n", "a.obj:1: expected three numbers after \"v\""},
      {"v 0 0 0\n v 0 nan 0\n", "a.obj:2: vertex (0, nan, 0) is not finite; --repair drops its triangles"},
      {"v 0 0 0\nv 0 -inf 0\n", "a.obj:2: vertex (0, -inf, 0) is not finite; --repair drops its triangles"},
      {"v 0 1e12 0\nv 0 1e13 0\n",
       "a.obj:2: vertex (0, 10000000000000, 0) is farther than 2^40 from the origin, too far to trace: scale the "
       "scene; "
       "--repair drops its triangles"},
      {"v 0 1e39 0\n", "a.obj:1: vertex (0, inf, 0) is not finite; --repair drops its triangles"},
      {kSquare, "a.obj: holds no triangles"},
      {"", "a.obj: is empty"},
      {"no obj at all", "a.obj: holds no triangles"},
  };
  for (const auto& [text, message] : cases) EXPECT_EQ(loadError("a.obj", text), message) << text;
}

TEST(LoadObj, RepairDropsAndCounts) {
  SceneLoadOptions repair;
  repair.repair = true;
  const Scene scene =
      loadText("a.obj", kSquare + "v nan 0 0\nf 1 2 3\nf 1 2 5\nf 1 2 3 99\nf 1 2\nf 2 3 4\n", repair);
  expectValid(scene);
  EXPECT_EQ(scene.triangles, (std::vector<glm::uvec3>{{0, 1, 2}, {1, 2, 3}}));
  EXPECT_EQ(scene.repaired_triangles, 4u);
  EXPECT_EQ(loadError("a.obj", kSquare + "f 1 2 9\n", repair),
            "a.obj: no triangle is left; all 1 were dropped as bad");
}

TEST(LoadObj, CountsDegenerateTriangles) {
  const Scene scene = loadText("a.obj", kSquare + "v 2 0 0\nf 1 1 2\nf 1 2 5\nf 1 2 3\n");
  EXPECT_EQ(scene.triangles.size(), 3u);
  EXPECT_EQ(scene.degenerate_triangles, 2u);
}

TEST(LoadObj, NamesBecomeCleanUtf8) {
  const Scene scene = loadText("a.obj", kSquare + "o b\xe4u\x01 \xc3\xa4\tx\nf 1 2 3\n");
  EXPECT_EQ(scene.objects[0].name, "b_u_ \xc3\xa4 x");
}

TEST(LoadScene, FileErrors) {
  const test::Folder folder;
  const auto error = [&](const std::string& name) {
    return test::errorOf([&] { loadScene(folder / name); });
  };
  EXPECT_EQ(error("no.obj"), "no.obj: cannot open: No such file or directory");
  std::filesystem::create_directory(folder / "dir.obj");
  EXPECT_EQ(error("dir.obj"), "dir.obj: is a directory, not a file");
  folder.write("a.fbx", "x");
  EXPECT_EQ(error("a.fbx"), "a.fbx: unknown extension \".fbx\", expected .obj, .gltf, .glb or .ply");
  folder.write("A.OBJ", kSquare + "f 1 2 3\n");
  EXPECT_EQ(loadScene(folder / "A.OBJ").triangles.size(), 1u);
}

TEST(SceneBounds, CoverUsedVerticesOnly) {
  const Scene scene = loadText("a.obj", "v 9 9 9\nv -1 0 0\nv 1 0 2\nv 1 -3 0\nf 2 3 4\n");
  const Bounds bounds = sceneBounds(scene);
  EXPECT_EQ(bounds.low, glm::vec3(-1, -3, 0));
  EXPECT_EQ(bounds.high, glm::vec3(1, 0, 2));
}

TEST(HashScene, DependsOnPositionsAndTrianglesOnly) {
  const Scene scene = loadText("a.obj", kSquare + "f 1 2 3\nf 1 3 4\n");
  Scene other = scene;
  other.objects[0].name = "renamed";
  EXPECT_EQ(hashScene(other), hashScene(scene));
  other.positions[3].z = 0x1p-149f;
  EXPECT_NE(hashScene(other), hashScene(scene));
  other = scene;
  std::swap(other.triangles[1].x, other.triangles[1].y);
  EXPECT_NE(hashScene(other), hashScene(scene));
}

}  // namespace
}  // namespace sightline
