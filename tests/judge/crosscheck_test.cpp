// Cross-checks with devices that are wrong in a known way: each wrong answer is found, classed as what it is
// and given to the other device.
#include "core/crosscheck/crosscheck.h"

#include <gtest/gtest.h>

#include <atomic>

#include "core/crosscheck/crosscheck_report.h"
#include "tests/judge/judge_cases.h"
#include "tests/judge/wrong_device.h"
#include "tests/support/boxes.h"

namespace sightline {
namespace {

using judge_test::WrongDevice;

/// A closed room with a box in it, and a copy of that box's triangles.
struct Room {
  Scene scene;
  Bvh bvh;
  ViewCell cell{"cell", {-2, 0.1, 0.2}, {0.5, 0.6, 0.7}, {0, 0, 0}};
  uint32_t box = 0, copy = 0;

  Room() {
    testing_support::SceneOfBoxes boxes;
    boxes.addBox({-4, -3, -5}, {4, 3, 5});
    box = boxes.addBox({0, -1, -1}, {1, 1, 1});
    copy = boxes.addBox({0, -1, -1}, {1, 1, 1});
    scene = boxes.finish();
    bvh = buildBvh(scene.positions, scene.triangles);
  }
};

/// Everything about one wrong device: the first is the cpu.
struct Outcome {
  CrosscheckReport report;
  uint64_t changed = 0;

  uint64_t differences(size_t device, Difference difference) const {
    uint64_t sum = 0;
    for (const KindReport& kind : report.kinds) sum += kind.devices[device].differences[size_t(difference)];
    return sum;
  }
  uint64_t verdicts(size_t device, Verdict verdict) const {
    uint64_t sum = 0;
    for (const KindReport& kind : report.kinds) sum += kind.devices[device].verdicts(verdict);
    return sum;
  }
};

Outcome compareWith(const Room& room, std::vector<RayKind> kinds, WrongDevice::Change change,
                    uint64_t check_every = 50) {
  const auto right = makeCpuDevice(room.scene, room.bvh, {});
  WrongDevice wrong(room.scene, room.bvh, std::move(change));
  Tracer* devices[] = {right.get(), &wrong};
  CrosscheckOptions options;
  options.rays = 3000;
  options.batch_rays = 1000;
  options.kinds = std::move(kinds);
  options.check_every = check_every;
  Outcome outcome;
  outcome.report = crosscheck(room.scene, room.bvh, std::span(&room.cell, 1), devices, *right, options);
  outcome.changed = wrong.changed();
  uint64_t rays = 0;
  for (const KindReport& kind : outcome.report.kinds) rays += kind.rays;
  EXPECT_EQ(outcome.differences(0, Difference::kSame), rays);
  EXPECT_EQ(outcome.verdicts(0, Verdict::kMissed) + outcome.verdicts(0, Verdict::kWrong), 0u);
  return outcome;
}

/// Share of the edges of `hit`'s triangle that the point is away from its nearest corner.
bool atCorner(const Room& room, const Ray& ray, const Hit& hit) {
  const glm::uvec3 t = room.scene.triangles[hit.triangle];
  const vec3 point = vec3(ray.origin) + vec3(ray.direction) * hit.t;
  for (int i = 0; i < 3; ++i) {
    if (maxAbs3(room.scene.positions[t[i]] - point) < 1e-5f) return true;
  }
  return false;
}

TEST(Crosscheck, DevicesThatAgreeDifferInNothing) {
  const Room room;
  const Outcome outcome = compareWith(
      room, {}, [](const Ray&, Hit&) { return false; }, 1);
  ASSERT_EQ(outcome.report.kinds.size(), kRayKinds);
  for (const KindReport& kind : outcome.report.kinds) {
    const std::string name = rayKindName(kind.kind);
    EXPECT_EQ(kind.disputed, 0u) << name;
    EXPECT_EQ(kind.checked, kind.rays) << name;
    EXPECT_EQ(kind.devices[1].differences[size_t(Difference::kSame)], kind.rays) << name;
    EXPECT_GE(kind.rays, 1500u) << name;  // reverse rays behind their occluder are left out
    EXPECT_GE(kind.devices[1].hits, kind.rays / 2) << name;
  }
  EXPECT_EQ(outcome.verdicts(1, Verdict::kMissed) + outcome.verdicts(1, Verdict::kWrong), 0u);
}

TEST(Crosscheck, StopsWithinABatchAndReportsWhatWasJudged) {
  const Room room;
  const auto device = makeCpuDevice(room.scene, room.bvh, {});
  Tracer* devices[] = {device.get()};
  CrosscheckOptions options;
  options.rays = 100'000;
  options.kinds = {RayKind::kRandom, RayKind::kVertex};
  std::atomic<bool> stop = false;
  uint64_t last = 0;
  const auto stopSoon = [&](RayKind, uint64_t done, uint64_t due) {
    EXPECT_EQ(due, 200'000u);
    last = done;
    stop = done > 0;
  };
  const CrosscheckReport report =
      crosscheck(room.scene, room.bvh, std::span(&room.cell, 1), devices, *device, options, stopSoon, &stop);
  EXPECT_GT(last, 0u);
  EXPECT_LE(last, 4096u);
  EXPECT_EQ(report.kinds[0].rays, last);
  EXPECT_EQ(report.kinds[1].rays, 0u);
}

TEST(Crosscheck, FindsEachRayLostAtACorner) {
  const Room room;
  const Outcome outcome =
      compareWith(room, {RayKind::kVertex, RayKind::kRandom}, [&](const Ray& ray, Hit& hit) {
        // Only at the room's own corners: no ray may pass there.
        if (hit.triangle >= room.box || !atCorner(room, ray, hit)) return false;
        hit = {0, kNoTriangle};
        return true;
      });
  EXPECT_GT(outcome.changed, 500u);
  EXPECT_EQ(outcome.differences(1, Difference::kMissed), outcome.changed);
  EXPECT_EQ(outcome.verdicts(1, Verdict::kMissed), outcome.changed);
  EXPECT_EQ(outcome.verdicts(1, Verdict::kWrong), 0u);
}

TEST(Crosscheck, FindsRaysThatPassTheFirstTriangle) {
  const Room room;
  const auto tracer = makeCpuDevice(room.scene, room.bvh, {});
  int number = 0;
  const Outcome outcome = compareWith(room, {RayKind::kRandom}, [&](const Ray& ray, Hit& hit) {
    if (++number % 7 != 0 || hit.triangle < room.box) return false;
    Ray beyond = ray;
    beyond.origin += beyond.direction * (hit.t * 1.001f);
    Hit next;
    tracer->traceRays({&beyond, 1}, {&next, 1});
    if (next.triangle == kNoTriangle) return false;
    hit = {next.t + hit.t * 1.001f, next.triangle};
    return true;
  });
  EXPECT_GT(outcome.changed, 10u);
  EXPECT_EQ(outcome.differences(1, Difference::kWrong), outcome.changed);
  EXPECT_EQ(outcome.verdicts(1, Verdict::kMissed), outcome.changed);
}

TEST(Crosscheck, FindsTrianglesThatAreNotThereAndDistancesThatAreOff) {
  const Room room;
  int number = 0;
  const Outcome outcome = compareWith(
      room, {RayKind::kRandom},
      [&](const Ray&, Hit& hit) {
        if (++number % 5 != 0) return false;
        if (number % 10 == 0) hit.t *= 1.0001f;
        if (number % 10 == 5) hit = {hit.t * 0.5f, (hit.triangle + 6) % 12};
        return true;
      },
      1);
  EXPECT_EQ(outcome.changed, 600u);
  EXPECT_EQ(outcome.verdicts(1, Verdict::kWrong), outcome.changed);
  EXPECT_GT(outcome.report.kinds[0].devices[1].ulps.max(), 800);
  EXPECT_LT(outcome.report.kinds[0].devices[0].ulps.max(), 20);
}

TEST(Crosscheck, TellsTiesAndNeighboursFromMistakes) {
  const Room room;
  const auto copied = compareWith(room, {RayKind::kRandom}, [&](const Ray&, Hit& hit) {
    if (hit.triangle < room.box || hit.triangle >= room.copy) return false;
    hit.triangle += room.copy - room.box;
    return true;
  });
  EXPECT_GT(copied.changed, 50u);
  EXPECT_EQ(copied.differences(1, Difference::kTie), copied.changed);
  EXPECT_EQ(copied.verdicts(1, Verdict::kMissed) + copied.verdicts(1, Verdict::kWrong), 0u);

  // The other triangle of the wall's rectangle, for rays at their common diagonal.
  const Judge judge(room.scene, room.bvh);
  const auto neighbour = compareWith(room, {RayKind::kEdge}, [&](const Ray& ray, Hit& hit) {
    const uint32_t other = hit.triangle ^ 1u;
    if (hit.triangle >= room.box || std::fabs(hit.t - 1) > 1e-6f) return false;
    const bool diagonal =
        !judge.meets(judgeRay(ray), other)
            ? rule(judge, ray, {hit.t, other}, judge.nearest(judgeRay(ray))).verdict == Verdict::kRounded
            : true;
    if (diagonal) hit.triangle = other;
    return diagonal;
  });
  EXPECT_GT(neighbour.changed, 100u);
  EXPECT_EQ(neighbour.differences(1, Difference::kEdge), neighbour.changed);
  EXPECT_EQ(neighbour.verdicts(1, Verdict::kMissed) + neighbour.verdicts(1, Verdict::kWrong), 0u);
  EXPECT_GT(neighbour.verdicts(1, Verdict::kRounded), 0u);
}

TEST(Crosscheck, GivesTheSameReportEveryTime) {
  const Room room;
  const auto change = [](const Ray& ray, Hit& hit) {
    if (hit.t * ray.direction.x > 3) hit.triangle = kNoTriangle;
    return hit.t * ray.direction.x > 3;
  };
  const auto text = [&](CrosscheckReport report) {
    report.trace_seconds = report.judge_seconds = 0;
    return crosscheckJson({}, report).dump() + crosscheckTable(report);
  };
  const std::string first = text(compareWith(room, {}, change).report);
  EXPECT_EQ(text(compareWith(room, {}, change).report), first);
  EXPECT_NE(first.find("missed"), std::string::npos);
}

TEST(Crosscheck, LimitsCountOverAllKinds) {
  CrosscheckReport report;
  report.devices.resize(2);
  report.devices[1].id = "b";
  for (int k = 0; k < 2; ++k) {
    KindReport kind;
    kind.devices.resize(2);
    kind.devices[1].disputed[size_t(Verdict::kWrong)] = 2;
    kind.devices[1].checked[size_t(Verdict::kMissed)] = 1;
    kind.devices[1].differences[size_t(Difference::kTie)] = 5;
    kind.devices[1].ulps.add(7);
    report.kinds.push_back(kind);
  }
  CrosscheckLimits limits;
  EXPECT_TRUE(pastLimits(report, limits).empty());
  limits = {.wrong = 4, .missed = 2, .rounded = 0, .differences = 10, .ulps = 7};
  EXPECT_TRUE(pastLimits(report, limits).empty());
  limits = {.wrong = 3, .missed = 1, .rounded = 0, .differences = 9, .ulps = 6.5};
  EXPECT_EQ(pastLimits(report, limits).size(), 4u);
  EXPECT_EQ(pastLimits(report, limits)[0], "b: 4 wrong, at most 3 allowed");
}

TEST(ErrorHistogram, PercentilesAreAtMostAQuarterOctaveAbove) {
  ErrorHistogram errors;
  EXPECT_EQ(errors.percentile(0.5), 0);
  for (int i = 1; i <= 1000; ++i) errors.add(i);
  EXPECT_EQ(errors.count(), 1000u);
  EXPECT_EQ(errors.max(), 1000);
  for (const double share : {0.1, 0.5, 0.99, 1.0}) {
    EXPECT_GE(errors.percentile(share), 1000 * share);
    EXPECT_LE(errors.percentile(share), 1000 * share * 1.19);
  }
}

}  // namespace
}  // namespace sightline
