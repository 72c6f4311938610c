// Scenes whose detail single precision does not hold: the warning, with its count, against brute force.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "core/formats/load_scene.h"
#include "core/formats/save_scene.h"
#include "core/generate/generate.h"
#include "core/scene/scene.h"
#include "tests/scene/files.h"
#include "tests/scene/gltf_files.h"

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

TEST(PrecisionWarning, SaysWhatFarCoordinatesLose) {
  const Ground far = ground(kUtm);
  const std::string expected =
      "single precision steps by 0.5 at coordinates of 4649780, and the median edge is 0.102; " +
      lossOf(far) + "; move the scene to the origin before: subtract (500002, 4649778, 35)";
  EXPECT_EQ(lossOf(far),
            "of 3200 triangles 864 lose their area by that and 1696 turn by more than 30 degrees");
  EXPECT_EQ(warningOf(loadText("a.obj", asObj(far))), expected);
  EXPECT_EQ(warningOf(loadText("a.ply", asPly(far, false))), expected);
  EXPECT_EQ(warningOf(loadText("a.ply", asPly(far, true))), expected);
  // Corners that are floats themselves, and a node that takes them away.
  Ground moved = ground(glm::dvec3(0));
  for (glm::dvec3& p : moved.corners) p = glm::dvec3(rounded(p)) + kUtm;
  const std::string by_node = warningOf(loadText("a.glb", asGlb(ground(glm::dvec3(0)), kUtm)));
  EXPECT_NE(by_node.find(lossOf(moved)), std::string::npos) << by_node;
}

TEST(PrecisionWarning, CoarseStepsAreSaidWithoutACollapse) {
  // 4 km off, edges are bent a little. A file of floats, whose own precision that is, gets the same word.
  const Ground far = ground({4000, 0, 0});
  const std::string expected =
      "single precision steps by 0.000244 at coordinates of 4004, and the median edge is 0.102; of 3200 "
      "triangles "
      "0 lose their area by that and 0 turn by more than 30 degrees; move the scene to the origin before: "
      "subtract "
      "(4002, 2, 0)";
  EXPECT_EQ(warningOf(loadText("a.obj", asObj(far))), expected);
  EXPECT_EQ(warningOf(loadText("a.glb", asGlb(far, glm::dvec3(0)))), expected);
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
      "detail: cut it into parts, and move each to the origin");
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
