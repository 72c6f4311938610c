// The library as one calls it: core/api.
#include "core/api/session.h"

#include <gtest/gtest.h>

#include <limits>
#include <thread>
#include <type_traits>

#include "core/api/bake.h"
#include "core/api/session_parts.h"
#include "core/base/error.h"
#include "core/pvs/cell_summary.h"
#include "core/pvs/visible_from.h"
#include "tests/support/bake_scene.h"
#include "tests/support/boxes.h"
#include "tests/support/temporary_folder.h"

namespace sightline {
namespace {

using testing_support::bakeOn;
using testing_support::quickParams;
using testing_support::SceneOfBoxes;

static_assert(std::is_nothrow_move_constructible_v<Session> && std::is_nothrow_move_assignable_v<Session>);
static_assert(!std::is_copy_constructible_v<Session> && !std::is_copy_assignable_v<Session>);

/// A room with a pillar in it, and a block behind the wall.
Scene room() {
  SceneOfBoxes boxes;
  boxes.addBox({-5, 0, -5}, {5, 3, 5});
  boxes.addBox({2, 0.5f, 2}, {2.5f, 1, 2.5f});
  boxes.addBox({-50, -1, 6}, {50, 40, 7});
  return boxes.finish();
}

BakeParams fewRays() {
  BakeParams params = quickParams();
  params.n_rand = 20'000;
  params.validation_rays = 10'000;
  return params;
}

std::vector<ViewCell> threeCells() {
  return {{"west", {-3, 1.5, 0}, {1, 1, 1}},
          {"middle", {0, 1.5, 0}, {1, 1, 1}},
          {"outside", {0, 9, 0}, {1, 1, 1}}};
}

std::string errorOf(auto&& work) {
  try {
    work();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(Session, BakesWhatBakeCellDoes) {
  for (const std::string device : {"cpu", "opencl"}) {
    Session session(room(), {.device = device, .scene_name = "room"});
    const PvsFile pvs = bake(session, threeCells(), fewRays(), {}, Witnesses::kKeep);
    EXPECT_EQ(pvs.planned, threeCells());
    EXPECT_EQ(pvs.scene_hash, hashScene(room()));
    EXPECT_EQ(pvs.scene_name, "room");
    EXPECT_TRUE(pvs.device.starts_with(device)) << pvs.device;
    ASSERT_EQ(pvs.cells.size(), 3u);
    const Scene scene = room();
    const Bvh bvh = buildBvh(scene.positions, scene.triangles);
    const auto reference = makeDevice("cpu", scene, bvh);
    for (uint32_t i = 0; i < 3; ++i) {
      const CellPvs expected = bakeCell(*reference, scene, threeCells()[i], i, fewRays());
      EXPECT_EQ(pvs.cells[i].triangles, expected.triangles) << device << " cell " << i;
      ASSERT_EQ(pvs.cells[i].witnesses.size(), expected.witnesses.size());
      EXPECT_EQ(pvs.cells[i].stats.random.rays, expected.stats.random.rays);
      EXPECT_EQ(pvs.cells[i].device, pvs.device);
    }
    EXPECT_EQ(cellAt(pvs, {0, 1.5, 0.5}), &pvs.cells[1]);
  }
}

TEST(Session, AFileHoldsWhatMemoryDoes) {
  const TemporaryFolder folder;
  Session session(room());
  const PvsFile memory = bake(session, threeCells(), fewRays());
  ASSERT_TRUE(bakeToFile(session, threeCells(), {.file = folder / "x.pvs"}, fewRays()));
  const PvsFile file = loadPvs(folder / "x.pvs");
  EXPECT_EQ(hashResult(summarize(file)), hashResult(summarize(memory)));
  EXPECT_EQ(file.device, memory.device);
  EXPECT_EQ(file.intersector, memory.intersector);
  EXPECT_FALSE(file.has_witnesses);
  EXPECT_TRUE(file.cells[0].witnesses.empty());
  savePvs(memory, folder / "y.pvs");
  EXPECT_EQ(hashResult(summarize(loadPvs(folder / "y.pvs"))), hashResult(summarize(memory)));
}

TEST(Session, AStoppedBakeKeepsItsCellsAndAFileGoesOn) {
  const TemporaryFolder folder;
  Session session(room());
  const PvsFile whole = bake(session, threeCells(), fewRays());
  std::atomic<bool> stop{false};
  std::vector<uint32_t> done, grown;
  BakeEvents events;
  events.stop = &stop;
  events.cell_done = [&](uint32_t index, const CellPvs& cell) {
    EXPECT_EQ(cell.triangles, whole.cells[index].triangles);
    done.push_back(index);
    stop = true;
  };
  events.grown = [&](uint32_t index, const BakeTrace& trace) {
    EXPECT_FALSE(trace.curve.empty());
    grown.push_back(index);
  };
  const PvsFile part = bake(session, threeCells(), fewRays(), events);
  EXPECT_EQ(part.cells.size(), 1u);
  EXPECT_EQ(part.planned.size(), 3u);
  EXPECT_EQ(bake(session, threeCells(), fewRays(), events).cells.size(), 0u);  // stopped before it began

  stop = false;
  const BakeOutput output{.file = folder / "x.pvs"};
  EXPECT_FALSE(bakeToFile(session, threeCells(), output, fewRays(), events));
  EXPECT_FALSE(std::filesystem::exists(output.file));
  events.stop = nullptr;
  EXPECT_TRUE(bakeToFile(session, threeCells(), output, fewRays(), events));
  EXPECT_EQ(done, (std::vector<uint32_t>{0, 0, 1, 2}));
  EXPECT_EQ(grown, done);
  EXPECT_EQ(hashResult(summarize(loadPvs(output.file))), hashResult(summarize(whole)));

  Session closed(room());
  EXPECT_TRUE(bakeToFile(closed, threeCells(), output, fewRays()));  // complete
  EXPECT_FALSE(closed.parts().isOpen());
  BakeParams other = fewRays();
  other.seed = 99;
  EXPECT_NE(errorOf([&] { bakeToFile(closed, threeCells(), output, other); }).find("seed"),
            std::string::npos);
}

/// The device refers to scene and tree, which must not move with the session.
TEST(Session, WorksAfterAMove) {
  Session first(room());
  const uint64_t before = hashResult(summarize(bake(first, threeCells(), fewRays())));
  const Scene* scene = &first.scene();
  Session second(std::move(first));
  EXPECT_EQ(&second.scene(), scene);
  first = Session(room());
  std::swap(first, second);
  EXPECT_EQ(hashResult(summarize(bake(first, threeCells(), fewRays()))), before);
  EXPECT_EQ(hashResult(summarize(bake(second, threeCells(), fewRays()))), before);
}

TEST(Session, BakesByEveryMethodAndTracesRaysBetween) {
  Session session(room());
  const PvsFile plain = bake(session, threeCells(), fewRays());
  BakeParams naive = fewRays();
  naive.method = Method::kNaive;
  EXPECT_EQ(hashResult(summarize(bake(session, threeCells(), naive))), hashResult(summarize(plain)));
  Hit hits[2];
  const Ray rays[2] = {{vec4(0, 1, 0, 0), vec4(1, 0, 0, 0)}, {vec4(0, 100, 0, 0), vec4(0, 1, 0, 0)}};
  session.traceRays(rays, hits);
  EXPECT_EQ(hits[0].t, 5.0f);
  EXPECT_EQ(hits[1].triangle, kNoTriangle);
  EXPECT_EQ(hashResult(summarize(bake(session, threeCells(), fewRays()))), hashResult(summarize(plain)));
}

TEST(Session, OfDifferentThreadsWorkAtTheSameTime) {
  uint64_t hashes[2] = {1, 2};
  std::vector<std::thread> threads;
  for (uint64_t& hash : hashes) {
    threads.emplace_back([&hash] {
      Session session(room());
      hash = hashResult(summarize(bake(session, threeCells(), fewRays())));
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(hashes[0], hashes[1]);
}

TEST(Session, RefusesWhatCannotBeBakedBeforeItIsOpened) {
  Session session(room());
  const auto refused = [&](std::span<const ViewCell> cells, const BakeParams& params) {
    return errorOf([&] { bake(session, cells, params); });
  };
  EXPECT_NE(refused({}, fewRays()).find("at least one view cell"), std::string::npos);
  std::vector<ViewCell> twice = threeCells();
  twice[2].name = "west";
  EXPECT_NE(refused(twice, fewRays()).find("cells[2].name"), std::string::npos);
  BakeParams none = fewRays();
  none.n_rand = 0;
  EXPECT_NE(refused(threeCells(), none).find("n-rand"), std::string::npos);
  none = fewRays();
  none.method = Method::kRaster;
  EXPECT_NE(refused(threeCells(), none).find("raster"), std::string::npos);
  EXPECT_FALSE(session.parts().isOpen());
  Session nowhere(room(), {.device = "abacus"});
  EXPECT_NE(errorOf([&] { nowhere.open(); }).find("abacus"), std::string::npos);
  EXPECT_FALSE(nowhere.parts().isOpen());
}

TEST(Session, RefusesASceneThatIsBroken) {
  const auto refused = [](auto&& harm) {
    Scene scene = room();
    harm(scene);
    return errorOf([&] { Session session(std::move(scene)); });
  };
  EXPECT_EQ(refused([](Scene& scene) { scene.objects.clear(); }), "");
  EXPECT_NE(refused([](Scene& scene) { scene.triangles.clear(); }).find("no triangles"), std::string::npos);
  EXPECT_NE(refused([](Scene& scene) {
              scene.triangles[7].y = uint32_t(scene.positions.size());
            }).find("triangle 7 "),
            std::string::npos);
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), -0x1.1p40f}) {
    EXPECT_NE(
        refused([&](Scene& scene) { scene.positions[scene.triangles[30].z].y = bad; }).find("triangle "),
        std::string::npos);
  }
  EXPECT_NE(refused([](Scene& scene) { scene.objects.front().first_triangle = 1; }).find("object"),
            std::string::npos);
  EXPECT_NE(refused([](Scene& scene) { scene.objects.back().triangle_count -= 1; }).find("objects"),
            std::string::npos);
}

}  // namespace
}  // namespace sightline
