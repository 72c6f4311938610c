// Disagreements of devices, kept by a cross-check, as files that show them alone.
#include "core/crosscheck/reproduce.h"

#include <gtest/gtest.h>

#include <fstream>

#include "core/base/error.h"
#include "core/crosscheck/crosscheck.h"
#include "core/formats/load_scene.h"
#include "core/io/file_io.h"
#include "tests/judge/judge_cases.h"
#include "tests/judge/wrong_device.h"
#include "tests/support/temporary_folder.h"

namespace sightline {
namespace {

using judge_test::Random;
using judge_test::WrongDevice;

/// Rays pass the odd triangles.
bool passesOdd(const Ray&, Hit& hit) {
  if (hit.triangle == kNoTriangle || hit.triangle % 2 == 0) return false;
  hit = {0, kNoTriangle};
  return true;
}

/// Many triangles of odd coordinates around a cell.
struct Cloud {
  Scene scene;
  Bvh bvh;
  ViewCell cell{"cell", {0.1, 0, 0}, {0.1, 0.1, 0.1}, {0, 0, 0}};

  Cloud() {
    Random random(11);
    scene = judge_test::soup(random, 3000, 0.3f, 1);
    scene.objects = {{"all", 0, uint32_t(scene.triangles.size())}};
    bvh = buildBvh(scene.positions, scene.triangles);
  }
};

CrosscheckReport compare(const Cloud& cloud, Device& other, uint32_t keep) {
  const auto cpu = makeCpuDevice(cloud.scene, cloud.bvh, {});
  Tracer* const devices[] = {cpu.get(), &other};
  CrosscheckOptions options;
  options.rays = 500;
  options.kinds = {RayKind::kRandom, RayKind::kVertex};
  options.keep_disagreements = keep;
  return crosscheck(cloud.scene, cloud.bvh, std::span(&cloud.cell, 1), devices, *cpu, options);
}

TEST(Reproduce, ACrosscheckKeepsTheFirstDisagreementsAndCountsAll) {
  const Cloud cloud;
  WrongDevice wrong(cloud.scene, cloud.bvh, passesOdd);
  const CrosscheckReport report = compare(cloud, wrong, 7);
  EXPECT_EQ(report.disagreements.count, wrong.changed());
  EXPECT_GT(report.disagreements.illegal, 100u);
  ASSERT_EQ(report.disagreements.rays.size(), 7u);
  for (const CheckedRay& ray : report.disagreements.rays) {
    EXPECT_TRUE(ray.answers.differ());
    EXPECT_FALSE(ray.answers.legal()) << "those that are more than rounding come first";
    EXPECT_EQ(ray.kind, RayKind::kRandom);
  }
  EXPECT_EQ(compare(cloud, wrong, 0).disagreements.rays.size(), 0u);
}

TEST(Reproduce, FewTrianglesAroundTheRayAreEnough) {
  const Cloud cloud;
  const Judge judge(cloud.scene, cloud.bvh);
  WrongDevice wrong(cloud.scene, cloud.bvh, passesOdd);
  const CrosscheckReport report = compare(cloud, wrong, 20);
  ASSERT_EQ(report.disagreements.rays.size(), 20u);
  const TemporaryFolder folder;
  size_t reproduced = 0;
  for (const CheckedRay& ray : report.disagreements.rays) {
    // On the part, the wrong device passes what has an odd id in the whole.
    std::vector<uint32_t> ids;
    const auto maker = [&](size_t d, const Scene& part, const Bvh& tree) -> std::unique_ptr<Tracer> {
      if (d == 0) return makeCpuDevice(part, tree, {});
      ids.clear();
      for (const glm::uvec3& t : part.triangles) {
        for (uint32_t i = 0; i < cloud.scene.triangles.size(); ++i) {
          if (cloud.scene.positions[cloud.scene.triangles[i].x] == part.positions[t.x]) ids.push_back(i);
        }
      }
      return std::make_unique<WrongDevice>(part, tree, [&](const Ray&, Hit& hit) {
        if (hit.triangle == kNoTriangle || ids[hit.triangle] % 2 == 0) return false;
        hit = {0, kNoTriangle};
        return true;
      });
    };
    const Reproducer its = findReproducer(cloud.scene, judge, ray.answers, maker);
    EXPECT_LE(its.triangles.size(), 20u) << "of 3000; all that the ray passes, as it may go on";
    EXPECT_EQ(its.triangles[its.answers.hits[0].triangle], ray.answers.hits[0].triangle);
    EXPECT_EQ(its.answers.exact.triangles.size(), ray.answers.exact.triangles.size());
    reproduced += its.reproduces;

    // The file holds the same floats, and says it all.
    const ReproducerHead head{"random ray 1 of cell a\nb", "cloud\n.obj", {"cpu", "wrong"}, "d.obj", ""};
    const std::string text = reproducerText(head, its);
    saveText(text, folder / "d.obj");
    const Scene read = loadScene(folder / "d.obj");
    EXPECT_EQ(hashScene(read), hashScene(its.scene)) << text;
    EXPECT_NE(text.find("# random ray 1 of cell a b, scene cloud .obj\n"), std::string::npos) << text;
    EXPECT_NE(text.find("# wrong: nothing (missed)\n"), std::string::npos) << text;
    EXPECT_NE(text.find(" --devices cpu,wrong\n"), std::string::npos) << text;
  }
  EXPECT_EQ(reproduced, 20u);
}

TEST(Reproduce, SaysWhereTheTrianglesAloneDoNotShowIt) {
  const Cloud cloud;
  WrongDevice wrong(cloud.scene, cloud.bvh, passesOdd);
  const CrosscheckReport report = compare(cloud, wrong, 1);
  const auto honest = [](size_t, const Scene& part, const Bvh& tree) {
    return makeCpuDevice(part, tree, {});
  };
  const Reproducer its = findReproducer(cloud.scene, Judge(cloud.scene, cloud.bvh),
                                        report.disagreements.rays[0].answers, honest);
  EXPECT_FALSE(its.reproduces);
  const std::string text = reproducerText({"ray", "cloud.obj", {"cpu", "other"}, "d.obj", ""}, its);
  EXPECT_NE(text.find("it does NOT reproduce. On the whole scene:\n"), std::string::npos) << text;
  EXPECT_NE(text.find("# other: nothing (missed)\n"), std::string::npos) << "as it was there: " << text;
}

TEST(Reproduce, TakesANewOrEmptyFolderAndRemovesNothingElse) {
  const TemporaryFolder folder;
  const std::filesystem::path made = folder / "made";
  prepareReproducerFolder(made, false, {});
  prepareReproducerFolder(made, false, {});
  std::ofstream(made / "mine.obj") << "v 0 0 0\n";
  std::ofstream(made / reproducerName(0)) << "v 0 0 0\n";
  EXPECT_EQ(reproducerName(0), "disagreement-0001.obj");
  EXPECT_THROW(prepareReproducerFolder(made, false, {}), Error);
  const std::filesystem::path inputs[] = {made / reproducerName(0)};
  EXPECT_THROW(prepareReproducerFolder(made, true, inputs), Error) << "the scene itself would go";
  EXPECT_THROW(prepareReproducerFolder(made / "mine.obj", true, {}), Error);
  prepareReproducerFolder(made, true, {});
  EXPECT_EQ(removeReproducers(made), 1u);
  EXPECT_TRUE(std::filesystem::exists(made / "mine.obj"));
}

}  // namespace
}  // namespace sightline
