#include "core/formats/save_scene.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <bit>
#include <cmath>
#include <csignal>
#include <random>

#include "core/formats/load_scene.h"
#include "core/scene/scene.h"
#include "tests/scene/files.h"

namespace sightline {
namespace {

using test::errorOf;
using test::Folder;

/// A scene of random floats of every size that a scene may have, with shared and unused vertices.
Scene randomScene(uint64_t seed) {
  std::mt19937_64 random(seed);
  Scene scene;
  while (scene.positions.size() < 500) {
    const glm::vec3 p(std::bit_cast<float>(uint32_t(random())), std::bit_cast<float>(uint32_t(random())),
                      scene.positions.size() % 5 == 0 ? -0.0f : float(random() % 1000) * 0.1f);
    if (std::abs(p.x) <= kLargestCoordinate && std::abs(p.y) <= kLargestCoordinate)
      scene.positions.push_back(p);
  }
  for (const char* name : {"walls", "a b/c #1", "x\\", "\xc3\xa4", "walls"}) {
    const auto first = uint32_t(scene.triangles.size());
    const auto count = uint32_t(1 + random() % 100);
    for (uint32_t i = 0; i < count; ++i) {
      scene.triangles.emplace_back(random() % 490, random() % 490, random() % 490);
    }
    scene.objects.push_back({name, first, count});
  }
  return scene;
}

void expectSame(const Scene& a, const Scene& b) {
  ASSERT_EQ(a.positions.size(), b.positions.size());
  for (size_t i = 0; i < a.positions.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      ASSERT_EQ(std::bit_cast<uint32_t>(a.positions[i][c]), std::bit_cast<uint32_t>(b.positions[i][c]))
          << "position " << i << " " << a.positions[i][c] << " " << b.positions[i][c];
    }
  }
  ASSERT_EQ(a.triangles, b.triangles);
  ASSERT_EQ(a.objects.size(), b.objects.size());
  for (size_t i = 0; i < a.objects.size(); ++i) {
    EXPECT_EQ(a.objects[i].name, b.objects[i].name);
    EXPECT_EQ(a.objects[i].first_triangle, b.objects[i].first_triangle);
    EXPECT_EQ(a.objects[i].triangle_count, b.objects[i].triangle_count);
  }
}

TEST(SaveScene, ReadsBackBitForBit) {
  const Folder folder;
  for (uint64_t seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Scene scene = randomScene(seed);
    for (const char* name : {"s.obj", "s.glb", "S.GLB"}) {
      SCOPED_TRACE(name);
      saveScene(scene, folder / name);
      const Scene loaded = loadScene(folder / name);
      test::expectValid(loaded);
      expectSame(scene, loaded);
      EXPECT_EQ(hashScene(loaded), hashScene(scene));
    }
  }
}

TEST(SaveScene, KeepsTheSidednessOfMaterials) {
  const Folder folder;
  Scene scene = randomScene(1);
  saveScene(scene, folder / "s.glb");
  EXPECT_EQ(loadScene(folder / "s.glb").single_sided_triangles, 0u);
}

TEST(SaveScene, Errors) {
  const Folder folder;
  Scene scene = randomScene(1);
  const auto error = [&](const std::string& name) {
    return errorOf([&] { saveScene(scene, folder / name); });
  };
  EXPECT_EQ(error("s.ply"), "s.ply: unknown extension \".ply\", expected .obj or .glb");
  EXPECT_EQ(error("none/s.obj"), "none/s.obj: cannot create: No such file or directory");
  std::filesystem::create_directory(folder / "dir.obj");
  EXPECT_EQ(error("dir.obj"), "dir.obj: is not a regular file, so it is not replaced; name another");
  scene.objects[2].name = "a\nb";
  EXPECT_EQ(error("s.obj").substr(0, 24), "s.obj: object 2 has a na");
  scene.objects[2].name = "";
  EXPECT_EQ(error("s.glb").substr(0, 24), "s.glb: object 2 has a na");
  scene.triangles.clear();
  EXPECT_EQ(error("s.obj"), "s.obj: the scene holds no triangles");
  // Nothing half-written stays behind.
  const auto files = std::filesystem::directory_iterator((folder / "x").parent_path());
  EXPECT_EQ(std::distance(begin(files), end(files)), 1);
}

/// No file of this process grows past so many bytes while it lives: stands in for a full disk.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    getrlimit(RLIMIT_FSIZE, &before_);
    old_handler_ = std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, old_handler_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit before_{};
  void (*old_handler_)(int);
};

TEST(SaveScene, FullDiskIsAnError) {
  const Folder folder;
  const FileSizeLimit limit(1000);
  EXPECT_EQ(errorOf([&] { saveScene(randomScene(1), folder / "s.obj"); }),
            "s.obj: cannot write: File too large");
  EXPECT_TRUE(std::filesystem::is_empty((folder / "x").parent_path()));
}

}  // namespace
}  // namespace sightline
