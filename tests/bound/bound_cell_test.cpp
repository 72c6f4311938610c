#include "core/bound/bound_cell.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>

#include "core/base/interrupted.h"
#include "core/bound/hide.h"
#include "tests/bound/sightings.h"
#include "tests/support/boxes.h"
#include "tests/support/instanced_scene.h"
#include "tests/support/make_cell.h"

namespace sightline::bound_test {
namespace {

using testing_support::makeCell;
using testing_support::SceneOfBoxes;

constexpr double kVoxel = 0.25;

BoundScene voxelsOf(const Scene& scene) {
  return makeBoundScene(scene, {.lattice = latticeOf(kVoxel)});
}

// A wall along x and y around a square hole.
void addWallWithHole(SceneOfBoxes& boxes, const glm::vec3& low, float size, float hole) {
  const float side = (size - hole) / 2;
  boxes.addRectangle(low, {side, 0, 0}, {0, size, 0});
  boxes.addRectangle(low + glm::vec3(side + hole, 0, 0), {side, 0, 0}, {0, size, 0});
  boxes.addRectangle(low + glm::vec3(side, 0, 0), {hole, 0, 0}, {0, side, 0});
  boxes.addRectangle(low + glm::vec3(side, side + hole, 0), {hole, 0, 0}, {0, side, 0});
}

// Houses and rooms with holes of some sizes, and things in them and between.
Scene randomTown(Random& random) {
  SceneOfBoxes boxes;
  for (int i = 0; i < 10; ++i) {
    glm::vec3 low(0), size(0);
    do {
      low = random.point(7);
      for (int axis = 0; axis < 3; ++axis) size[axis] = 1 + 3 * random.unit();
    } while (glm::all(glm::lessThan(low, glm::vec3(1.5f))) &&
             glm::all(glm::greaterThan(low + size, glm::vec3(-1.5f))));
    boxes.addBox(low, low + size);
    const glm::vec3 in = low + size * 0.4f;
    boxes.addTriangle(in, in + glm::vec3(0.3f, 0, 0), in + glm::vec3(0, 0.3f, 0.1f));
  }
  for (const float hole : {0.05f, 0.2f, 1.0f}) {
    // A room: five walls, and one with a hole that looks to the cell.
    const glm::vec3 low = random.point(1.5f) + glm::vec3(hole == 1.0f ? -6 : hole == 0.2f ? 4 : -1, 0, 4);
    const float size = 2.2f;
    addWallWithHole(boxes, low, size, hole);
    const glm::vec3 x(size, 0, 0), y(0, size, 0), z(0, 0, size);
    boxes.addRectangle(low + z, x, y);
    boxes.addRectangle(low, z, y);
    boxes.addRectangle(low + x, z, y);
    boxes.addRectangle(low, x, z);
    boxes.addRectangle(low + y, x, z);
  }
  for (int i = 0; i < 60; ++i) {
    const glm::vec3 at = random.point(8), b = random.point(0.4f), c = random.point(0.4f);
    boxes.addTriangle(at, at + b, at + c);
  }
  return boxes.finish();
}

std::vector<ViewCell> cellsOfTown() {
  return {makeCell({0, 0, 0}, {1, 0.8, 1.2}), makeCell({0.1, 0, 0.2}, {0.9, 1.1, 0.4}, {20, 35, 50}),
          makeCell({0, 0, -0.5}, {1, 1, 0}, {10, 20, 0}), makeCell({0, 0.1, 0}, {0, 1, 1})};
}

TEST(BoundCell, HoldsAllThatExactRaysSeeButLeaks) {
  uint64_t hidden = 0, seen = 0;
  for (uint32_t seed = 1; seed <= 6; ++seed) {
    Random random(seed);
    const Scene scene = randomTown(random);
    const BoundScene voxels = voxelsOf(scene);
    const Onlooker onlooker(scene);
    for (const ViewCell& cell : cellsOfTown()) {
      const CellBound bound = boundCell(voxels, cell);
      const Sightings sightings = onlooker.look(voxels, cell, bound.triangles, 40, random);
      EXPECT_EQ(sightings.faults, std::vector<std::string>()) << "seed " << seed;
      hidden += scene.triangleCount() - bound.triangles.size();
      seen += sightings.seen;
    }
  }
  // The test would see what is wrong: much is hidden, much is seen, and some through holes of less than a
  // voxel.
  EXPECT_GT(hidden, 600u);
  EXPECT_GT(seen, 10000u);
}

// A closed room with a hole: larger than two voxels, what is seen through it is in the bound; smaller than
// one, it is a leak, and the ray's place in the room is the first opaque one on its way.
TEST(BoundCell, HolesSmallerThanAVoxelLeak) {
  for (const float hole : {0.05f, 0.2f, 0.6f, 1.2f}) {
    SceneOfBoxes boxes;
    const float x = -2.03f, y = -2.04f, z = 3.06f, size = 4.1f;
    addWallWithHole(boxes, {x, y, z}, size, hole);
    boxes.addRectangle({x, y, z}, {0, 0, 3}, {0, size, 0});
    boxes.addRectangle({x + size, y, z}, {0, 0, 3}, {0, size, 0});
    boxes.addRectangle({x, y, z}, {size, 0, 0}, {0, 0, 3});
    boxes.addRectangle({x, y + size, z}, {size, 0, 0}, {0, 0, 3});
    const uint32_t back = boxes.addRectangle({x, y, z + 3}, {size, 0, 0}, {0, size, 0});
    const Scene scene = boxes.finish();
    const BoundScene voxels = voxelsOf(scene);
    const ViewCell cell = makeCell({0, 0, 0}, {1, 1, 1});
    const CellBound bound = boundCell(voxels, cell);
    Random random(3);
    const Sightings sightings = Onlooker(scene).look(voxels, cell, bound.triangles, 3000, random);
    EXPECT_EQ(sightings.faults, std::vector<std::string>()) << hole;
    EXPECT_EQ(sightings.leaks > 0, hole < 0.25f) << hole;
    EXPECT_EQ(std::binary_search(bound.triangles.begin(), bound.triangles.end(), back), hole > 0.25f) << hole;
    const auto place =
        opaquePlace({0.02, 0.01, 0}, {0.02, 0.01, 6}, voxels.all.lattice, innerVoxels(voxels, cell));
    ASSERT_EQ(place.has_value(), hole < 0.25f) << hole;
    if (place) {
      EXPECT_NEAR(place->z, 3.25 + 0.125, 0.2);
    }
  }
}

// The opaque voxels, and those next to them.
BlockedSpace grown(const BlockedSpace& space) {
  BlockedSpace result(space.blocks());
  const glm::ivec3 low = 64 * space.blocks().low, high = 64 * space.blocks().high + 63;
  OpenBlock open;
  for (int z = space.blocks().low.z; z <= space.blocks().high.z; ++z) {
    for (int y = space.blocks().low.y; y <= space.blocks().high.y; ++y) {
      for (int x = space.blocks().low.x; x <= space.blocks().high.x; ++x) {
        open.assign({});
        for (int i = 0; i < 64 * 64 * 64; ++i) {
          const glm::ivec3 at(i & 63, (i >> 6) & 63, i >> 12), voxel = 64 * glm::ivec3(x, y, z) + at;
          bool near = false;
          for (int k = 0; k < 27 && !near; ++k) {
            near = space.contains(glm::clamp(voxel + glm::ivec3(k % 3, k / 3 % 3, k / 9) - 1, low, high));
          }
          if (near) open.insert(at, 1);
        }
        result.set({x, y, z}, Share::kSome, open.packed());
      }
    }
  }
  return result;
}

TEST(BoundCell, OccludersTooLargeByAVoxelAreFound) {
  uint64_t faults = 0;
  for (uint32_t seed = 1; seed <= 2; ++seed) {
    Random random(seed);
    const Scene scene = randomTown(random);
    const BoundScene voxels = voxelsOf(scene);
    const ViewCell cell = cellsOfTown()[0];
    const CellBound bound = boundCell(voxels, cell, grown(innerVoxels(voxels, cell)));
    faults += Onlooker(scene).look(voxels, cell, bound.triangles, 40, random).faults.size();
  }
  EXPECT_GT(faults, 0u);
}

// The umbra of a box in closed form: all points from which the segments to the cell's corners meet the box.
// It is convex, as the corners of one cell decide for all its points: from a point, what a convex box hides
// is convex.
class Umbra {
 public:
  Umbra(const ViewCell& cell, const glm::dvec3& low, const glm::dvec3& high) : low_(low), high_(high) {
    const CellFrame frame = cellFrame(cell);
    for (int i = 0; i < 8; ++i) {
      const glm::dvec3 sign(2 * (i & 1) - 1, (i & 2) - 1, (i & 4) / 2 - 1);
      corners_.push_back(frame.toWorld(sign * frame.half_size));
    }
  }
  bool holds(const glm::dvec3& place) const {
    return std::all_of(corners_.begin(), corners_.end(),
                       [&](const glm::dvec3& c) { return meets(c, place); });
  }
  bool holdsCube(const glm::dvec3& low, double size) const {
    for (int i = 0; i < 8; ++i) {
      if (!holds(low + glm::dvec3(i & 1, (i >> 1) & 1, i >> 2) * size)) return false;
    }
    return true;
  }

 private:
  bool meets(const glm::dvec3& from, const glm::dvec3& to) const {
    double enter = 0, leave = 1;
    for (int axis = 0; axis < 3; ++axis) {
      const double way = to[axis] - from[axis];
      if (way == 0) {
        if (from[axis] < low_[axis] || from[axis] > high_[axis]) return false;
        continue;
      }
      const double a = (low_[axis] - from[axis]) / way, b = (high_[axis] - from[axis]) / way;
      enter = std::max(enter, std::min(a, b));
      leave = std::min(leave, std::max(a, b));
    }
    return enter <= leave;
  }

  glm::dvec3 low_, high_;
  std::vector<glm::dvec3> corners_;
};

struct UmbraCounts {
  uint64_t false_hidden = 0;  ///< not all of the voxel is in the umbra
  uint64_t missed = 0;        ///< all of it, and of its neighbours
  uint64_t hidden = 0;
};

// Of a box from `low` to `high` of opaque voxels, in units of voxels, as `shown` says they are.
UmbraCounts countUmbra(const ViewCell& cell, const glm::ivec3& low, const glm::ivec3& high, int grow) {
  const VoxelBox region{glm::ivec3(-32), glm::ivec3(31)};
  BlockedSpace blocked({region.low >> 6, region.high >> 6});
  const glm::ivec3 first = low - grow, last = high + grow;
  for (int b = 0; b < 8; ++b) {
    const glm::ivec3 place = blocked.blocks().low + glm::ivec3(b & 1, (b >> 1) & 1, b >> 2);
    OpenBlock open;
    open.assign({});
    bool any = false;
    for (int i = 0; i < 64 * 64 * 64; ++i) {
      const glm::ivec3 at(i & 63, (i >> 6) & 63, i >> 12), voxel = 64 * place + at;
      if (glm::any(glm::lessThan(voxel, first)) || glm::any(glm::greaterThanEqual(voxel, last))) continue;
      open.insert(at, 1);
      any = true;
    }
    if (any) blocked.set(place, Share::kSome, open.packed());
  }
  const BlockedSpace box = blocked;
  VoxelGrid none;
  HideOptions options;
  options.region = region;
  options.free_side = 1;
  options.surface_side = 1;
  options.part_size = 3;
  hide(CellHull(cell, none.lattice), none, options, blocked);
  const Umbra umbra(cell, glm::dvec3(low), glm::dvec3(high));
  UmbraCounts counts;
  for (int z = region.low.z + 1; z < region.high.z; ++z) {
    for (int y = region.low.y + 1; y < region.high.y; ++y) {
      for (int x = region.low.x + 1; x < region.high.x; ++x) {
        if (box.contains({x, y, z})) continue;
        const bool is_hidden = blocked.contains({x, y, z});
        counts.hidden += is_hidden;
        const glm::dvec3 corner(x, y, z);
        if (is_hidden && !umbra.holdsCube(corner, 1)) ++counts.false_hidden;
        if (!is_hidden && umbra.holdsCube(corner - 1.0, 3)) ++counts.missed;
      }
    }
  }
  return counts;
}

TEST(Hide, IsTheUmbraOfABoxToAVoxel) {
  const std::vector<ViewCell> cells = {
      makeCell({-20, 2.3, 3.1}, {4, 3, 6}), makeCell({-20, 15, 12}, {3, 3, 3}, {30, 20, 10}),
      makeCell({-10, 4, 20}, {0.5, 12, 10}), makeCell({-18, -18, -18}, {6, 6, 6})};
  for (const ViewCell& cell : cells) {
    const UmbraCounts counts = countUmbra(cell, {-2, -6, -4}, {5, 10, 12}, 0);
    EXPECT_EQ(counts.false_hidden, 0u) << cell.center.x;
    EXPECT_GT(counts.hidden, 1000u) << cell.center.x;
    EXPECT_LE(counts.missed, counts.hidden / 50) << cell.center.x << " of " << counts.hidden;
  }
  EXPECT_GT(countUmbra(cells[0], {-2, -6, -4}, {5, 10, 12}, 1).false_hidden, 100u);
}

// Three walls of opaque voxels at different distances, with gaps beside each, hide together what none does.
TEST(Hide, FusesOccluders) {
  SceneOfBoxes boxes;
  boxes.addBox({4, -20, -20}, {8, 20, 1});
  boxes.addBox({8.5, -20, -1}, {12, 20, 20});
  const uint32_t behind = boxes.addRectangle({14, -3, -3}, {0, 6, 0}, {0, 0, 6});
  const Scene scene = boxes.finish();
  const BoundScene voxels = voxelsOf(scene);
  const CellBound bound = boundCell(voxels, makeCell({0, 0, 0}, {2, 2, 2}));
  EXPECT_FALSE(std::binary_search(bound.triangles.begin(), bound.triangles.end(), behind));
  EXPECT_FALSE(std::binary_search(bound.triangles.begin(), bound.triangles.end(), behind + 1));
}

TEST(BoundCell, OpenSheetsHideNothing) {
  SceneOfBoxes boxes;
  boxes.addRectangle({4, -20, -20}, {0, 40, 0}, {0, 0, 40});
  const uint32_t behind = boxes.addRectangle({10, -30, -30}, {0, 60, 0}, {0, 0, 60});
  const Scene scene = boxes.finish();
  const BoundScene voxels = voxelsOf(scene);
  const CellBound bound = boundCell(voxels, makeCell({0, 0, 0}, {2, 2, 2}));
  EXPECT_EQ(bound.opaque_voxels, 0u);
  EXPECT_EQ(bound.triangles.size(), scene.triangleCount());
  EXPECT_TRUE(std::binary_search(bound.triangles.begin(), bound.triangles.end(), behind));
}

// Two closed rooms beside each other with a wall without thickness between them, and a thing in the second.
// From a cell in the first, the second is hidden; from one that sticks through the wall by less than a voxel,
// all of it is seen, though every voxel of the cell there has a triangle in it.
TEST(BoundCell, CellsThroughAWallSeeBothOfItsSides) {
  for (const glm::dvec3& turn : {glm::dvec3(0), glm::dvec3(10, 20, 30)}) {
    SceneOfBoxes boxes;
    boxes.addBox({-4, -2, -2}, {0.02f, 2, 2});
    const uint32_t room = boxes.addBox({0.02f, -2, -2}, {4, 2, 2});
    const uint32_t thing = boxes.addTriangle({3, 0, 0}, {3, 0.5f, 0}, {3, 0, 0.5f});
    const Scene scene = boxes.finish();
    const BoundScene voxels = voxelsOf(scene);
    const double reach = glm::all(glm::equal(turn, glm::dvec3(0))) ? 0.5 : 0.62;
    for (const bool is_through : {false, true}) {
      const ViewCell cell = makeCell({(is_through ? 0.22 : -0.1) - reach, 0, 0}, {1, 0.3, 0.3}, turn);
      const CellBound bound = boundCell(voxels, cell);
      Random random(5);
      const Sightings sightings = Onlooker(scene).look(voxels, cell, bound.triangles, 200, random);
      EXPECT_EQ(sightings.faults, std::vector<std::string>());
      EXPECT_EQ(sightings.leaks, 0u) << is_through;
      for (const uint32_t id : {room + 2, thing}) {  // the far wall, and the thing
        EXPECT_EQ(std::binary_search(bound.triangles.begin(), bound.triangles.end(), id), is_through) << id;
      }
    }
  }
}

// Under a floor that ends with the scene nothing is seen, though a path around the floor's edge leads there.
TEST(BoundCell, TerrainIsSolid) {
  SceneOfBoxes boxes;
  boxes.addRectangle({-10, 0, -10}, {20, 0, 0}, {0, 0, 20});
  const uint32_t under = boxes.addRectangle({-1, -5, -1}, {2, 0, 0}, {0, 0, 2});
  const Scene scene = boxes.finish();
  const BoundScene voxels = voxelsOf(scene);
  const ViewCell cell = makeCell({0, 3, 0}, {2, 2, 2});
  EXPECT_EQ(boundCell(voxels, cell).triangles, (std::vector<uint32_t>{0, 1}));
  EXPECT_EQ(under, 2u);
  // From beside the floor it is seen.
  EXPECT_EQ(boundCell(voxels, makeCell({-14, 3, 0}, {2, 2, 2})).triangles.size(), 4u);
}

// Glass, masks and backs stop no ray.
TEST(BoundCell, SeesThroughWhatRaysPass) {
  for (const uint32_t surface : {0u, kSurfaceGlass, kSurfaceFrontOnly}) {
    SceneOfBoxes boxes;
    const uint32_t room = boxes.addBox({4, -4, -4}, {12, 4, 4});
    const uint32_t inside = boxes.addBox({7, -1, -1}, {9, 1, 1});
    Scene scene = boxes.finish();
    if (surface != 0) {
      scene.surfaces.words.assign(scene.triangles.size(), 0);
      scene.surfaces.words[room] = scene.surfaces.words[room + 1] = surface;
    }
    const BoundScene voxels = voxelsOf(scene);
    const CellBound bound = boundCell(voxels, makeCell({0, 0, 0}, {2, 2, 2}));
    EXPECT_EQ(std::binary_search(bound.triangles.begin(), bound.triangles.end(), inside), surface != 0)
        << surface;
  }
}

// Where triangles are stored once and shown in several places, they are opaque or not in each.
TEST(BoundCell, WallsOfInstancesAreThoseOfThePlainScene) {
  for (uint64_t seed = 1; seed <= 6; ++seed) {
    Scene scene = testing_support::withSurfaces(
        testing_support::randomInstances(seed, 20, seed == 1 ? 1 : 40, 5), seed);
    if (seed == 2) {  // a mesh of which nothing is opaque
      const SceneMesh& mesh = scene.meshes[0];
      for (uint32_t i = 0; i < mesh.triangle_count; ++i) {
        scene.surfaces.words[mesh.first_triangle + i] = kSurfaceGlass;
      }
    }
    const Scene flat = flatten(scene);
    const BoundScene got = voxelsOf(scene), wanted = voxelsOf(flat);
    ASSERT_TRUE(got.opaque && wanted.opaque) << seed;
    EXPECT_EQ(got.all.blocks, wanted.all.blocks) << seed;
    EXPECT_EQ(got.opaque->blocks, wanted.opaque->blocks) << seed;
    EXPECT_LT(wanted.opaque->count(), wanted.all.count()) << seed;
  }
}

TEST(BoundCell, HidesWhatIsBehindAFlatCell) {
  SceneOfBoxes boxes;
  const uint32_t before = boxes.addRectangle({-3, -3, 5}, {6, 0, 0}, {0, 6, 0});
  const uint32_t across = boxes.addRectangle({3, -3, -5}, {0, 0, 10}, {0, 6, 0});
  const uint32_t after = boxes.addRectangle({-3, -3, -5}, {6, 0, 0}, {0, 6, 0});
  const Scene scene = boxes.finish();
  const BoundScene voxels = voxelsOf(scene);
  const std::vector<uint32_t> seen = boundCell(voxels, makeCell({0, 0, 0}, {2, 2, 0})).triangles;
  EXPECT_EQ(seen, (std::vector<uint32_t>{before, before + 1, across, across + 1}));
  EXPECT_EQ(after, 4u);
}

TEST(BoundCell, IsTheSameOnAnyThreads) {
  Random random(11);
  const Scene scene = randomTown(random);
  const BoundScene voxels = voxelsOf(scene);
  const ViewCell cell = cellsOfTown()[1];
  const CellBound one = boundCell(voxels, cell);
  for (const size_t threads : {1, 2, 7}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const CellBound other = boundCell(voxels, cell);
    EXPECT_EQ(other.triangles, one.triangles) << threads;
    EXPECT_EQ(other.hidden_voxels, one.hidden_voxels) << threads;
  }
}

TEST(BoundCell, TellsProgressAndStops) {
  Random random(12);
  const Scene scene = randomTown(random);
  const BoundScene voxels = voxelsOf(scene);
  double last = 0;
  BoundOptions options;
  options.progress = [&](double done) {
    EXPECT_GE(done, last);
    last = done;
  };
  boundCell(voxels, cellsOfTown()[0], options);
  EXPECT_DOUBLE_EQ(last, 1);
  const std::atomic<bool> stop{true};
  options.stop = &stop;
  EXPECT_THROW(boundCell(voxels, cellsOfTown()[0], options), Interrupted);
}

// The rectangle holds where segments cross the plane, and no more than rounding and the corners of the set
// around it ask for.
TEST(CellHull, CrossingHoldsAllSegments) {
  Random random(13);
  for (int i = 0; i < 200; ++i) {
    const bool turned = i % 2 == 0;
    const glm::dvec3 angles = turned ? glm::dvec3(random.point(90)) : glm::dvec3(0);
    const glm::dvec3 size = glm::dvec3(random.point(2)) + 2.5;
    const ViewCell cell = makeCell(glm::dvec3(random.point(3)), size, angles);
    const CellHull hull(cell, latticeOf(0.5));
    const CellFrame frame = cellFrame(cell);
    RealBox box;
    box.low = glm::dvec3(random.point(10)) + glm::dvec3(30, 0, 0);
    box.high = box.low + glm::dvec3(random.point(1)) + 1.0;
    const double at = hull.box().high.x + double(random.unit()) * (box.low.x - hull.box().high.x);
    const PlaneRect rect = hull.crossing(box, 0, at);
    PlaneRect found{HUGE_VAL, -HUGE_VAL, HUGE_VAL, -HUGE_VAL};
    for (int k = 0; k < 64; ++k) {
      const glm::dvec3 s(2 * (k & 1) - 1, (k & 2) - 1, (k & 4) / 2 - 1);
      const glm::dvec3 c = 2.0 * frame.toWorld(s * frame.half_size);
      const glm::dvec3 n = glm::mix(box.low, box.high, glm::dvec3((k >> 3) & 1, (k >> 4) & 1, k >> 5));
      const glm::dvec3 p = c + (n - c) * ((at - c.x) / (n.x - c.x));
      found.low_u = std::min(found.low_u, p.y), found.high_u = std::max(found.high_u, p.y);
      found.low_v = std::min(found.low_v, p.z), found.high_v = std::max(found.high_v, p.z);
    }
    const double most = 1e-4;  // faces are rounded to float
    EXPECT_LE(rect.low_u, found.low_u);
    EXPECT_GE(rect.high_u, found.high_u);
    EXPECT_LE(rect.low_v, found.low_v);
    EXPECT_GE(rect.high_v, found.high_v);
    EXPECT_GE(rect.low_u, found.low_u - most);
    EXPECT_LE(rect.high_u, found.high_u + most);
    EXPECT_GE(rect.low_v, found.low_v - most);
    EXPECT_LE(rect.high_v, found.high_v + most);
  }
}

}  // namespace
}  // namespace sightline::bound_test
