#include <fmt/format.h>
#include <gtest/gtest.h>

#include <bit>
#include <cfloat>
#include <charconv>
#include <clocale>
#include <cmath>
#include <random>

#include "core/formats/load_scene.h"
#include "core/io/decimal.h"
#include "core/scene/scene.h"
#include "tests/scene/files.h"

namespace sightline {
namespace {

using test::expectValid;
using test::loadError;
using test::loadText;

const std::string kObjSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST(LoadObj, TrianglesAndObjects) {
  const Scene scene = loadText("a.obj", "# a comment\nmtllib none.mtl\n" + kObjSquare +
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

TEST(LoadObj, CommentsAreNotContinued) {
  const Scene scene =
      loadText("a.obj", kObjSquare + "f 1 2 3 # C:\\\nf 1 3 4\nf 2 \\\n3 4 # D:\\\nf 1 2 4\n");
  EXPECT_EQ(scene.triangles, (std::vector<glm::uvec3>{{0, 1, 2}, {0, 2, 3}, {1, 2, 3}, {0, 1, 3}}));
}

TEST(LoadObj, ByteOrderMarkIsSkipped) {
  const Scene scene = loadText("a.obj", "\xef\xbb\xbf" + kObjSquare + "f 1 2 3\n");
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
      {kObjSquare + "\nf 1 2 5\n", "a.obj:6: vertex index 5 is out of range 1..4; --repair drops the face"},
      {kObjSquare + "f 1 2 \\\n 3\nf 1 2 0\n",
       "a.obj:7: vertex index 0 is out of range 1..4; --repair drops the face"},
      {kObjSquare + "f 1 -5 3\n", "a.obj:5: vertex index 0 is out of range 1..4; --repair drops the face"},
      {kObjSquare + "f 4294967297 2 3\n",
       "a.obj:5: vertex index 4294967297 is out of range 1..4; --repair drops the face"},
      {kObjSquare + "f 99999999999999999999/1 2 3\n",
       "a.obj:5: vertex index 4611686018427387904 is out of range 1..4; --repair drops the face"},
      {kObjSquare + "f\n", "a.obj:5: face has 0 vertices, needs at least 3; --repair drops it"},
      {kObjSquare + "f 1 2\n", "a.obj:5: face has 2 vertices, needs at least 3; --repair drops it"},
      {"f 1 2 3\n", "a.obj:1: face without any vertex in the file"},
      {kObjSquare + "f 1 2 3\nv\n", "a.obj:6: expected three numbers after \"v\""},
      {kObjSquare + "f 1 \\\n 5 2\n\nf 1 2 6\nv 0 0 0\n",
       "a.obj:8: vertex index 6 is out of range 1..5; --repair drops the face"},
      {"v 0 0\n", "a.obj:1: expected three numbers after \"v\""},
      {"v 0 0,5 1\n",
       "a.obj:1: expected three numbers after \"v\", with decimal points, and found \"0,5\"; replace commas "
       "by "
       "points"},
      {"v 0 0 0\n v 0 nan 0\nf 1 1 2\n",
       "a.obj:2: vertex (0, nan, 0) is not finite; --repair drops its triangles"},
      {"v 0 0 0\nv 0 -inf 0\nf 2 1 1\n",
       "a.obj:2: vertex (0, -inf, 0) is not finite; --repair drops its triangles"},
      {"v 0 1e12 0\nv 0 1e13 0\nf 1 2 1\n",
       "a.obj:2: vertex (0, 10000000000000, 0) is farther than 2^40 from the origin, too far to trace: scale "
       "the scene; --repair drops its triangles"},
      {"v 0 1e39 0\nf 1 1 1\n", "a.obj:1: vertex (0, inf, 0) is not finite; --repair drops its triangles"},
      {kObjSquare, "a.obj: holds no triangles"},
      {"", "a.obj: is empty"},
      {"no obj at all",
       "a.obj: holds no triangles; statements not understood, not read: 1, the first in line 1 (\"no\")"},
  };
  for (const auto& [text, message] : cases) EXPECT_EQ(loadError("a.obj", text), message) << text;
}

TEST(LoadObj, CornersAreReadWholeOrNotAtAll) {
  SceneLoadOptions repair;
  repair.repair = true;
  for (const std::string corner : {"1,001",
                                   "1.5",
                                   "1.0",
                                   "1e0",
                                   "1;",
                                   "1x",
                                   "x",
                                   "0x1",
                                   "/",
                                   "/1",
                                   "-",
                                   "+",
                                   "+-1",
                                   "--1",
                                   "1/2x",
                                   "1/2,5",
                                   "1/x",
                                   "1//x",
                                   "1/1/1/1",
                                   "1/1/1/",
                                   "1///1",
                                   "\"1\"",
                                   "1/1//1",
                                   "1\v",
                                   "\xc2\xa0"
                                   "1"}) {
    for (const std::string& face :
         {"f " + corner + " 2 3\n", "f 1 2 3 " + corner + "\n", "fo 1\t" + corner + " 3\n"}) {
      const std::string text = kObjSquare + "# here\n" + face + "f 2 3 4\n";
      const std::string error = loadError("a.obj", text);
      EXPECT_EQ(error.find("a.obj:6: expected a vertex number (7, 7/1, 7//3 or 7/1/3) and found \""), 0u)
          << face << error;
      const Scene scene = loadText("a.obj", text, repair);
      EXPECT_EQ(scene.triangles, (std::vector<glm::uvec3>{{1, 2, 3}})) << face;
      EXPECT_GT(scene.repaired_triangles, 0u);
    }
  }
  EXPECT_EQ(loadError("a.obj", kObjSquare + "f 1 1,001 3\n"),
            "a.obj:5: expected a vertex number (7, 7/1, 7//3 or 7/1/3) and found \"1,001\"; --repair drops "
            "the face");
  const Scene scene =
      loadText("a.obj", kObjSquare + "f +1 2/ 3//\nf 1/1 2/-7/+7 3/1/\nf\t-4/99999999999999999999 2  3 \t\n");
  EXPECT_EQ(scene.triangles, (std::vector<glm::uvec3>{{0, 1, 2}, {0, 1, 2}, {0, 1, 2}}));
}

TEST(LoadObj, OldKeywordForFaces) {
  const Scene scene = loadText("a.obj", kObjSquare + "f 1 2 3\nfo 1//1 3//1 4//1\n  fo 2 \\\n 3 4 # c\n");
  EXPECT_EQ(scene.triangles, (std::vector<glm::uvec3>{{0, 1, 2}, {0, 2, 3}, {1, 2, 3}}));
  EXPECT_TRUE(scene.warnings.empty());
}

TEST(LoadObj, SaysWhatItDoesNotRead) {
  const std::string head = kObjSquare + "f 1 2 3\n";
  EXPECT_TRUE(loadText("a.obj", head +
                                    "p 1\nl 1 2\nvt 0 0\nvn 0 0 1\nvp 0\ns 1\ncstype bezier\ncurv 0 1 1 2\n"
                                    "parm u 0 1\nend\n# x\n\n   \nmg off\nlod 1\n")
                  .warnings.empty());
  EXPECT_EQ(
      loadText("a.obj", head + "F 1 3 4\nsurf 0 1 0 1 1 2 3 4\nend\nbzp 1 2 3 4\ncall other.obj\n").warnings,
      (std::vector<std::string>{"free-form surfaces, not read: 2, the first in line 7; export polygons",
                                "statements not understood, not read: 2, the first in line 6 (\"F\")"}));
  EXPECT_EQ(
      loadError("a.obj", kObjSquare + "surf 0 1 0 1 1 2 3 4\n"),
      "a.obj: holds no triangles; free-form surfaces, not read: 1, the first in line 5; export polygons");
}

TEST(LoadObj, CountsGlass) {
  const test::Folder folder;
  folder.write(
      "m.mtl",
      "newmtl clear\nKd 1 1 1\nd 0.5\nnewmtl wall\nd 1\nTr 1\nnewmtl tr\nTr 0.25\nnewmtl solid\nTr 0\n"
      "newmtl halo\nd -halo 0.9\nnewmtl leaf\nd 1.0\nmap_d leaf.png\nnewmtl odd\nd\nTr x\n");
  folder.write("two words.mtl", "# c\r\nnewmtl two words\r\nd 0 \r\n");
  const auto load = [&](const std::string& text) {
    return loadScene(folder.write("a.obj", kObjSquare + text));
  };
  const std::pair<std::string, uint64_t> cases[] = {{"clear", 3}, {"wall", 0}, {"tr", 3},  {"solid", 0},
                                                    {"halo", 3},  {"leaf", 3}, {"odd", 0}, {"none", 0}};
  for (const auto& [name, count] : cases) {
    const std::string use = "f 1 2 3\nusemtl " + name + " \nf 1 2 3 4\ng x\nfo 1 2 3\nusemtl wall\nf 1 2 3\n";
    for (const std::string& text :
         {"mtllib m.mtl\n" + use, use + "mtllib  .\\m.mtl \n", "mtllib m.mtl m.mtl\n" + use}) {
      const Scene scene = load(text);
      EXPECT_EQ(scene.glass_triangles, count) << text;
      EXPECT_TRUE(scene.warnings.empty());
    }
  }
  const Scene both =
      load("mtllib two words.mtl\nmtllib m.mtl\nusemtl two words\nf 1 2 3\nusemtl tr\nf 1 2 5\nv 9 9 9\n");
  EXPECT_EQ(both.glass_triangles, 2u);
  EXPECT_TRUE(both.warnings.empty());
  EXPECT_TRUE(load("mtllib no.mtl\nf 1 2 3\n").warnings.empty());  // no material is used
  const Scene missing = load("mtllib no.mtl m.mtl\nusemtl tr\nf 1 2 3\n");
  EXPECT_EQ(missing.glass_triangles, 1u);
  EXPECT_EQ(
      missing.warnings,
      (std::vector<std::string>{(folder / "no.mtl").string() +
                                ": cannot open: No such file or directory; its materials count as opaque"}));
}

TEST(LoadObj, WarningsAreCleanWhateverTheFileNames) {
  const Scene scene = loadText("a.obj", "mtllib m\x1b\x80.mtl\n" + kObjSquare + "usemtl a\nf 1 2 3\n");
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_NE(scene.warnings[0].find("/m__.mtl: cannot open"), std::string::npos) << scene.warnings[0];
}

TEST(LoadObj, MaterialsOutsideTheFolderAreNotRead) {
  const test::Folder folder;
  std::filesystem::create_directories(folder / "scene/sub");
  const std::string outside = folder.write("m.mtl", "newmtl a\nd 0\n").string();
  folder.write("scene/in.mtl", "newmtl a\nd 0\n");
  const auto load = [&](const std::string& library) {
    return loadScene(
        folder.write("scene/a.obj", "mtllib " + library + "\n" + kObjSquare + "usemtl a\nf 1 2 3\n"));
  };
  for (const std::string& library :
       {std::string("../m.mtl"), std::string("..\\m.mtl"), std::string("sub/../../m.mtl"), outside}) {
    const Scene scene = load(library);
    EXPECT_EQ(scene.glass_triangles, 0u) << library;
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_NE(scene.warnings[0].find(
                  "lies outside of the scene's folder (--allow-external); its materials count as opaque"),
              std::string::npos)
        << scene.warnings[0];
  }
  EXPECT_EQ(load("sub/../in.mtl").glass_triangles, 1u);
}

TEST(TakeDecimal, RoundsTheTextToEitherPrecision) {
  std::mt19937_64 random(11);
  for (int round = 0; round < 200'000; ++round) {
    // Half of them next to the middle between two floats, where rounding twice goes wrong.
    const float low = std::bit_cast<float>(uint32_t(random() % 0x7f000000u) | uint32_t(random() % 2) << 31);
    const double middle = (double(low) + double(std::nextafter(low, 2 * low))) / 2;
    std::string text =
        fmt::format("{:.{}e}", round % 2 == 0 ? middle : double(low) * 1.1, int(random() % 40));
    if (round % 4 == 0 && text.find('.') != std::string::npos)
      text.insert(text.find('e'), std::string(random() % 3, '0') + std::to_string(random() % 2));
    std::string_view rest = text;
    const std::optional<Decimal> value = takeDecimal(rest);
    ASSERT_TRUE(value) << text;
    float single = 0;
    double full = 0;
    std::from_chars(text.data(), text.data() + text.size(), single);
    std::from_chars(text.data(), text.data() + text.size(), full);
    ASSERT_EQ(value->single, single) << text;
    ASSERT_EQ(value->full, full) << text;
    ASSERT_TRUE(rest.empty());
  }
}

TEST(LoadObj, RepairDropsAndCounts) {
  SceneLoadOptions repair;
  repair.repair = true;
  const Scene scene =
      loadText("a.obj", kObjSquare + "v nan 0 0\nf 1 2 3\nf 1 2 5\nf 1 2 3 99\nf 1 2\nf 2 3 4\n", repair);
  expectValid(scene);
  EXPECT_EQ(scene.triangles, (std::vector<glm::uvec3>{{0, 1, 2}, {1, 2, 3}}));
  EXPECT_EQ(scene.repaired_triangles, 4u);
  EXPECT_EQ(loadError("a.obj", kObjSquare + "f 1 2 9\n", repair),
            "a.obj: no triangle is left; all 1 were dropped as bad");
}

TEST(LoadObj, CountsDegenerateTriangles) {
  const Scene scene = loadText("a.obj", kObjSquare + "v 2 0 0\nf 1 1 2\nf 1 2 5\nf 1 2 3\n");
  EXPECT_EQ(scene.triangles.size(), 3u);
  EXPECT_EQ(scene.degenerate_triangles, 2u);
}

TEST(LoadObj, NamesBecomeCleanUtf8) {
  const Scene scene = loadText("a.obj", kObjSquare + "o b\xe4u\x01 \xc3\xa4\tx\nf 1 2 3\n");
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
  EXPECT_EQ(error("a.fbx"), "a.fbx: unknown extension \".fbx\", expected .obj, .gltf, .glb, .ply or .b3dm");
  folder.write("A.OBJ", kObjSquare + "f 1 2 3\n");
  EXPECT_EQ(loadScene(folder / "A.OBJ").triangles.size(), 1u);
}

TEST(SceneBounds, CoverUsedVerticesOnly) {
  const Scene scene = loadText("a.obj", "v 9 9 9\nv -1 0 0\nv 1 0 2\nv 1 -3 0\nf 2 3 4\n");
  const Bounds bounds = sceneBounds(scene);
  EXPECT_EQ(bounds.low, glm::vec3(-1, -3, 0));
  EXPECT_EQ(bounds.high, glm::vec3(1, 0, 2));
}

TEST(HashScene, DependsOnPositionsAndTrianglesOnly) {
  const Scene scene = loadText("a.obj", kObjSquare + "f 1 2 3\nf 1 3 4\n");
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
