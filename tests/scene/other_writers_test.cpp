// Poses and Draco streams that others wrote: a script, which says by its own arithmetic where the triangles
// are, and Google's tools, where they are installed.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>

#include "core/formats/save_scene.h"
#include "tests/scene/files.h"
#include "tests/scene/gltf_files.h"

namespace sightline {
namespace {

using test::Folder;

void runTool(const std::string& command, const Folder& folder) {
  const std::string log = (folder / "log").string();
  ASSERT_EQ(std::system((command + " >'" + log + "' 2>&1 </dev/null").c_str()), 0) << command << "\n"
                                                                                   << test::readText(log);
}

bool hasTool(const std::string& name) {
  return std::system(("command -v " + name + " >/dev/null").c_str()) == 0;
}

using PosedTriangle = std::array<std::array<double, 3>, 3>;

/// Corners in an order of their own: which of a mirrored triangle change places is not the question here.
PosedTriangle sortedCorners(PosedTriangle triangle) {
  std::ranges::sort(triangle);
  return triangle;
}

std::vector<PosedTriangle> posedTriangles(const Scene& scene) {
  std::vector<PosedTriangle> list;
  for (uint32_t id = 0; id < scene.triangleCount(); ++id) {
    PosedTriangle triangle;
    for (size_t c = 0; c < 3; ++c) {
      const glm::dvec3 p = glm::dvec3(scene.corners(id)[c]) + scene.offset;
      triangle[c] = {p.x, p.y, p.z};
    }
    list.push_back(sortedCorners(triangle));
  }
  return list;
}

/// Nine numbers a triangle.
std::vector<PosedTriangle> readTriangles(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::vector<PosedTriangle> list;
  PosedTriangle triangle;
  for (size_t i = 0; in >> triangle[i / 3 % 3][i % 3]; ++i) {
    if (i % 9 == 8) list.push_back(sortedCorners(triangle));
  }
  return list;
}

double largestOf(const std::vector<PosedTriangle>& list) {
  double largest = 0;
  for (const auto& triangle : list) {
    for (const auto& corner : triangle) {
      for (const double x : corner) largest = std::max(largest, std::abs(x));
    }
  }
  return largest;
}

/// The same triangles in the same order, each number within `error`.
void expectNear(const std::vector<PosedTriangle>& found, const std::vector<PosedTriangle>& expected,
                double error) {
  ASSERT_EQ(found.size(), expected.size());
  for (size_t id = 0; id < found.size(); ++id) {
    for (size_t i = 0; i < 9; ++i) {
      ASSERT_NEAR(found[id][i / 3][i % 3], expected[id][i / 3][i % 3], error) << "triangle " << id;
    }
  }
}

TEST(OtherWriters, AScriptPlacesSkinsAndMorphsWhereWeDo) {
  if (!hasTool("python3")) GTEST_SKIP() << "no python3";
  for (int seed = 1; seed <= 8; ++seed) {
    for (const int morphs : {0, 3}) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << ", morph targets " << morphs);
      const Folder folder;
      runTool("python3 '" SL_SOURCE_DIR "/tests/scene/pose_writer.py' " + std::to_string(seed) + " " +
                  std::to_string(morphs) + " '" + (folder / "").string() + "'",
              folder);
      if (HasFatalFailure()) return;
      const auto expected = readTriangles(folder / "pose.txt");
      ASSERT_EQ(expected.size(), 40u);
      // Floats have 24 bits; the rotation's length is 1 up to as many.
      expectNear(posedTriangles(loadScene(folder / "pose.gltf")), expected, largestOf(expected) * 0x1p-20);
      if (HasFatalFailure()) return;
    }
  }
}

/// Triangles on a lattice of eighths, sorted: quantised ones are near it.
std::vector<PosedTriangle> onLattice(const Scene& scene) {
  std::vector<PosedTriangle> list = posedTriangles(scene);
  for (auto& triangle : list) {
    for (auto& corner : triangle) {
      for (double& x : corner) {
        const double place = std::round(x * 8) / 8;
        EXPECT_NEAR(x, place, 1e-3);
        x = place + 0.0;
      }
    }
    triangle = sortedCorners(triangle);
  }
  std::ranges::sort(list);
  return list;
}

Scene squaresOnLattice() {
  Scene scene;
  for (int object = 0; object < 3; ++object) {
    const auto first = uint32_t(scene.triangles.size());
    for (int i = 0; i < 40; ++i) {
      const auto at = uint32_t(scene.positions.size());
      const glm::vec3 low(float(i % 8) / 2, float(i / 8) / 4, float(object) + float(i % 3) / 8);
      for (const glm::vec3& corner : {glm::vec3(0), {0.25f, 0, 0}, {0.25f, 0.125f, 0}, {0, 0.125f, 0.125f}}) {
        scene.positions.push_back(low + corner);
      }
      scene.triangles.insert(scene.triangles.end(), {{at, at + 1, at + 2}, {at, at + 2, at + 3}});
    }
    scene.objects.push_back({"squares" + std::to_string(object), first, 80});
  }
  return scene;
}

TEST(OtherWriters, DracoTranscoderPacksWhatWeWrote) {
  if (!hasTool("draco_transcoder")) GTEST_SKIP() << "no draco_transcoder (Debian: draco)";
  const Folder folder;
  const Scene scene = squaresOnLattice();
  saveScene(scene, folder / "ours.glb");
  for (const std::string bits : {"16", "24"}) {
    for (const std::string name : {"a.glb", "a.gltf"}) {
      SCOPED_TRACE(name + ", " + bits);
      runTool("draco_transcoder -qp " + bits + " -i '" + (folder / "ours.glb").string() + "' -o '" +
                  (folder / name).string() + "'",
              folder);
      if (HasFatalFailure()) return;
      EXPECT_NE(test::readText(folder / name).find("KHR_draco_mesh_compression"), std::string::npos);
      const Scene loaded = loadScene(folder / name);
      EXPECT_EQ(loaded.objects.size(), 3u);
      EXPECT_EQ(onLattice(loaded), onLattice(scene));
    }
  }
}

/// Of all its levels; the stream alone, in a file of ours.
TEST(OtherWriters, DracoEncoderPacksOurObj) {
  if (!hasTool("draco_encoder")) GTEST_SKIP() << "no draco_encoder (Debian: draco)";
  const Folder folder;
  const Scene scene = squaresOnLattice();
  saveScene(scene, folder / "ours.obj");
  for (const char* level : {"0", "3", "7", "10"}) {
    SCOPED_TRACE(level);
    runTool(std::string("draco_encoder -qp 20 -cl ") + level + " -i '" + (folder / "ours.obj").string() +
                "' -o '" + (folder / "a.drc").string() + "'",
            folder);
    if (HasFatalFailure()) return;
    test::GltfFile file;
    const size_t view = file.addView(test::readText(folder / "a.drc"));
    file.document["accessors"] = {{{"componentType", 5126}, {"count", 480}, {"type", "VEC3"}},
                                  {{"componentType", 5125}, {"count", 720}, {"type", "SCALAR"}}};
    file.addMesh(0, 1);
    file.document["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] = {
        {"bufferView", view}, {"attributes", {{"POSITION", 0}}}};
    file.document["extensionsRequired"] = {"KHR_draco_mesh_compression"};
    EXPECT_EQ(onLattice(test::loadText("a.glb", file.glb())), onLattice(scene));
  }
}

}  // namespace
}  // namespace sightline
