// Sets with doors against their definition, in both directions: closed, the set of the whole scene; open,
// what is seen besides where they hide nothing. The latter is that of objects to see through, too: each
// triangle of theirs is in it that is seen where all others of theirs are away, and every other triangle that
// is seen where all of theirs are.
#include <gtest/gtest.h>

#include "core/api/bake.h"
#include "core/gvs/bake_cell.h"
#include "core/pvs/door_state.h"
#include "core/scene/find_objects.h"
#include "tests/definition/definition.h"
#include "tests/support/without_triangles.h"

namespace sightline {
namespace {

using definition_test::Definition;
using testing_support::Random;
using testing_support::withoutTriangles;

constexpr uint32_t kRays = 60'000, kDoors = 6;

/// Triangles all about, of which the first, large ones are doors.
Scene sceneWithDoors(Random& random) {
  Scene scene;
  for (uint32_t i = 0; i < 40; ++i) {
    const float size = i < kDoors ? 4.0f : 0.8f;
    const vec3 a = random.point(4);
    testing_support::addTriangle(scene, a, a + random.point(size), a + random.point(size));
  }
  scene.objects = {{"door-left", 0, 3}, {"door-right", 3, 3}, {"rest", kDoors, 40 - kDoors}};
  return scene;
}

BakeParams quick() {
  BakeParams params;
  params.n_rand = kRays;
  params.validation_rays = 0;
  params.threshold = 1;
  return params;
}

PvsFile bakeDoors(const Scene& scene, const ViewCell& cell) {
  Session session(scene, {.device = "cpu"});
  const std::vector<std::string> patterns = {"door-*"};
  return bake(session, {&cell, 1}, quick(), {}, {Witnesses::kKeep, findObjects(scene, patterns, "--doors")});
}

std::string text(const std::vector<std::string>& lines) {
  std::string all;
  for (const std::string& line : lines) all += line + "\n";
  return all;
}

/// All that is wrong with a set in which the doors hide nothing.
std::string faultsSeenThrough(const Scene& scene, const std::vector<NamedTriangles>& doors,
                              const ViewCell& cell, const CellPvs& set, Random& random) {
  const auto faultsOf = [&](const Scene& part, const auto& isMeant) {
    CellPvs meant;
    meant.cell = cell;
    for (size_t i = 0; i < set.triangles.size(); ++i) {
      if (!isMeant(set.triangles[i])) continue;
      meant.triangles.push_back(set.triangles[i]);
      meant.witnesses.push_back(set.witnesses[i]);
    }
    std::vector<std::string> lines = Definition(part, cell).faults(meant, kRays, 2000, random);
    std::erase_if(lines, [&](const std::string& line) { return !isMeant(uint32_t(std::stoul(line))); });
    return text(lines);
  };
  std::string lines = faultsOf(withoutTriangles(scene, doors), [](uint32_t id) { return id >= kDoors; });
  for (uint32_t door = 0; door < kDoors; ++door) {
    const std::vector<NamedTriangles> others = {{"before", 0, door}, {"after", door + 1, kDoors - 1 - door}};
    lines += faultsOf(withoutTriangles(scene, others), [&](uint32_t id) { return id == door; });
  }
  return lines;
}

TEST(Doors, ClosedAndOpenSetsAreRight) {
  uint64_t added = 0;
  for (uint32_t seed = 1; seed <= 24; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const Scene scene = sceneWithDoors(random);
    const ViewCell cell{"cell", glm::dvec3(random.point(1)), {0.5, 0.6, 0.7}, {}};
    const PvsFile pvs = bakeDoors(scene, cell);
    ASSERT_EQ(pvs.doors.size(), 2u);
    ASSERT_TRUE(pvs.cells[0].open.has_value());
    added += pvs.cells[0].open->triangles.size();
    EXPECT_EQ(text(Definition(scene, cell).faults(pvs.cells[0], kRays, 2000, random)), "");
    EXPECT_EQ(faultsSeenThrough(scene, pvs.doors, cell, inState(pvs.cells[0], DoorState::kOpen), random), "");
  }
  EXPECT_GT(added, 10u) << "doors that hide nothing test nothing";
}

TEST(SeeThrough, SetsAreRight) {
  for (uint32_t seed = 1; seed <= 16; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const Scene scene = sceneWithDoors(random);
    const ViewCell cell{"cell", glm::dvec3(random.point(1)), {0.5, 0.6, 0.7}, {}};
    const std::vector<std::string> patterns = {"door-*"};
    const std::vector<NamedTriangles> objects = findObjects(scene, patterns, "--see-through");
    for (const char* device : {"cpu", "opencl"}) {
      if (seed > 3 && device[0] == 'o') continue;
      Session session(scene, {.device = device, .see_through = objects});
      const PvsFile pvs = bake(session, {&cell, 1}, quick(), {}, Witnesses::kKeep);
      EXPECT_EQ(pvs.see_through, objects);
      EXPECT_EQ(pvs.scene_hash, hashScene(scene)) << "of the file's scene";
      EXPECT_EQ(faultsSeenThrough(scene, objects, cell, pvs.cells[0], random), "") << device;
    }
  }
}

/// The open set adds to the closed one, which is that without --doors, what --see-through finds by the same
/// seed.
TEST(Doors, AreTwoBakesInOne) {
  Random random(5);
  const Scene scene = sceneWithDoors(random);
  const ViewCell cell{"cell", {0, 0, 0}, {0.5, 0.6, 0.7}, {}};
  const PvsFile pvs = bakeDoors(scene, cell);
  Session closed(scene, {.device = "cpu"});
  EXPECT_EQ(bake(closed, {&cell, 1}, quick()).cells[0].triangles, pvs.cells[0].triangles);
  Session open(scene, {.device = "cpu", .see_through = pvs.doors});
  const std::vector<uint32_t> seen = bake(open, {&cell, 1}, quick()).cells[0].triangles;
  std::vector<uint32_t> both;
  std::ranges::set_union(seen, pvs.cells[0].triangles, std::back_inserter(both));
  EXPECT_EQ(inState(pvs.cells[0], DoorState::kOpen).triangles, both);
}

/// A room behind a door: known sets.
TEST(Doors, ARoomBehindADoor) {
  Scene scene;
  const auto square = [&](float z, float size) {
    testing_support::addTriangle(scene, {-size, -size, z}, {size, -size, z}, {-size, size, z});
    testing_support::addTriangle(scene, {size, -size, z}, {size, size, z}, {-size, size, z});
  };
  square(2, 50);  // the door fills the wall
  square(4, 50);  // the room behind
  square(6, 50);  // hidden by it
  scene.objects = {{"hall/door", 0, 2}, {"room", 2, 2}, {"garden", 4, 2}};
  const ViewCell cell{"cell", {0, 0, 0}, {1, 1, 0}, {}};
  Session session(scene, {.device = "cpu"});
  const std::vector<std::string> patterns = {"hall"};
  const PvsFile pvs =
      bake(session, {&cell, 1}, quick(), {}, {Witnesses::kDrop, findObjects(scene, patterns, "d")});
  EXPECT_EQ(pvs.cells[0].triangles, (std::vector<uint32_t>{0, 1}));
  EXPECT_EQ(pvs.cells[0].open->triangles, (std::vector<uint32_t>{2, 3}));
  const auto open = visibleFrom(pvs, {0, 0, 0}, DoorState::kOpen);
  EXPECT_EQ(open->triangles.size() + open->added.size(), 4u);
  EXPECT_TRUE(visibleFrom(pvs, {0, 0, 0}, DoorState::kClosed)->added.empty());
  EXPECT_FALSE(visibleFrom(pvs, {9, 0, 0}, DoorState::kOpen).has_value());
}

TEST(FindObjects, ByPatternAndNodeOrWithNamesThatAreNear) {
  Random random(1);
  const Scene scene = sceneWithDoors(random);
  const auto found = [&](std::vector<std::string> patterns) {
    return findObjects(scene, patterns, "--doors").size();
  };
  EXPECT_EQ(found({}), 0u);
  EXPECT_EQ(found({"door-left"}), 1u);
  EXPECT_EQ(found({"*left", "door*"}), 2u);
  EXPECT_EQ(found({"*"}), 3u);
  EXPECT_EQ(found({"????"}), 1u);
  try {
    found({"dor-left"});
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "--doors: no object of the scene is named dor-left; did you mean door-left?");
    EXPECT_EQ(error.exitCode(), kExitUsage);
  }
  try {
    found({"x*"});
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(),
                 "--doors: no object of the scene is named x*; there are door-left, door-right, rest");
  }
}

}  // namespace
}  // namespace sightline
