// Witnesses proven, made better, left open and disproved.
#include "core/verify/verify.h"

#include <gtest/gtest.h>

#include "tests/judge/judge_cases.h"
#include "tests/support/bake_scene.h"
#include "tests/support/boxes.h"

namespace sightline {
namespace {

/// A scene, a cell and its set.
struct Case {
  Scene scene;
  Bvh bvh;
  CellPvs pvs;
  explicit Case(Scene s) : scene(std::move(s)), bvh(buildBvh(scene.positions, scene.triangles)) {}
  CellProofs verify() { return verifyCell(Judge(scene, bvh), scene, pvs); }
};

uint64_t count(const CellProofs& proofs, Proof proof) {
  return proofs.counts[size_t(proof)];
}

Case bakedRoom() {
  testing_support::SceneOfBoxes boxes;
  boxes.addBox({-4, -3, -5}, {4, 3, 5});
  boxes.addBox({0, -1, -1}, {1, 1, 1});
  boxes.addBox({-2.2f, -0.1f, -0.1f}, {-2, 0.1f, 0.1f});  // meets the cell
  Case room(boxes.finish());
  const ViewCell cell{"cell", {-2, 0.1, 0.2}, {0.5, 0.6, 0.7}, {10, 20, 30}};
  room.pvs = testing_support::bakeOn("cpu", room.scene, cell);
  return room;
}

TEST(Verify, ProvesABake) {
  Case room = bakedRoom();
  const CellProofs proofs = room.verify();
  EXPECT_GT(count(proofs, Proof::kProven), 15u);
  EXPECT_EQ(count(proofs, Proof::kContained), room.pvs.stats.contained_triangles);
  EXPECT_EQ(count(proofs, Proof::kDisproved), 0u);
  EXPECT_EQ(proofs.provenShare(), 1);
  EXPECT_TRUE(proofs.open.empty());
  EXPECT_EQ(
      count(proofs, Proof::kProven) + count(proofs, Proof::kImproved) + count(proofs, Proof::kContained),
      room.pvs.triangles.size());
}

TEST(Verify, DisprovesWhatIsNotSo) {
  const Case baked = bakedRoom();
  const size_t first = baked.pvs.triangles.size();
  size_t place = 0;
  while (place < first && baked.pvs.witnesses[place].stage == kStageContained) ++place;
  ASSERT_LT(place + 1, first);
  const auto expectDisproved = [&](Fault fault, const char* what, auto&& spoil) {
    Case room = bakedRoom();
    spoil(room);
    const CellProofs proofs = room.verify();
    EXPECT_EQ(count(proofs, Proof::kDisproved), 1u) << what;
    EXPECT_EQ(proofs.faults[size_t(fault)], 1u) << what;
    ASSERT_EQ(proofs.open.size(), 1u) << what;
    EXPECT_EQ(proofs.open[0].triangle, baked.pvs.triangles[place]) << what;
    EXPECT_EQ(proofs.open[0].fault, fault) << what;
    EXPECT_LT(proofs.provenShare(), 1) << what;
  };
  expectDisproved(Fault::kNotMet, "the ray is another triangle's",
                  [&](Case& room) { room.pvs.witnesses[place] = room.pvs.witnesses[place + 1]; });
  expectDisproved(Fault::kOffCell, "the ray begins off the cell", [&](Case& room) {
    Witness& witness = room.pvs.witnesses[place];
    witness.origin -= glm::normalize(witness.direction) * 1.5f;  // out of the cell on its other side
  });
  expectDisproved(Fault::kNoRay, "there is no ray",
                  [&](Case& room) { room.pvs.witnesses[place].direction = vec3(0); });
  expectDisproved(Fault::kNoRay, "not a number",
                  [&](Case& room) { room.pvs.witnesses[place].origin.y = NAN; });
  expectDisproved(Fault::kApart, "it does not meet the cell",
                  [&](Case& room) { room.pvs.witnesses[place].stage = kStageContained; });
}

/// A flat cell that looks along +z; a wall before it (0), one behind it (1), a floor that crosses its plane
/// (2) and a step in the plane (3).
Case corridor() {
  Scene scene;
  judge_test::addTriangle(scene, {-9, -9, 9}, {9, -9, 9}, {0, 9, 9});
  judge_test::addTriangle(scene, {-9, -9, -9}, {9, -9, -9}, {0, 9, -9});
  judge_test::addTriangle(scene, {-9, -2, -9}, {9, -2, -9}, {0, -2, 20});
  judge_test::addTriangle(scene, {3, -1, 0}, {4, -1, 0}, {4, 1, 0});
  Case result(std::move(scene));
  result.pvs.cell = {"flat", {0, 0, 0}, {2, 1, 0}, {0, 0, 0}};
  return result;
}

TEST(Verify, AFlatCellHasNothingBehindIt) {
  Case scene = corridor();
  const vec3 origin(0.25f, 0.125f, 0);
  const auto to = [&](vec3 target) { return Witness{origin, target - origin, kStageBorder}; };
  scene.pvs.triangles = {0, 1, 2};
  scene.pvs.witnesses = {to({0, 0, 9}), to({0, 0, -9}), to({0, -2, 1})};
  CellProofs proofs = scene.verify();
  EXPECT_EQ(count(proofs, Proof::kProven), 2u) << "the floor counts by its front part";
  ASSERT_EQ(proofs.open.size(), 1u);
  EXPECT_EQ(proofs.open[0].triangle, 1u) << "its ray meets it first, but looks backwards";
  EXPECT_EQ(proofs.open[0].fault, Fault::kBehind);
  EXPECT_DOUBLE_EQ(proofs.provenShare(), 2.0 / 3);
  EXPECT_NE(verifyTable({proofs}).find("flat: disproved are 1: it lies behind the flat cell's plane"),
            std::string::npos)
      << verifyTable({proofs});

  scene.pvs.witnesses[2] = to({0, -2, -1});
  proofs = scene.verify();
  EXPECT_EQ(proofs.faults[size_t(Fault::kBackwards)], 1u) << "the floor's part behind the plane is not seen";
  EXPECT_EQ(proofs.faults[size_t(Fault::kBehind)], 1u);
  EXPECT_EQ(verifyJson({proofs})[0]["faults"]["backwards"], 1);
  EXPECT_EQ(verifyJson({proofs})[0]["open"][1]["fault"], "backwards");

  scene.pvs.witnesses[2] = to({0, -2, 1});
  scene.pvs.witnesses[2].origin.z = scene.pvs.witnesses[0].origin.z = -1e-6f;
  EXPECT_EQ(scene.verify().faults[size_t(Fault::kOffCell)], 2u) << "the rays begin behind the cell";

  // Turned about x: what was behind is seen. The step in the plane is seen from neither side.
  scene.pvs.cell.rotation = {180, 0, 0};
  scene.pvs.triangles = {0, 1, 3};
  scene.pvs.witnesses = {to({0, 0, 9}), to({0, 0, -9}), to({3.5f, 0, 0})};
  proofs = scene.verify();
  EXPECT_EQ(proofs.faults[size_t(Fault::kBehind)], 1u) << verifyTable({proofs});
  EXPECT_EQ(proofs.faults[size_t(Fault::kBackwards)], 1u) << "along the plane";
  EXPECT_EQ(count(proofs, Proof::kProven), 1u);
}

TEST(Verify, TakesOutWhatIsDisproved) {
  Case scene = corridor();
  const vec3 origin(0.25f, 0.125f, 0);
  scene.pvs.triangles = {0, 1, 2, 3};
  scene.pvs.witnesses = {{origin, vec3(0, 0, 9) - origin, kStageRandom},
                         {origin, vec3(0, 0, -9) - origin, kStageBorder},
                         {vec3(0), vec3(0), kStageContained},
                         {vec3(0), vec3(0), kStageContained}};
  scene.pvs.stats.contained_triangles = 2;
  removeDisproved(scene.verify(), scene.pvs);  // 2 and 3 do not meet the cell
  EXPECT_EQ(scene.pvs.triangles, std::vector<uint32_t>{0});
  ASSERT_EQ(scene.pvs.witnesses.size(), 1u);
  EXPECT_EQ(scene.pvs.witnesses[0].direction, vec3(0, 0, 9) - origin);
  EXPECT_EQ(scene.pvs.stats.contained_triangles, 0u);
  EXPECT_EQ(scene.verify().provenShare(), 1);
}

/// Bakes of all kinds of cells: nothing in them is against the cell's definition. The flat cells have nothing
/// behind them.
TEST(Verify, AnHonestBakeHasNoFaults) {
  testing_support::SceneOfBoxes boxes;
  boxes.addBox({-4, -3, -5}, {4, 3, 5});
  boxes.addBox({0, -1, -1}, {1, 1, 1});
  boxes.addBox({-1, -2, 2}, {1.3f, -1, 3});
  const Scene room = boxes.finish();
  boxes.addBox({-0.5f, -0.5f, 3}, {0.5f, 0.5f, 4});
  boxes.addRectangle({-9, -9, 9}, {20, 0, 0.5f}, {0, 20, 1});
  const Scene ahead = boxes.finish();
  const struct {
    const Scene& scene;
    ViewCell cell;
  } cases[] = {{room, {"box", {-2, 0.1, 0.2}, {0.5, 0.6, 0.7}, {0, 0, 0}}},
               {room, {"touching", {-0.3, 0.1, 0.2}, {0.6, 0.6, 0.7}, {0, 0, 0}}},
               {room, {"turned", {-2, 0.1, 0.2}, {0.5, 0.6, 0.7}, {10, 20, 30}}},
               {room, {"sheet", {-2, 0.1, 0.2}, {0, 0.6, 0.7}, {0, 0, 0}}},
               {room, {"turned sheet", {-2, 0.1, 0.2}, {0.4, 0, 0.7}, {15, 40, 80}}},
               {ahead, {"flat", {0.1, 0.2, 0.3}, {0.7, 0.9, 0}, {0, 0, 0}}},
               {ahead, {"turned flat", {0.1, 0.2, -0.3}, {0.7, 0.9, 0}, {7, -9, 33}}}};
  for (const auto& its : cases) {
    Case baked(its.scene);
    baked.pvs = testing_support::bakeOn("cpu", baked.scene, its.cell);
    const CellProofs proofs = baked.verify();
    EXPECT_GE(baked.pvs.triangles.size(), 4u) << its.cell.name;
    EXPECT_EQ(count(proofs, Proof::kDisproved), 0u) << verifyTable({proofs});
  }
}

/// A flat cell that looks up at a small triangle, id 0, and a wall behind it, id 1.
Case below() {
  Scene scene;
  judge_test::addTriangle(scene, {0, 0, 5}, {1, 0, 5}, {0, 1, 5});
  judge_test::addTriangle(scene, {-20, -20, 9}, {20, -20, 9}, {0, 20, 9});
  Case result(std::move(scene));
  result.pvs.cell = {"flat", {0, 0, 0}, {2, 2, 0}, {0, 0, 0}};
  return result;
}

TEST(Verify, FindsBetterWitnessesForRoundedOnes) {
  Case scene = below();
  const vec3 origin(0.3f, 0.2f, 0), beside(0.4f, -1e-7f, 5);
  scene.pvs.triangles = {0};
  scene.pvs.witnesses = {{origin, beside - origin, kStageBorder}};
  CellProofs proofs = scene.verify();
  EXPECT_EQ(count(proofs, Proof::kImproved), 1u);
  EXPECT_EQ(proofs.provenShare(), 1);
  EXPECT_EQ(scene.pvs.witnesses[0].stage, kStageBorder);
  EXPECT_NE(scene.pvs.witnesses[0].direction, beside - origin);
  proofs = scene.verify();
  EXPECT_EQ(count(proofs, Proof::kProven), 1u) << "the better witness is one by itself, as the floats it is";
}

TEST(Verify, BetterWitnessesHoldAsTheFloatsTheyAre) {
  // Triangles seen by an edge alone, from odd places: only rays that are floats exactly prove them.
  Scene scene;
  judge_test::addTriangle(scene, {0, 0, 5}, {4, 0, 5}, {0, 4, 5});
  judge_test::addTriangle(scene, {0, 0, 5}, {4, 0, 5}, {0, 2, 7});  // behind it but for their edge
  Case hidden(std::move(scene));
  hidden.pvs.cell = {"flat", {0.7, 1.1, 0}, {0.3, 0.1, 0}, {0, 0, 0}};
  const vec3 origin(0.703125f, 1.123456f, 0), edge(1.3f, 0, 5);
  hidden.pvs.triangles = {1};
  hidden.pvs.witnesses = {{origin, edge + vec3(0, 1e-7f, 0) - origin, kStageRandom}};
  EXPECT_EQ(count(hidden.verify(), Proof::kImproved), 1u);
  EXPECT_EQ(count(hidden.verify(), Proof::kProven), 1u);
}

TEST(Verify, ListsWhatOnlyRoundingShows) {
  // Two halves that touch without a common corner hide the wall; rounding lets a ray between them.
  Scene scene;
  judge_test::addTriangle(scene, {-60, 0, 5}, {60, 0, 5}, {0, 60, 5});
  judge_test::addTriangle(scene, {-70, 0, 5}, {70, 0, 5}, {0, -60, 5});
  judge_test::addTriangle(scene, {-1, -1, 9}, {1, -1, 9}, {0, 1, 9});
  Case crack(std::move(scene));
  crack.pvs.cell = {"flat", {0, 0, 0}, {2, 2, 0}, {0, 0, 0}};
  const vec3 origin(0.1f, 0.2f, 0), gap(0.1f, 0, 5);
  crack.pvs.triangles = {2};
  crack.pvs.witnesses = {{origin, gap - origin, kStageReverse}};
  const CellProofs proofs = crack.verify();
  EXPECT_EQ(count(proofs, Proof::kRounded), 1u);
  ASSERT_EQ(proofs.open.size(), 1u);
  EXPECT_EQ(proofs.open[0].triangle, 2u);
  EXPECT_EQ(proofs.open[0].witness.stage, kStageReverse);
  EXPECT_EQ(proofs.provenShare(), 0);
  EXPECT_NE(verifyTable({proofs}).find("triangle 2 is rounded"), std::string::npos);
  EXPECT_EQ(verifyJson({proofs})[0]["open"][0]["triangle"], 2);
}

/// A ray that passes a tiny triangle, seen edge on, by half a float step: its plane is far from it there.
TEST(Verify, AnEdgeOnTriangleIsNotDisprovedByTheDistanceOfItsPlane) {
  Scene scene;
  scene.positions = {{0x1.376668p+3f, 0x1.40ae3ap-1f, -0x1.b9453p+2f},
                     {0x1.37657p+3f, 0x1.3fc56ep-1f, -0x1.b952dep+2f},
                     {0x1.376d74p+3f, 0x1.4045cep-1f, -0x1.b956b8p+2f}};
  scene.triangles = {{0, 1, 2}};
  const Bvh bvh = buildBvh(scene.positions, scene.triangles);
  CellPvs pvs;
  pvs.cell = {"cell", {0x1.2e334ap+3, 0x1.69272p+1, -0x1.62abaap+2}, {0.1, 0.1, 0.1}, {0, 0, 0}};
  pvs.triangles = {0};
  pvs.witnesses = {{{0x1.2e334ap+3f, 0x1.69272p+1f, -0x1.62abaap+2f},
                    {0x1.2617p-2f, -0x1.1907cap+1f, -0x1.5a6498p+0f},
                    kStageBorder}};
  const CellProofs proofs = verifyCell(Judge(scene, bvh), scene, pvs);
  EXPECT_EQ(proofs.counts[size_t(Proof::kDisproved)], 0u) << verifyTable({proofs});
}

}  // namespace
}  // namespace sightline
