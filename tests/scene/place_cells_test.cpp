#include "core/place/place_cells.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <set>

#include "core/base/error.h"
#include "core/base/interrupted.h"
#include "core/cell/cell_frame.h"
#include "core/generate/generate.h"
#include "core/generate/mesh_builder.h"
#include "core/gvs/bake_cell.h"
#include "core/scene/contained.h"
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
    ASSERT_EQ(test::firstTriangleInCell(scene, cell), kNoTriangle) << cell.name;
  }
  const size_t clear = cells.size();
  options.margin = 0;
  EXPECT_LE(clear, grid(scene, options, &counts).size() + clear / 50) << "what reaches in by a hundredth";
  EXPECT_GE(clear + clear / 50, counts.kept);
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
  options.origin = glm::dvec3(-20, -1, -20);
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
  const std::vector<ViewCell> cells = grid(room, options);  // boxes at the walls keep the margin, 0.02
  ASSERT_EQ(cells.size(), 4u * 2 * 3);
  EXPECT_EQ(cells[0].name, "grid-0-0-0");
  EXPECT_NEAR(glm::distance(cells[0].center, glm::dvec3(1.01)), 0, 1e-12);
  EXPECT_NEAR(glm::distance(cells[0].size, glm::dvec3(1.98)), 0, 1e-12);
  EXPECT_EQ(cells[1].center.x, 3) << "no wall on either side along x";
  EXPECT_EQ(cells[1].size.x, 2);
  EXPECT_EQ(cells[4].center.z, 3);
  EXPECT_EQ(cells.back().name, "grid-3-1-2");

  options.margin = 0;  // boxes at the walls touch them, and are kept
  const std::vector<ViewCell> touching = grid(room, options);
  ASSERT_EQ(touching.size(), 4u * 2 * 3);
  EXPECT_EQ(touching[0].center, glm::dvec3(1, 1, 1));
  EXPECT_EQ(touching[1].center, glm::dvec3(3, 1, 1));
  EXPECT_EQ(touching[4].center, glm::dvec3(1, 1, 3));
  for (const ViewCell& cell : touching) EXPECT_EQ(cell.size, glm::dvec3(2));
  options.margin.reset();

  options.free_side = FreeSide::kBack;
  EXPECT_EQ(grid(reversed(room), options).size(), 4u * 2 * 3);
  EXPECT_EQ(grid(room, options).size(), 0u);

  options.free_side = FreeSide::kFront;
  options.max_height = 1;
  EXPECT_EQ(grid(room, options).size(), 4u * 3);
}

/// Low and high corner of an unturned cell.
std::pair<glm::dvec3, glm::dvec3> cornersOf(const ViewCell& cell) {
  return {cell.center - cell.size / 2.0, cell.center + cell.size / 2.0};
}

/// How far the triangles are from the cell at least, up to `most`, by brute force: in the largest of the
/// distances along the cell's axes.
double clearance(const Scene& scene, const ViewCell& cell, double most) {
  double low = 0, high = most;
  for (int step = 0; step < 40; ++step) {
    ViewCell grown = cell;
    const double middle = (low + high) / 2;
    grown.size += 2 * middle;
    (test::firstTriangleInCell(scene, grown) == kNoTriangle ? low : high) = middle;
  }
  return low;
}

TEST(GridCells, KeepTheMarginInScenesOfEveryKind) {
  for (const char* name : {"city", "canyon", "plant", "bistro"}) {
    const Scene scene = generateScene(name, 1'000, 3);
    const Bounds bounds = sceneBounds(scene);
    GridOptions options;
    options.size = glm::dvec3(bounds.high - bounds.low) / glm::dvec3(16, 6, 16);
    options.margin = std::min({options.size.x, options.size.y, options.size.z}) / 50;
    GridCounts counts;
    const std::vector<ViewCell> cells = grid(scene, options, &counts);
    ASSERT_GT(cells.size(), 20u) << name;
    EXPECT_GT(counts.inset, 0u) << name;
    for (size_t i = 0; i < cells.size(); i += 1 + cells.size() / 64) {
      EXPECT_GE(clearance(scene, cells[i], 2 * *options.margin), 0.998 * *options.margin)
          << name << " " << cells[i].name;
      EXPECT_GE(cells[i].size.x, options.size.x - 4.001 * *options.margin) << name;
    }
  }
}

TEST(GridCells, OnlySidesWithSomethingNearThemComeIn) {
  MeshBuilder mesh;
  mesh.box({0, 0, 0}, {8, 4, 6});
  Scene room = reversed(toScene(mesh));
  GridOptions options;
  options.size = {2, 2, 2};
  options.margin = 0.125;
  const std::vector<ViewCell> cells = grid(room, options);
  ASSERT_EQ(cells.size(), 4u * 2 * 3);
  double volume = 0;
  for (const ViewCell& cell : cells) {
    const auto [low, high] = cornersOf(cell);
    volume += cell.size.x * cell.size.y * cell.size.z;
    for (int axis = 0; axis < 3; ++axis) {
      const double wall = axis == 0 ? 8 : axis == 1 ? 4 : 6;
      EXPECT_NEAR(low[axis], low[axis] < 1 ? 0.125 : std::round(low[axis]), 1e-12) << cell.name;
      EXPECT_NEAR(high[axis], high[axis] > wall - 1 ? wall - 0.125 : std::round(high[axis]), 1e-12)
          << cell.name;
    }
  }
  EXPECT_NEAR(volume, 7.75 * 3.75 * 5.75, 1e-9) << "no gap but at the walls";
}

/// There floats are half a unit apart: what rays leave is not the box but its corners' nearest floats.
TEST(GridCells, FarFromTheOriginTheMarginIsAboveTheRounding) {
  MeshBuilder mesh;
  mesh.box({5'000'000, 0, 5'000'000}, {5'000'032, 8, 5'000'032});
  const Scene room = reversed(toScene(mesh));
  GridOptions options;
  options.size = glm::dvec3(3.7);
  const std::vector<ViewCell> cells = grid(room, options);
  EXPECT_GT(cells.size(), 50u);
  for (const ViewCell& cell : cells) EXPECT_EQ(containedTriangles(room, cell).size(), 0u) << cell.name;
  options.margin = 0;
  size_t touching = 0;
  for (const ViewCell& cell : grid(room, options)) touching += containedTriangles(room, cell).empty() ? 0 : 1;
  EXPECT_GT(touching, 20u);
}

TEST(GridCells, ABoxMayBeMetByAMarginAndNoDeeper) {
  MeshBuilder mesh;
  mesh.patch({-9, 0, 9}, {18, 0, 0}, {0, 0, -18}, 3, 3);
  const Scene floor = toScene(mesh);
  GridOptions options;
  options.size = {2, 2, 2};
  options.count = {{2, 1, 2}};
  options.margin = 0.0625;
  options.origin = glm::dvec3(-2, -0.06, -2);
  std::vector<ViewCell> cells = grid(floor, options);
  ASSERT_EQ(cells.size(), 4u);
  EXPECT_NEAR(cornersOf(cells[0]).first.y, 0.0625, 1e-12);
  EXPECT_NEAR(cornersOf(cells[0]).second.y, 1.94, 1e-12);
  options.origin->y = 0.05;  // apart, yet by less than the margin
  cells = grid(floor, options);
  ASSERT_EQ(cells.size(), 4u);
  EXPECT_NEAR(cornersOf(cells[0]).first.y, 0.0625, 1e-12);
  options.origin->y = 0.07;
  cells = grid(floor, options);
  ASSERT_EQ(cells.size(), 4u);
  EXPECT_EQ(cells[0].size.y, 2);
  options.origin->y = -0.065;
  EXPECT_EQ(grid(floor, options).size(), 0u);
}

TEST(GridCells, OriginRegionAndCountSayWhereBoxesAre) {
  MeshBuilder mesh;
  mesh.box({-8, 0, -6}, {8, 4, 6});
  const Scene room = reversed(toScene(mesh));
  const auto extent = [&](const GridOptions& options) {
    glm::dvec3 low(1e9), high(-1e9);
    for (const ViewCell& cell : grid(room, options)) {
      low = glm::min(low, cornersOf(cell).first);
      high = glm::max(high, cornersOf(cell).second);
    }
    return std::pair(low, high);
  };
  GridOptions options;
  options.size = {2, 2, 2};
  options.margin = 0;
  EXPECT_EQ(extent(options), std::pair(glm::dvec3(-8, 0, -6), glm::dvec3(8, 4, 6)));

  options.origin = glm::dvec3(-3, 1, -2);
  EXPECT_EQ(extent(options), std::pair(glm::dvec3(-3, 1, -2), glm::dvec3(7, 3, 6)));
  EXPECT_EQ(grid(room, options)[0].name, "grid-0-0-0");

  options.count = {{2, 1, 3}};
  EXPECT_EQ(grid(room, options).size(), 6u);
  EXPECT_EQ(extent(options), std::pair(glm::dvec3(-3, 1, -2), glm::dvec3(1, 3, 4)));

  options.origin.reset();
  EXPECT_EQ(extent(options), std::pair(glm::dvec3(-8, 0, -6), glm::dvec3(-4, 2, 0)));

  options.count.reset();
  options.region = GridRegion{{0.5, 1, 0.5}, {4.5, 3, 2.5}};
  EXPECT_EQ(extent(options), std::pair(glm::dvec3(0.5, 1, 0.5), glm::dvec3(4.5, 3, 2.5)));
  options.region->high.x = 5;  // covered, by a box that reaches farther
  EXPECT_EQ(extent(options).second, glm::dvec3(6.5, 3, 2.5));

  options.origin = glm::dvec3(-8, 0, -6);
  EXPECT_EQ(extent(options), std::pair(glm::dvec3(0, 0, 0), glm::dvec3(6, 4, 4)));
  EXPECT_EQ(grid(room, options)[0].name, "grid-4-0-3");
  options.count = {{5, 1, 9}};
  EXPECT_EQ(extent(options), std::pair(glm::dvec3(0, 0, 0), glm::dvec3(2, 2, 4)));
}

TEST(GridCells, ProgressIsToldAndItCanBeStopped) {
  MeshBuilder mesh;
  mesh.box({0, 0, 0}, {32, 16, 32});
  const Scene room = reversed(toScene(mesh));
  const Bvh bvh = buildBvh(room.positions, room.triangles);
  GridOptions options;
  options.size = {1, 1, 1};
  std::atomic<bool> stop = false;
  std::vector<uint64_t> done;
  GridHooks hooks;
  hooks.progress = [&](uint64_t now, uint64_t boxes) {
    EXPECT_EQ(boxes, 32u * 16 * 32);
    done.push_back(now);
  };
  EXPECT_EQ(gridCells(room, bvh, options, nullptr, hooks).size(), 32u * 16 * 32);
  ASSERT_GT(done.size(), 5u);
  EXPECT_TRUE(std::ranges::is_sorted(done));
  EXPECT_EQ(done[0], 0u);
  hooks.stop = &stop;
  hooks.progress = [&](uint64_t now, uint64_t) {
    EXPECT_LE(now, 4096u) << "goes on after it was stopped";
    if (now >= 4096) stop = true;
  };
  EXPECT_THROW(gridCells(room, bvh, options, nullptr, hooks), Interrupted);
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
  const auto refused = [&](const std::function<void(GridOptions&)>& change) {
    GridOptions options;
    change(options);
    EXPECT_EQ(usageErrors([&] { grid(room, options); }), kExitUsage);
  };
  refused([](GridOptions& o) { o.origin = glm::dvec3(1e300, 0, 0); });
  refused([](GridOptions& o) { o.origin = glm::dvec3(-1e300, 0, 0); });
  refused([](GridOptions& o) { o.origin = glm::dvec3(0, 4, 0); });
  refused([](GridOptions& o) { o.count = {{1, 0, 1}}; });
  refused([](GridOptions& o) { o.count = {{1, UINT64_MAX, 1}}; });
  refused([](GridOptions& o) { o.region = GridRegion{{1, 0, 0}, {0, 1, 1}}; });
  refused([](GridOptions& o) { o.region = GridRegion{{0, 0, 0}, {0, NAN, 1}}; });
  refused([](GridOptions& o) { o.margin = -1; });
  refused([](GridOptions& o) { o.margin = NAN; });
  refused([](GridOptions& o) { o.margin = 0.26; });  // of a size of 2
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

TEST(PathCells, KeepClearOfWhatStandsInTheWay) {
  MeshBuilder mesh;
  mesh.patch({-20, 0, 20}, {40, 0, 0}, {0, 0, -40}, 4, 4);
  mesh.box({0.8, 0, -1}, {3, 5, 1});        // a house that juts out into the path's right side
  mesh.box({-3, 0, 8.5}, {3, 5, 8.7});      // a wall across its end
  mesh.box({-0.1, 0, -15}, {0.1, 5, -14});  // a post in its middle
  const Scene scene = toScene(mesh);
  const Bvh bvh = buildBvh(scene.positions, scene.triangles);
  const glm::dvec3 points[] = {{0, 1, -18}, {0, 1, -12}, {0, 1, -6}, {0, 1, 0}, {0, 1, 6}, {0, 1, 9}};
  const std::vector<ViewCell> cells = pathCells(points, {2, 2, 6});
  ASSERT_EQ(cells.size(), 5u);
  const ClearCells clear = keepClear(scene, bvh, cells, 0.02);
  for (const ViewCell& cell : clear.cells) {
    EXPECT_GE(clearance(scene, cell, 0.04), 0.0199) << cell.name;
    EXPECT_TRUE(inAnyCell({cell}, {0, 1, cell.center.z}, 0)) << "the path's middle line";
  }
  ASSERT_EQ(clear.cells.size(), 4u);
  EXPECT_EQ(clear.inset, 4u) << "all stand on the floor";
  EXPECT_NEAR(clear.cells[1].size.x, 1.78, 1e-6) << "beside the house";
  EXPECT_NEAR(clear.cells[3].size.z, 3 - 0.5 - 0.02, 1e-6) << "before the wall";
  ASSERT_EQ(clear.blocked.size(), 1u);
  EXPECT_EQ(clear.blocked[0].cell.name, "path-1");
  EXPECT_GT(clear.blocked[0].triangles, 2u) << "the post's and the floor's";
}

TEST(PathCells, KeepClearAtAnyTurnInScenesOfEveryKind) {
  for (const char* name : {"city", "canyon", "plant", "bistro"}) {
    const Scene scene = generateScene(name, 1'000, 4);
    const Bvh bvh = buildBvh(scene.positions, scene.triangles);
    const Bounds bounds = sceneBounds(scene);
    const glm::dvec3 extent(bounds.high - bounds.low);
    srand(1);
    size_t kept = 0, inset = 0, blocked = 0;
    for (int round = 0; round < 40; ++round) {
      std::vector<glm::dvec3> points;
      for (int i = 0; i < 3; ++i) {
        const glm::dvec3 share(rand() / double(RAND_MAX), rand() / double(RAND_MAX),
                               rand() / double(RAND_MAX));
        points.push_back(glm::dvec3(bounds.low) + extent * share);
      }
      const double width = extent.x / 100;
      const ClearCells clear =
          keepClear(scene, bvh, pathCells(points, {width, width, 4 * width}), width / 100);
      kept += clear.cells.size();
      inset += clear.inset;
      blocked += clear.blocked.size();
      for (const ViewCell& cell : clear.cells) {
        ASSERT_EQ(test::firstTriangleInCell(scene, cell), kNoTriangle)
            << name << " seed 1 round " << round << " " << cell.name;
      }
      for (const ClearCells::Blocked& left_out : clear.blocked) {
        EXPECT_GT(left_out.triangles, 0u) << name << " seed 1 round " << round << " " << left_out.cell.name;
      }
    }
    EXPECT_GT(kept, 100u) << name;
    EXPECT_GT(inset, 3u) << name;
    EXPECT_GT(blocked, 10u) << name;
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
