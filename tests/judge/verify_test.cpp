// Witnesses proven, made better, left open and disproved.
#include "core/crosscheck/verify.h"

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
  const auto expectDisproved = [&](const char* what, auto&& spoil) {
    Case room = bakedRoom();
    spoil(room);
    const CellProofs proofs = room.verify();
    EXPECT_EQ(count(proofs, Proof::kDisproved), 1u) << what;
    ASSERT_EQ(proofs.open.size(), 1u) << what;
    EXPECT_EQ(proofs.open[0].triangle, baked.pvs.triangles[place]) << what;
    EXPECT_LT(proofs.provenShare(), 1) << what;
  };
  expectDisproved("the ray is another triangle's",
                  [&](Case& room) { room.pvs.witnesses[place] = room.pvs.witnesses[place + 1]; });
  expectDisproved("the ray does not leave the cell", [&](Case& room) {
    Witness& witness = room.pvs.witnesses[place];
    witness.origin -= glm::normalize(witness.direction) * 1.5f;  // out of the cell on its other side
  });
  expectDisproved("there is no ray", [&](Case& room) { room.pvs.witnesses[place].direction = vec3(0); });
  expectDisproved("not a number", [&](Case& room) { room.pvs.witnesses[place].origin.y = NAN; });
  expectDisproved("it does not meet the cell",
                  [&](Case& room) { room.pvs.witnesses[place].stage = kStageContained; });
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
