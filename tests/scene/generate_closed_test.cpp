// The closed city: what it says is solid bounds a solid, and nothing of the open one changes.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/base/error.h"
#include "core/generate/generate.h"
#include "core/generate/rim.h"
#include "core/scene/instances.h"
#include "tests/scene/box_overlap.h"
#include "tests/scene/edge_counts.h"
#include "tests/scene/files.h"

namespace sightline {
namespace {

using test::errorOf;

bool isSolid(const SceneObject& object) {
  return object.name == "road" || object.name.starts_with("building") || object.name.starts_with("pavement");
}

std::span<const glm::uvec3> trianglesOf(const Scene& scene, const SceneObject& object) {
  return std::span(scene.triangles).subspan(object.first_triangle, object.triangle_count);
}

class ClosedCity : public testing::TestWithParam<std::tuple<uint64_t, uint64_t>> {};

TEST_P(ClosedCity, EveryEdgeOfASolidIsThatOfTwoTriangles) {
  const auto [n, seed] = GetParam();
  const Scene scene = generateScene("city", n, seed, {.closed = true});
  EXPECT_LE(scene.triangles.size(), n);
  EXPECT_GE(double(scene.triangles.size()), (n < 10'000 ? 0.85 : 0.97) * double(n));
  size_t buildings = 0;
  for (const SceneObject& object : scene.objects) {
    if (!isSolid(object)) continue;
    buildings += object.name.starts_with("building") ? 1 : 0;
    const test::EdgeCounts edges = test::countEdges(trianglesOf(scene, object));
    ASSERT_EQ(edges.open, 0u) << object.name;
    ASSERT_EQ(edges.other, 0u) << object.name;
    ASSERT_EQ(edges.paired, 3 * uint64_t(object.triangle_count)) << object.name;
    for (const double volume : test::volumesOfPieces(trianglesOf(scene, object), scene.positions)) {
      ASSERT_GT(volume, 0) << object.name << " faces inwards";
    }
  }
  EXPECT_GE(buildings, 24u);
  for (const glm::uvec3& t : scene.triangles) {
    const glm::dvec3 a = scene.positions[t.x], b = scene.positions[t.y], c = scene.positions[t.z];
    ASSERT_GT(glm::length(glm::cross(b - a, c - a)), 0);
  }
}

/// Walls and roof are one piece, of the volume of a house: no roof that merely lies on it.
TEST_P(ClosedCity, AHouseIsOnePiece) {
  const auto [n, seed] = GetParam();
  const Scene scene = generateScene("city", n, seed, {.closed = true});
  for (const SceneObject& object : scene.objects) {
    if (!object.name.starts_with("building")) continue;
    glm::vec3 low = scene.positions[scene.triangles[object.first_triangle].x], high = low;
    for (const glm::uvec3& t : trianglesOf(scene, object)) {
      for (int k = 0; k < 3; ++k) {
        low = glm::min(low, scene.positions[t[k]]);
        high = glm::max(high, scene.positions[t[k]]);
      }
    }
    const std::vector<double> volumes = test::volumesOfPieces(trianglesOf(scene, object), scene.positions);
    const glm::dvec3 size = glm::dvec3(high - low);
    EXPECT_GT(*std::ranges::max_element(volumes) / 6, 0.4 * size.x * size.y * size.z) << object.name;
  }
}

TEST_P(ClosedCity, CellsAreInFreeSpace) {
  const auto [n, seed] = GetParam();
  const Scene scene = generateScene("city", n, seed, {.closed = true});
  for (const ViewCell& cell : generateCells("city", n, seed)) {
    EXPECT_EQ(test::firstTriangleInCell(scene, cell), kNoTriangle) << cell.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, ClosedCity,
                         testing::Combine(testing::Values(1'000ull, 3'000ull, 12'345ull, 60'000ull,
                                                          300'000ull, 1'000'000ull),
                                          testing::Values(1ull, 2ull)),
                         [](const auto& c) {
                           return std::to_string(std::get<0>(c.param)) + "_" +
                                  std::to_string(std::get<1>(c.param));
                         });

TEST(ClosedCityKinds, RepeatSolids) {
  const Scene scene = flatten(generateRepeated("city", 300'000, 1, 3, true));
  size_t solids = 0;
  for (const SceneObject& object : scene.objects) {
    if (!object.name.starts_with("block") && !object.name.starts_with("pavement") && object.name != "road")
      continue;
    ++solids;
    EXPECT_EQ(test::countEdges(trianglesOf(scene, object)).paired, 3 * uint64_t(object.triangle_count))
        << object.name;
  }
  EXPECT_GT(solids, 8u);
}

TEST(ClosedCityErrors, OfWhatHasNoClosedForm) {
  EXPECT_EQ(errorOf([] { generateScene("plant", 20'000, 1, {.closed = true}); }),
            "the scene 'plant' has no closed form: city has");
  EXPECT_EQ(errorOf([] { generateScene("scan", 20'000, 1, {.closed = true}); }),
            "the scene 'scan' is closed without holes");
  EXPECT_EQ(errorOf([] { generateScene("city", 20'000, 1, {.alpha = true, .closed = true}); }),
            "a house with windows of glass is not closed: ask for alpha or for closed");
  EXPECT_EQ(errorOf([] { generateRepeated("plant", 20'000, 1, 2, true); }),
            "the scene 'plant' has no closed form: city has");
}

/// A change here changes every figure that was measured on closed cities.
TEST(ClosedCityScene, IsTheSameFromEveryCompiler) {
  EXPECT_EQ(hashScene(generateScene("city", 300'000, 1, {.closed = true})), 4461081717649286655u);
}

/// Seams of different numbers of vertices, all ways round.
TEST(Rim, BlocksAreClosed) {
  for (const glm::uvec2 quads : {glm::uvec2(1, 1), {1, 5}, {7, 2}, {16, 16}}) {
    MeshBuilder mesh, counter(MeshBuilder::Mode::kCount);
    for (MeshBuilder* m : {&mesh, &counter}) {
      m->frame = Frame{}.at({3, 4, 5}, 0.15f);
      closedBlock(*m, {-1, -2, -3}, {1, 2, 3}, quads.x, quads.y);
    }
    EXPECT_EQ(counter.triangleCount(), mesh.triangleCount());
    EXPECT_EQ(counter.vertexCount(), mesh.positions().size());
    EXPECT_EQ(test::countEdges(mesh.triangles()).paired, 3 * mesh.triangles().size());
    const std::vector<double> volumes = test::volumesOfPieces(mesh.triangles(), mesh.positions());
    ASSERT_EQ(volumes.size(), 1u);
    EXPECT_NEAR(volumes[0] / 6, 48, 1e-4);
  }
}

TEST(MeshBuilder, BoardsAreClosedAndBoxesWhereAsked) {
  for (const bool closed : {false, true}) {
    MeshBuilder mesh(MeshBuilder::Mode::kStore, {.closed = closed});
    mesh.board({{{0, 0, 1}, {2, 0, 1}, {2, 3, 0.5f}, {0, 3, 0.5f}}}, {0, 0, -0.25f});
    const size_t board = mesh.triangles().size();
    EXPECT_EQ(board, 12u);
    EXPECT_EQ(test::countEdges(mesh.triangles()).paired, 36u);
    EXPECT_NEAR(test::volumesOfPieces(mesh.triangles(), mesh.positions()).at(0) / 6, 2 * 3 * 0.25, 1e-5);
    mesh.box({0, 0, 0}, {1, 1, 1}, kNoLowY | kNoHighX);
    EXPECT_EQ(mesh.triangles().size() - board, closed ? 12u : 8u);
  }
}

}  // namespace
}  // namespace sightline
