// Scenes whose detail single precision does not hold where they are: read less an offset, and the warning
// where that does not help, with its count, against brute force.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "core/api/bake.h"
#include "core/formats/load_scene.h"
#include "core/formats/save_scene.h"
#include "core/generate/generate.h"
#include "core/pvs/visible_from.h"
#include "core/scene/scene.h"
#include "tests/scene/files.h"
#include "tests/scene/gltf_files.h"
#include "tests/support/make_cell.h"

namespace sightline {
namespace {

using test::loadText;

constexpr int kCells = 40;

/// A rough ground of kCells x kCells squares, 0.1 wide, as a file of two decimals would have it.
struct Ground {
  std::vector<glm::dvec3> corners;
  std::vector<glm::uvec3> triangles;
};

Ground ground(const glm::dvec3& offset) {
  Ground result;
  for (int y = 0; y <= kCells; ++y) {
    for (int x = 0; x <= kCells; ++x) {
      const glm::dvec3 p(x / 10.0, y / 10.0, ((x * 7 + x % 3 * y) % 5) / 100.0);
      const std::string text =
          fmt::format("{:.2f} {:.2f} {:.2f}", offset.x + p.x, offset.y + p.y, offset.z + p.z);
      glm::dvec3 corner;
      std::sscanf(text.c_str(), "%lf %lf %lf", &corner.x, &corner.y, &corner.z);
      result.corners.push_back(corner);
    }
  }
  for (uint32_t y = 0; y < kCells; ++y) {
    for (uint32_t x = 0; x < kCells; ++x) {
      const uint32_t a = y * (kCells + 1) + x, b = a + 1, c = a + kCells + 1, d = c + 1;
      result.triangles.push_back({a, b, d});
      result.triangles.push_back({a, d, c});
    }
  }
  return result;
}

/// Through memory: GCC 12 takes double -> float -> double for no conversion at all (see CMakeLists.txt).
glm::vec3 rounded(const glm::dvec3& p) {
  volatile float x = float(p.x), y = float(p.y), z = float(p.z);
  return {x, y, z};
}

/// "of N triangles A lose their area by that and B turn by more than 30 degrees": by brute force.
std::string lossOf(const Ground& ground) {
  const auto normal = [](const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    return glm::cross(b - a, c - a);
  };
  uint64_t collapsed = 0, turned = 0;
  for (const glm::uvec3& t : ground.triangles) {
    const glm::dvec3 a = ground.corners[t.x], b = ground.corners[t.y], c = ground.corners[t.z];
    const glm::dvec3 was = normal(a, b, c), now = normal(rounded(a), rounded(b), rounded(c));
    const double turn = std::acos(glm::dot(glm::normalize(was), glm::normalize(now)));
    if (now == glm::dvec3(0)) {
      ++collapsed;
    } else if (turn > std::acos(-1.0) / 6) {
      ++turned;
    }
  }
  return fmt::format("of {} triangles {} lose their area by that and {} turn by more than 30 degrees",
                     ground.triangles.size(), collapsed, turned);
}

std::string asObj(const Ground& ground) {
  std::string text;
  for (const glm::dvec3& p : ground.corners) text += fmt::format("v {:.2f} {:.2f} {:.2f}\n", p.x, p.y, p.z);
  for (const glm::uvec3& t : ground.triangles) text += fmt::format("f {} {} {}\n", t.x + 1, t.y + 1, t.z + 1);
  return text;
}

std::string asPly(const Ground& ground, bool binary) {
  std::string text = fmt::format(
      "ply\nformat {} 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double "
      "z\nelement face {}\n"
      "property list uchar uint vertex_indices\nend_header\n",
      binary ? "binary_little_endian" : "ascii", ground.corners.size(), ground.triangles.size());
  const auto put = [&](const auto& value) {
    text.append(reinterpret_cast<const char*>(&value), sizeof(value));
  };
  for (const glm::dvec3& p : ground.corners) {
    if (binary) {
      put(p);
    } else {
      text += fmt::format("{:.2f} {:.2f} {:.2f}\n", p.x, p.y, p.z);
    }
  }
  for (const glm::uvec3& t : ground.triangles) {
    if (binary) {
      text += char(3);
      put(t);
    } else {
      text += fmt::format("3 {} {} {}\n", t.x, t.y, t.z);
    }
  }
  return text;
}

/// Corners near the origin, and a node that moves them.
std::string asGlb(const Ground& local, const glm::dvec3& offset) {
  test::GltfFile file;
  std::vector<glm::vec3> corners;
  for (const glm::dvec3& p : local.corners) corners.push_back(rounded(p));
  const size_t positions = file.addPositions(corners);
  const size_t indices = file.addAccessor(file.addView(test::bytesOf(local.triangles)), 5125,
                                          local.triangles.size() * 3, "SCALAR");
  file.addMesh(positions, int64_t(indices));
  file.document["nodes"][0]["translation"] = {offset.x, offset.y, offset.z};
  return file.glb();
}

const glm::dvec3 kUtm(500000, 4649776, 35);

std::string warningOf(const Scene& scene) {
  EXPECT_LE(scene.warnings.size(), 1u);
  return scene.warnings.empty() ? "" : scene.warnings[0];
}

/// The positions are those of the ground less the offset, each rounded once.
void expectLess(const Scene& scene, const Ground& ground, const glm::dvec3& offset) {
  EXPECT_EQ(scene.offset, offset);
  ASSERT_EQ(scene.positions.size(), ground.corners.size());
  for (size_t i = 0; i < ground.corners.size(); ++i) {
    ASSERT_EQ(scene.positions[i], rounded(ground.corners[i] - offset)) << i;
  }
  EXPECT_EQ(scene.triangles, ground.triangles);
  EXPECT_EQ(warningOf(scene), "");
  EXPECT_EQ(scene.degenerate_triangles, 0u);
}

TEST(FarCoordinates, LoseNothing) {
  const glm::dvec3 mercator(-8237642, 0, 4970241);
  for (const auto& [place, offset] : {std::pair(kUtm, glm::dvec3(500002, 4649778, 35)),
                                      std::pair(mercator, glm::dvec3(-8237640, 0, 4970241))}) {
    const Ground far = ground(place);
    expectLess(loadText("a.obj", asObj(far)), far, offset);
    expectLess(loadText("a.ply", asPly(far, false)), far, offset);
    expectLess(loadText("a.ply", asPly(far, true)), far, offset);
    // Corners that are floats themselves, and a node that takes them away.
    Ground moved = ground(glm::dvec3(0));
    for (glm::dvec3& p : moved.corners) p = glm::dvec3(rounded(p)) + place;
    expectLess(loadText("a.glb", asGlb(ground(glm::dvec3(0)), place)), moved, offset);
  }
}

TEST(FarCoordinates, ConcavePolygonsAreCutByTheirTrueShape) {
  // An arrowhead of a tenth of a unit, which floats collapse there, among triangles that show the scale.
  const auto text = [](const glm::dvec3& offset) {
    std::string file = asObj(ground(offset));
    for (const glm::dvec2& p : {glm::dvec2(0.0, 0.0), {0.1, 0.01}, {0.0, 0.02}, {0.08, 0.01}}) {
      file += fmt::format("v {:.2f} {:.2f} {:.2f}\n", offset.x + p.x, offset.y + p.y, offset.z);
    }
    return file + "f -4 -3 -2 -1\n";
  };
  const Scene near = loadText("a.obj", text(glm::dvec3(0)));
  EXPECT_EQ(near.offset, glm::dvec3(0));
  EXPECT_EQ(loadText("a.obj", text(kUtm)).triangles, near.triangles);
}

TEST(FarCoordinates, OnlyAxesThatNeedItAreMoved) {
  // 4 km off along x, edges are bent a little.
  const Ground far = ground({4000, 0, 0});
  const Scene scene = loadText("a.obj", asObj(far));
  expectLess(scene, far, {4002, 0, 0});
  // A file of floats was bent before; so far, and said.
  const Scene floats = loadText("a.glb", asGlb(far, glm::dvec3(0)));
  EXPECT_EQ(floats.offset, glm::dvec3(4002, 0, 0));
  EXPECT_EQ(warningOf(floats),
            "the file has its coordinates in single precision, which steps by 0.000244 at 4004, and the "
            "median edge "
            "is 0.102: its triangles were bent before they came here; export it from nearer to the origin");
}

TEST(FarCoordinates, HashesDiffer) {
  // The same triangles a whole number of units apart: equal but for where they are.
  Scene a = loadText("a.obj", asObj(ground(kUtm)));
  const uint64_t hash = hashScene(a);
  a.offset += 1.0;
  EXPECT_NE(hashScene(a), hash);
}

TEST(FarCoordinates, SavedScenesComeBack) {
  const test::Folder folder;
  const Ground far = ground(kUtm);
  const Scene scene = loadText("a.obj", asObj(far));
  saveScene(scene, folder / "a.glb");
  const Scene glb = loadScene(folder / "a.glb");
  EXPECT_EQ(hashScene(glb), hashScene(scene));
  saveScene(scene, folder / "b.obj");
  const Scene obj = loadScene(folder / "b.obj");
  EXPECT_EQ(obj.offset, scene.offset);
  ASSERT_EQ(obj.positions.size(), scene.positions.size());
  const double step = 0x1p-30;  // of a double at 4,649,778
  for (size_t i = 0; i < obj.positions.size(); ++i) {
    const glm::dvec3 off = glm::abs(glm::dvec3(obj.positions[i]) - glm::dvec3(scene.positions[i]));
    ASSERT_LE(std::max({off.x, off.y, off.z}), step) << i;
  }
}

TEST(FarCoordinates, SetsAreThoseNearTheOrigin) {
  // A high wall through the squares of column 20; a cell well above either half sees that half and the wall.
  const auto text = [](const glm::dvec3& at) {
    std::string wall;
    for (const glm::dvec2& p : {glm::dvec2(-30, -5), {34, -5}, {34, 30}, {-30, 30}}) {
      wall += fmt::format("v {:.2f} {:.2f} {:.2f}\n", at.x + 2.05, at.y + p.x, at.z + p.y);
    }
    return asObj(ground(at)) + wall + "f -4 -3 -2 -1\n";
  };
  std::vector<ViewCell> cells = {testing_support::makeCell({0, 2, 4}, {1, 1, 0.5}),
                                 testing_support::makeCell({4, 2, 4}, {1, 1, 0.5})};
  cells[1].name = "other";
  std::vector<std::vector<uint32_t>> expected(2);
  for (uint32_t id = 0; id < 2 * kCells * kCells; ++id) {
    const uint32_t column = id / 2 % kCells;
    if (column <= 20) expected[0].push_back(id);
    if (column >= 20) expected[1].push_back(id);
  }
  for (auto& set : expected) set.insert(set.end(), {3200, 3201});
  BakeParams params;
  params.n_rand = 200'000;
  params.validation_rays = 0;
  for (const glm::dvec3& place : {glm::dvec3(0), kUtm, glm::dvec3(-8237642, 35, 4970241)}) {
    Session session(loadText("a.obj", text(place)), {.device = "cpu"});
    EXPECT_EQ(session.scene().offset != glm::dvec3(0), place != glm::dvec3(0));
    const PvsFile pvs = bake(session, moved(cells, place), params);
    EXPECT_EQ(pvs.offset, session.scene().offset);
    ASSERT_EQ(pvs.cells.size(), cells.size());
    for (size_t i = 0; i < cells.size(); ++i) {
      EXPECT_EQ(pvs.cells[i].triangles, expected[i]) << i << " at " << place.x;
      const auto visible = visibleFrom(pvs, place + cells[i].center);
      ASSERT_TRUE(visible);
      EXPECT_EQ(visible->data(), pvs.cells[i].triangles.data());
    }
    EXPECT_FALSE(visibleFrom(pvs, place + glm::dvec3(50)));
  }
}

TEST(PrecisionWarning, CountsWhatWideScenesLose) {
  // A ground at UTM, and something at the origin: no offset serves both.
  const Ground far = ground(kUtm);
  EXPECT_EQ(lossOf(far),
            "of 3200 triangles 864 lose their area by that and 1696 turn by more than 30 degrees");
  const Scene scene = loadText("a.obj", asObj(far) + "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\n");
  EXPECT_EQ(scene.offset, glm::dvec3(0));
  EXPECT_EQ(warningOf(scene),
            "single precision steps by 0.5 at coordinates of 4649780, and the median edge is 0.102; of 3201 "
            "triangles 864 lose their area by that and 0 turn by more than 30 degrees; the scene is too wide "
            "for its "
            "detail: cut it into parts");
}

TEST(PrecisionWarning, WideScenesWithFineDetail) {
  // Around the origin, but with a speck that floats do not hold 10 km away.
  const std::string text =
      asObj(ground(glm::dvec3(0))) +
      "v -10000 0 0\nv 9999.9999 0 0\nv 10000.0001 0 0\nv 10000 0.0002 0\nf 1 2 -4\nf -3 -2 -1\n";
  EXPECT_EQ(
      warningOf(loadText("a.obj", text)),
      "single precision steps by 0.000977 at coordinates of 10000, and the median edge is 0.102; of 3202 "
      "triangles 1 lose their area by that and 0 turn by more than 30 degrees; the scene is too wide for its "
      "detail: cut it into parts");
}

TEST(PrecisionWarning, SilentForOrdinaryScenes) {
  for (const glm::dvec3& offset : {glm::dvec3(0), glm::dvec3(100, 0, -50), glm::dvec3(700, 20, 700)}) {
    EXPECT_EQ(warningOf(loadText("a.obj", asObj(ground(offset)))), "");
    EXPECT_EQ(warningOf(loadText("a.ply", asPly(ground(offset), true))), "");
    EXPECT_EQ(warningOf(loadText("a.glb", asGlb(ground(glm::dvec3(0)), offset))), "");
  }
  // Slivers where six digits put a vertex beside the edge it should be on, copies of a vertex a little off,
  // and triangles without area in the file: no loss.
  const std::string head = "v 0 0 0\nv 30 10 0\nv 0 20 0\n";
  EXPECT_EQ(warningOf(loadText("a.obj", head + "v 10.000000 3.333333 0\nf 1 4 2\nf 1 2 3\n")), "");
  EXPECT_EQ(
      warningOf(loadText("a.obj", head + "v 30.00000000000001 10.00000000000001 0\nv 30 10.00000000000003 0\n"
                                         "f 2 4 5\nf 1 2 3\n")),
      "");
  EXPECT_EQ(
      warningOf(loadText("a.obj", head + "v 60.3 20.1 0\nv 0.1 0.3 0\nv 0.1 0.3 0\nf 5 6 1\nf 1 2 3\n")), "");
  // Scenes without any extent: nothing to compare with.
  EXPECT_EQ(warningOf(loadText("a.obj", "v 5 5 5\nf 1 1 1\n")), "");
}

TEST(PrecisionWarning, SilentForGeneratedScenes) {
  const test::Folder folder;
  for (const GeneratedSceneInfo& info : generatedScenes()) {
    const Scene scene = generateScene(info.name, 20'000, 3);
    for (const char* name : {"a.obj", "a.glb"}) {
      saveScene(scene, folder / name);
      EXPECT_EQ(warningOf(loadScene(folder / name)), "") << info.name << " " << name;
    }
  }
}

}  // namespace
}  // namespace sightline
