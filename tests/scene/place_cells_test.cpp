#include "core/scene/place_cells.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "core/error.h"
#include "core/scene/cell_frame.h"
#include "core/scene/generate.h"
#include "core/scene/mesh_builder.h"
#include "tests/scene/box_overlap.h"

namespace sightline {
namespace {

Scene toScene(const MeshBuilder& mesh) {
  Scene scene;
  scene.positions = mesh.positions();
  scene.triangles = mesh.triangles();
  scene.objects = {{"mesh", 0, uint32_t(scene.triangles.size())}};
  return scene;
}

Scene reversed(Scene scene) {
  for (glm::uvec3& t : scene.triangles) std::swap(t.x, t.y);
  return scene;
}

std::vector<ViewCell> grid(const Scene& scene, const GridOptions& options, GridCounts* counts = nullptr) {
  const Bvh bvh = buildBvh(scene.positions, scene.triangles);
  return gridCells(scene, bvh, options, counts);
}

int usageErrors(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& e) {
    return e.exitCode();
  }
  return 0;
}

TEST(GridCells, KeepsExactlyTheFreeBoxesOfACity) {
  const Scene scene = generateScene("city", 3'000, 5);
  GridOptions options;
  options.size = {11, 5, 9};
  options.free_side = FreeSide::kAny;
  GridCounts counts;
  const std::vector<ViewCell> cells = grid(scene, options, &counts);
  EXPECT_EQ(counts.kept, cells.size());
  EXPECT_EQ(counts.boxes,
            counts.kept + counts.blocked + counts.nothing_below + counts.too_high + counts.in_solid);
  ASSERT_GT(cells.size(), 50u);
  EXPECT_GT(counts.blocked, 100u);

  std::set<std::string> names;
  uint64_t free = 0;
  for (const ViewCell& cell : cells) {
    EXPECT_TRUE(names.insert(cell.name).second);
    ViewCell inside = cell;
    inside.size *= 1 - 1e-6;
    ASSERT_EQ(test::firstTriangleInCell(scene, inside), kNoTriangle) << cell.name;
  }
  // Every box of the grid by brute force: as many are free as were not reported blocked.
  const Bounds bounds = sceneBounds(scene);
  for (double y = bounds.low.y; y < bounds.high.y; y += options.size.y) {
    for (double z = bounds.low.z; z < bounds.high.z; z += options.size.z) {
      for (double x = bounds.low.x; x < bounds.high.x; x += options.size.x) {
        ViewCell cell{"", glm::dvec3(x, y, z) + options.size / 2.0, options.size * (1 - 1e-6), glm::dvec3(0)};
        free += test::firstTriangleInCell(scene, cell) == kNoTriangle;
      }
    }
  }
  EXPECT_EQ(free, counts.boxes - counts.blocked);
}

TEST(GridCells, LeavesOutTheInsideOfSolids) {
  MeshBuilder mesh;
  mesh.patch({-20, 0, 20}, {40, 0, 0}, {0, 0, -40}, 4, 4);
  mesh.box({-6, 1, -6}, {6, 13, 6});
  const Scene scene = toScene(mesh);
  GridOptions options;
  options.size = {2, 2, 2};
  options.origin = glm::dvec3(0, 1, 0);
  const auto inTheBox = [](const std::vector<ViewCell>& cells) {
    size_t count = 0;
    for (const ViewCell& c : cells) {
      count += std::fabs(c.center.x) < 6 && std::fabs(c.center.z) < 6 && c.center.y > 1 && c.center.y < 13;
    }
    return count;
  };
  GridCounts counts;
  const std::vector<ViewCell> outside = grid(scene, options, &counts);
  EXPECT_EQ(inTheBox(outside), 0u);
  EXPECT_EQ(counts.in_solid, 6u * 6 * 6);
  // 20 x 20 columns of 6 boxes over the ground; the layer at the ground is cut by it.
  EXPECT_EQ(outside.size(), size_t(20 * 20 * 6 - 6 * 6 * 6));
  EXPECT_EQ(counts.blocked, 20u * 20);

  options.free_side = FreeSide::kAny;
  EXPECT_EQ(inTheBox(grid(scene, options)), 6u * 6 * 6);
}

TEST(GridCells, FillsARoomSeenFromWithin) {
  MeshBuilder mesh;
  mesh.box({0, 0, 0}, {8, 4, 6});
  const Scene room = reversed(toScene(mesh));
  GridOptions options;
  options.size = {2, 2, 2};
  const std::vector<ViewCell> cells = grid(room, options);  // boxes at the walls touch them, and are kept
  ASSERT_EQ(cells.size(), 4u * 2 * 3);
  EXPECT_EQ(cells[0].name, "grid-0-0-0");
  EXPECT_EQ(cells[0].center, glm::dvec3(1, 1, 1));
  EXPECT_EQ(cells[1].center, glm::dvec3(3, 1, 1));
  EXPECT_EQ(cells[4].center, glm::dvec3(1, 1, 3));
  EXPECT_EQ(cells.back().name, "grid-3-1-2");

  options.free_side = FreeSide::kBack;
  EXPECT_EQ(grid(reversed(room), options).size(), 4u * 2 * 3);
  EXPECT_EQ(grid(room, options).size(), 0u);

  options.free_side = FreeSide::kFront;
  options.max_height = 1;
  EXPECT_EQ(grid(room, options).size(), 4u * 3);
}

TEST(GridCells, RefusesSizesThatMakeNoGrid) {
  MeshBuilder mesh;
  mesh.box({0, 0, 0}, {8, 4, 6});
  const Scene room = toScene(mesh);
  for (const glm::dvec3 size : {glm::dvec3(0, 1, 1), glm::dvec3(1, -1, 1), glm::dvec3(1, 1, NAN),
                                glm::dvec3(INFINITY, 1, 1), glm::dvec3(1e-4), glm::dvec3(1e-300)}) {
    GridOptions options;
    options.size = size;
    EXPECT_EQ(usageErrors([&] { grid(room, options); }), kExitUsage)
        << size.x << " " << size.y << " " << size.z;
  }
  GridOptions far;
  far.origin = glm::dvec3(1e300, 0, 0);
  EXPECT_EQ(usageErrors([&] { grid(room, far); }), kExitUsage);
}

TEST(PathCells, TileAStraightStreet) {
  const glm::dvec3 points[] = {{0, 1, 0}, {0, 1, 400}};
  const std::vector<ViewCell> cells = pathCells(points, {2.5, 2, 150});
  ASSERT_EQ(cells.size(), 3u);
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(cells[i].name, "path-" + std::to_string(i + 1));
    EXPECT_NEAR(cells[i].center.z, 400.0 / 6 * double(2 * i + 1), 1e-9);
    EXPECT_NEAR(cells[i].size.z, 400.0 / 3, 1e-9);
    EXPECT_EQ(cells[i].rotation, glm::dvec3(0));
  }
}

bool inAnyCell(const std::vector<ViewCell>& cells, glm::dvec3 p, double slack) {
  for (const ViewCell& cell : cells) {
    const glm::dvec3 local = glm::abs(cellFrame(cell).toLocal(p));
    if (local.x <= cell.size.x / 2 + slack && local.y <= cell.size.y / 2 + slack &&
        local.z <= cell.size.z / 2 + slack) {
      return true;
    }
  }
  return false;
}

TEST(PathCells, LeaveNoGapAlongRandomPaths) {
  for (uint32_t seed = 0; seed < 200; ++seed) {
    srand(seed);
    const auto random = [](double low, double high) {
      return low + (high - low) * rand() / double(RAND_MAX);
    };
    const bool level = seed % 2 == 0;
    // Turns of up to 90 degrees: on a level path every point of the swept strip is in a box.
    std::vector<glm::dvec3> points{{random(-50, 50), 2, random(-50, 50)}};
    double heading = random(0, 6.28);
    for (int i = 0; i < 6; ++i) {
      heading += random(-1.57, 1.57);
      const double run = random(10, 60);
      points.push_back(points.back() + glm::dvec3(run * std::sin(heading), level ? 0 : random(-10, 10),
                                                  run * std::cos(heading)));
    }
    const PathOptions options{random(0.5, 4), random(0.5, 3), random(5, 40)};
    const std::vector<ViewCell> cells = pathCells(points, options);
    for (size_t i = 0; i + 1 < points.size(); ++i) {
      for (double s = 0; s <= 1; s += 1.0 / 64) {
        const glm::dvec3 middle = points[i] + (points[i + 1] - points[i]) * s;
        ASSERT_TRUE(inAnyCell(cells, middle, 1e-9)) << "seed " << seed << " stretch " << i << " at " << s;
      }
      if (!level || i == 0) continue;
      // The outer edge of the strip at the bend, from where one stretch ends to where the other begins.
      const glm::dvec3 in = glm::normalize(points[i] - points[i - 1]);
      const glm::dvec3 out = glm::normalize(points[i + 1] - points[i]);
      const double half = options.width / 2;
      const double turn = glm::cross(in, out).y > 0 ? 1 : -1;
      const glm::dvec3 foot_in = glm::dvec3(-in.z, 0, in.x) * (turn * half);
      const glm::dvec3 foot_out = glm::dvec3(-out.z, 0, out.x) * (turn * half);
      const glm::dvec3 corner = glm::normalize(in - out) * (half / std::sqrt((1 + glm::dot(in, out)) / 2));
      for (double s = 0; s <= 1; s += 1.0 / 16) {
        for (const glm::dvec3& foot : {foot_in, foot_out}) {
          const glm::dvec3 edge = points[i] + (foot + (corner - foot) * s) * 0.999;
          ASSERT_TRUE(inAnyCell(cells, edge, 1e-9)) << "seed " << seed << " bend " << i << " at " << s;
        }
      }
    }
    for (const ViewCell& cell : cells) {
      EXPECT_EQ(cell.size.x, options.width);
      EXPECT_EQ(cell.size.y, options.height);
      EXPECT_LE(cell.size.z, options.length + 2 * std::max(options.width, options.height));
      EXPECT_NEAR(cellFrame(cell).axes[0].y, 0, 1e-12) << "x is level";
      EXPECT_GE(cellFrame(cell).axes[1].y, 0) << "not upside down";
    }
  }
}

TEST(PathCells, GoStraightUp) {
  const glm::dvec3 points[] = {{1, 0, 2}, {1, 30, 2}};
  const std::vector<ViewCell> cells = pathCells(points, {1, 1, 100});
  ASSERT_EQ(cells.size(), 1u);
  EXPECT_NEAR(cellFrame(cells[0]).axes[2].y, 1, 1e-12);
}

TEST(PathCells, RefuseWhatIsNoPath) {
  const std::vector<glm::dvec3> none, one{{0, 0, 0}}, same{{1, 1, 1}, {1, 1, 1}}, nan{{0, 0, 0}, {0, NAN, 0}},
      good{{0, 0, 0}, {1, 0, 0}};
  for (const auto& points : {none, one, same, nan}) {
    EXPECT_EQ(usageErrors([&] { pathCells(points, {}); }), kExitUsage) << points.size();
  }
  for (const PathOptions& options :
       {PathOptions{0, 1, 1}, PathOptions{1, -1, 1}, PathOptions{1, 1, NAN}, PathOptions{1, 1, 1e-9}}) {
    EXPECT_EQ(usageErrors([&] { pathCells(good, options); }), kExitUsage) << options.length;
  }
}

}  // namespace
}  // namespace sightline
