// Glass in the judge and in cross-checks: what the judge says rays see against brute force, and devices that
// are wrong about glass in a known way.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "core/crosscheck/crosscheck.h"
#include "core/crosscheck/crosscheck_report.h"
#include "core/crosscheck/reproduce.h"
#include "core/device/cpu/cpu_device.h"
#include "core/device/registry/make_device.h"
#include "core/formats/load_scene.h"
#include "core/io/file_io.h"
#include "tests/support/brute_sight.h"
#include "tests/support/forwarding_device.h"
#include "tests/support/make_cell.h"
#include "tests/support/random_triangles.h"
#include "tests/support/temporary_folder.h"

namespace sightline {
namespace {

/// A closed room of panes before walls, and panes outside that no ray from inside sees.
struct PaneRoom {
  Scene scene;
  Bvh bvh;
  ViewCell cell = testing_support::makeCell({0, 0, 0}, {0.5, 0.4, 0.3});

  explicit PaneRoom(uint32_t seed, bool closed = true) {
    testing_support::Random random(seed);
    if (closed) {
      addWall({-5, -5, -5}, {10, 0, 0}, {0, 10, 0});
      addWall({-5, -5, 5}, {10, 0, 0}, {0, 10, 0});
      addWall({-5, -5, -5}, {0, 0, 10}, {0, 10, 0});
      addWall({5, -5, -5}, {0, 0, 10}, {0, 10, 0});
      addWall({-5, -5, -5}, {10, 0, 0}, {0, 0, 10});
      addWall({-5, 5, -5}, {10, 0, 0}, {0, 0, 10});
    }
    for (int i = 0; i < 40; ++i) {
      vec3 center = random.point(1);
      center = glm::normalize(center) * (i < 30 ? 3.0f : 12.0f);
      testing_support::addTriangle(scene, center + random.point(3.5f), center + random.point(3.5f),
                                   center + random.point(3.5f));
      scene.surfaces.words.push_back(kSurfaceGlass);
    }
    scene.objects = {{"all", 0, scene.triangleCount()}};
    bvh = buildBvh(scene.positions, scene.triangles);
  }

 private:
  void addWall(vec3 corner, vec3 u, vec3 v) {
    const auto first = uint32_t(scene.positions.size());
    scene.positions.insert(scene.positions.end(), {corner, corner + u, corner + u + v, corner + v});
    scene.triangles.emplace_back(first, first + 1, first + 2);
    scene.triangles.emplace_back(first, first + 2, first + 3);
    scene.surfaces.words.insert(scene.surfaces.words.end(), {0u, 0u});
  }
};

/// The cpu device, but for its glass.
class WrongGlass final : public testing_support::ForwardingDevice {
 public:
  using Change = std::function<void(std::vector<SeenThrough>&)>;
  WrongGlass(const Scene& scene, const Bvh& bvh, Change change)
      : ForwardingDevice(makeCpuDevice(scene, bvh, {})), change_(std::move(change)) {}

  DeviceInfo info() const override {
    DeviceInfo info = ForwardingDevice::info();
    info.id = "wrong";
    return info;
  }
  std::vector<SeenThrough> traceGlass(std::span<const Ray> rays, std::span<const Hit> hits) override {
    std::vector<SeenThrough> seen = ForwardingDevice::traceGlass(rays, hits);
    change_(seen);
    std::ranges::sort(seen);
    return seen;
  }

 private:
  Change change_;
};

TEST(GlassJudge, ListsWhatBruteForceSees) {
  for (uint32_t seed = 1; seed <= 3; ++seed) {
    const PaneRoom room(seed, seed > 1);
    const Judge judge(room.scene, room.bvh);
    ASSERT_TRUE(judge.hasGlass());
    testing_support::Random random(seed + 50);
    size_t sure = 0, several = 0;
    for (int i = 0; i < 3000; ++i) {
      const vec3 origin = random.point(0.5f), direction = random.point(1);
      const Ray ray{vec4(origin, 0), vec4(direction, 0)};
      const auto expected = testing_support::bruteSight(room.scene, ray);
      if (!expected.sure) continue;
      ++sure;
      several += expected.glass.size() > 1 ? 1 : 0;
      const ExactHit end = judge.nearest(judgeRay(ray));
      EXPECT_EQ(judge.glassBefore(judgeRay(ray), end), expected.glass) << testing_support::describeRay(ray);
      const Hit hit{float(end.t.low), expected.end};
      EXPECT_EQ(ruleGlass(judge, ray, hit, expected.glass, end).verdict, Verdict::kRight);
    }
    EXPECT_GT(sure, 2900u);
    EXPECT_GT(several, 300u);
  }
}

CrosscheckReport compareGlass(const PaneRoom& room, WrongGlass::Change change, std::vector<RayKind> kinds,
                              uint32_t keep = 0) {
  const auto right = makeCpuDevice(room.scene, room.bvh, {});
  WrongGlass wrong(room.scene, room.bvh, std::move(change));
  Tracer* devices[] = {right.get(), &wrong};
  CrosscheckOptions options;
  options.rays = 3000;
  options.batch_rays = 1000;
  options.kinds = std::move(kinds);
  options.keep_disagreements = keep;
  return crosscheck(room.scene, room.bvh, std::span(&room.cell, 1), devices, *right, options);
}

uint64_t sumOf(const CrosscheckReport& report, size_t device, Verdict verdict) {
  uint64_t sum = 0;
  for (const KindReport& kind : report.kinds) sum += kind.devices[device].verdicts(verdict);
  return sum;
}

uint64_t glassDifferences(const CrosscheckReport& report) {
  uint64_t sum = 0;
  for (const KindReport& kind : report.kinds) {
    const auto& differences = kind.devices[1].differences;
    sum += differences[size_t(Difference::kGlass)];
    for (const Difference other :
         {Difference::kTie, Difference::kEdge, Difference::kMissed, Difference::kWrong}) {
      EXPECT_EQ(differences[size_t(other)], 0u);
    }
  }
  return sum;
}

TEST(GlassCrosscheck, DevicesThatAgreeAreRightOnRaysOfAllKinds) {
  const PaneRoom room(4);
  const auto cpu = makeCpuDevice(room.scene, room.bvh, {});
  const auto opencl = makeDevice("opencl", room.scene, room.bvh);
  Tracer* devices[] = {cpu.get(), opencl.get()};
  CrosscheckOptions options;
  options.rays = 2000;
  options.check_every = 1;
  const CrosscheckReport report =
      crosscheck(room.scene, room.bvh, std::span(&room.cell, 1), devices, *cpu, options);
  EXPECT_TRUE(report.glass);
  EXPECT_EQ(glassDifferences(report), 0u);  // bit for bit
  for (size_t d = 0; d < 2; ++d) {
    EXPECT_EQ(sumOf(report, d, Verdict::kMissed), 0u);
    EXPECT_EQ(sumOf(report, d, Verdict::kWrong), 0u);
    EXPECT_GT(sumOf(report, d, Verdict::kRounded), 0u);  // rays at edges of panes
    for (const KindReport& kind : report.kinds) {
      if (kind.kind == RayKind::kReverse) continue;  // past edges of what is opaque: there are none
      EXPECT_GT(kind.devices[d].glass, 10u) << rayKindName(kind.kind);
    }
  }
  EXPECT_NE(crosscheckTable(report).find("glass"), std::string::npos);
}

TEST(GlassCrosscheck, FindsEachPaneThatIsLost) {
  const PaneRoom room(5);
  uint64_t rays = 0;
  const auto lose = [&](std::vector<SeenThrough>& seen) {
    std::vector<SeenThrough> left;
    for (size_t i = 0; i < seen.size(); ++i) {
      const bool first = i == 0 || seen[i].ray != seen[i - 1].ray;
      const bool lost = first && seen[i].ray % 7 == 0;
      rays += lost ? 1 : 0;
      if (!lost) left.push_back(seen[i]);
    }
    seen = left;
  };
  const CrosscheckReport report = compareGlass(room, lose, {RayKind::kRandom});
  EXPECT_GT(rays, 100u);
  EXPECT_EQ(glassDifferences(report), rays);
  EXPECT_EQ(report.kinds[0].disputed, rays);
  // All but those that pass within rounding of the lost pane's border.
  EXPECT_GE(sumOf(report, 1, Verdict::kMissed) + 2, rays);
  EXPECT_EQ(sumOf(report, 1, Verdict::kWrong), 0u);
  EXPECT_EQ(sumOf(report, 0, Verdict::kMissed) + sumOf(report, 0, Verdict::kWrong), 0u);
  CrosscheckLimits limits;
  limits.missed = 0;
  EXPECT_EQ(pastLimits(report, limits).size(), 1u);
}

TEST(GlassCrosscheck, FindsPanesThatAreNotMetOrBehindWhatEndsTheRay) {
  const PaneRoom room(6);
  const uint32_t outside = room.scene.triangleCount() - 1, wall = 0;
  for (const uint32_t added : {outside, wall, room.scene.triangleCount()}) {
    uint64_t rays = 0;
    const auto add = [&](std::vector<SeenThrough>& seen) {
      for (uint32_t ray = 0; ray < 1000; ray += 9, ++rays) seen.push_back({ray, added});
    };
    const CrosscheckReport report = compareGlass(room, add, {RayKind::kRandom});
    EXPECT_EQ(glassDifferences(report), rays) << added;
    EXPECT_EQ(sumOf(report, 1, Verdict::kWrong), rays) << added;
    EXPECT_EQ(sumOf(report, 0, Verdict::kMissed) + sumOf(report, 0, Verdict::kWrong), 0u);
  }
}

TEST(GlassCrosscheck, ReproducersKeepTheirGlass) {
  const PaneRoom room(7);
  const CrosscheckReport report = compareGlass(
      room, [](std::vector<SeenThrough>& seen) { seen.clear(); }, {RayKind::kRandom}, 3);
  ASSERT_EQ(report.disagreements.rays.size(), 3u);
  const Judge judge(room.scene, room.bvh);
  const TemporaryFolder folder;
  for (const CheckedRay& ray : report.disagreements.rays) {
    const auto maker = [](size_t d, const Scene& part, const Bvh& tree) -> std::unique_ptr<Tracer> {
      if (d == 0) return makeCpuDevice(part, tree, {});
      return std::make_unique<WrongGlass>(part, tree, [](std::vector<SeenThrough>& seen) { seen.clear(); });
    };
    const Reproducer its = findReproducer(room.scene, judge, ray.answers, maker);
    EXPECT_TRUE(its.reproduces);
    EXPECT_TRUE(its.answers.differ());
    ReproducerHead head;
    head.devices = {"cpu", "wrong"};
    const std::string text = reproducerText(head, its);
    EXPECT_NE(text.find("through glass"), std::string::npos);
    const auto file = folder / reproducerName(0);
    saveText(text, file);
    saveText(materialsText(), folder / kMaterialsName);
    const Scene read = loadScene(file);
    EXPECT_EQ(read.surfaces.words, its.scene.surfaces.words);
  }
}

}  // namespace
}  // namespace sightline
