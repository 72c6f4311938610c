// Files that another library wrote: assimp, where it is installed, reads a file and writes it in its own way;
// both hold the same triangles.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <random>

#include "core/formats/load_scene.h"
#include "core/formats/save_scene.h"
#include "tests/scene/files.h"

namespace sightline {
namespace {

using test::Folder;

#define SL_SKIP_WITHOUT_ASSIMP() \
  if (std::system("command -v assimp >/dev/null") != 0) GTEST_SKIP() << "no assimp (Debian: assimp-utils)"

/// Writes `to` from `from`, in one of assimp's formats.
void convert(const std::filesystem::path& from, const std::filesystem::path& to, const char* format) {
  const std::string command = "assimp export '" + from.string() + "' '" + to.string() + "' -f" + format +
                              " >'" + to.string() + ".log' 2>&1 </dev/null";
  ASSERT_EQ(std::system(command.c_str()), 0) << test::readText(to.string() + ".log");
  ASSERT_TRUE(std::filesystem::exists(to)) << test::readText(to.string() + ".log");
}

using WrittenCorner = std::array<float, 3>;
using WrittenTriangle = std::array<WrittenCorner, 3>;

/// All triangles, sorted; of each the least corner first, without turning it over.
std::vector<WrittenTriangle> writtenTriangles(const Scene& scene) {
  std::vector<WrittenTriangle> list;
  for (uint32_t id = 0; id < scene.triangleCount(); ++id) {
    WrittenTriangle triangle;
    for (size_t c = 0; c < 3; ++c) {
      const glm::vec3 p = scene.corners(id)[c];
      triangle[c] = {p.x + 0.0f, p.y + 0.0f, p.z + 0.0f};  // no -0
    }
    std::rotate(triangle.begin(), std::ranges::min_element(triangle), triangle.end());
    list.push_back(triangle);
  }
  std::ranges::sort(list);
  return list;
}

/// WrittenTriangle on a lattice of eighths, which every format holds exactly.
Scene latticeScene() {
  std::mt19937_64 random(7);
  Scene scene;
  const auto number = [&] { return float(int(random() % 255) - 127) / 8; };
  for (int i = 0; i < 300; ++i) scene.positions.emplace_back(number(), number(), number());
  for (uint32_t object = 0; object < 4; ++object) {
    const auto first = uint32_t(scene.triangles.size());
    while (scene.triangles.size() < first + 100) {
      const glm::uvec3 t(random() % 300, random() % 300, random() % 300);
      const glm::vec3 a = scene.positions[t.x], b = scene.positions[t.y], c = scene.positions[t.z];
      if (glm::length(glm::cross(b - a, c - a)) > 1) scene.triangles.push_back(t);
    }
    scene.objects.push_back({"object" + std::to_string(object), first, 100});
  }
  return scene;
}

TEST(Assimp, WritesWhatWeWroteAsEveryFormat) {
  SL_SKIP_WITHOUT_ASSIMP();
  const Folder folder;
  const Scene scene = latticeScene();
  for (const char* ours : {"ours.obj", "ours.glb"}) {
    saveScene(scene, folder / ours);
    for (const auto& [name, format] : {std::pair{"a.glb", "glb2"},
                                       {"a.gltf", "gltf2"},
                                       {"a.obj", "obj"},
                                       {"a.ply", "ply"},
                                       {"b.ply", "plyb"}}) {
      SCOPED_TRACE(std::string(ours) + " to " + name);
      convert(folder / ours, folder / name, format);
      if (HasFatalFailure()) return;
      const Scene loaded = loadScene(folder / name);
      test::expectValid(loaded);
      EXPECT_EQ(writtenTriangles(loaded), writtenTriangles(scene));
    }
  }
}

}  // namespace
}  // namespace sightline
