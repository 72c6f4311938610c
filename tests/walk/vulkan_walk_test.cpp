// Walks on a Vulkan device, lavapipe where there is no other: no method but late and those by sets may change
// a pixel, at odd sizes, with validation on.
#include <gtest/gtest.h>

#include "core/bake/report.h"
#include "core/device/registry/make_device.h"
#include "core/scene/scene_tree.h"
#include "core/walk/walk_page.h"
#include "tests/draw_vulkan/drawn_city.h"
#include "tests/walk/walk_frames.h"

namespace sightline {
namespace {

struct WalkedScene {
  std::string name;
  glm::uvec2 size;
};

void PrintTo(const WalkedScene& walked, std::ostream* out) {
  *out << walked.name;
}

class VulkanWalk : public testing::TestWithParam<WalkedScene> {};

TEST_P(VulkanWalk, ChangesNoPixel) {
  if (!drawing_cases::canDraw()) GTEST_SKIP();
  constexpr uint32_t kFrames = 60;
  const auto& [name, size] = GetParam();
  const Scene scene = generateScene(name, 20'000, 1);
  const DrawScene draw = makeDrawScene(scene, {.split = 512});
  const PvsUnits units = test::unitsOfAll(scene, draw.drawables);
  const WalkFrames frames = test::generatedFrames(name, 20'000, kFrames, size, draw);
  double now = 0;
  const WalkClock clock = [&] { return now += 0.001; };
  const WalkScene walk{scene, draw, &units};
  const auto device = makeWalkDevice("vulkan", walk, clock);
  const Bvh bvh = buildSceneTree(scene);
  const auto tracer = makeTracer("cpu", scene, bvh);
  std::vector<std::string> methods;
  for (const WalkMethodInfo& info : walkMethods()) {
    if (device->whyNot(info.name).empty()) methods.push_back(info.name);
  }
  ReplayOptions options{.repeats = 1, .trace_every = 10};
  options.method.schedule.fixed = true;
  const WalkReplay found = replayWalk(*device, walk, frames, methods, options, tracer.get(), clock);
  ASSERT_TRUE(found.complete) << found.problem;
  ASSERT_GE(found.methods.size(), 11u);
  for (const MethodReplay& m : found.methods) {
    ASSERT_EQ(m.times.size(), kFrames) << m.name;
    ASSERT_EQ(m.counts.size(), kFrames) << m.name;
    ASSERT_EQ(m.checks.size(), kFrames) << m.name;
    const WalkSummary s = summarize(m, 0, kFrames);
    EXPECT_EQ(s.near_pixels, 0u) << m.name;
    EXPECT_EQ(s.outside, 0u) << m.name;
    if (m.name == "late") {
      if (name == "city") {
        EXPECT_GT(s.false_pixels, 0u) << "the check sees what pops up";
      }
    } else {  // sets of all triangles miss nothing either
      EXPECT_EQ(s.false_pixels, 0u) << m.name;
    }
    for (size_t i = 0; i < kFrames && m.name != "hiz-meshlets" && m.name != "late"; ++i) {
      EXPECT_GE(m.counts[i].triangles, m.checks[i].optimal_triangles) << m.name << " " << i;
    }
    EXPECT_GT(s.gpu, 0) << m.name << ": GPU times";
    const WalkFrameSpans& spans = m.slowest.spans;
    EXPECT_FALSE(spans.cpu.empty() || spans.gpu.empty()) << m.name;
    double end = 0;
    for (const auto& span : spans.cpu) {
      EXPECT_EQ(span.begin, end) << m.name << ": no gap of the processor's";
      end = span.end;
    }
    EXPECT_NEAR(end, m.slowest.milliseconds, 0.0025) << m.name << ": but for two steps of the clock";
  }
  ASSERT_EQ(found.traced.size(), 6u);
  // Where cups stand on tables, two surfaces are in one place.
  const uint64_t in_contact = name == "bistro" ? 2 : 0;
  for (const TracedFrame& t : found.traced) EXPECT_LE(t.unexplained_pixels, in_contact) << t.frame;
  // The same again: by the fixed schedule the same counts.
  const WalkReplay again = replayWalk(*device, walk, frames, {"opti-chc++", "chc"}, options, nullptr, clock);
  for (const MethodReplay& m : again.methods) {
    const auto before = std::ranges::find(found.methods, m.name, &MethodReplay::name);
    EXPECT_EQ(m.counts, before->counts) << m.name;
  }
}

/// By the fixed schedule two devices draw, ask and wait alike as far as they answer alike: of a device of the
/// processor's own and one of Vulkan, which round edges in their own ways, all counts of nearly all frames.
/// Each gives the same counts on each run.
TEST(VulkanWalkOnTwoDevices, CountsAreTheSame) {
  if (!drawing_cases::canDraw()) GTEST_SKIP();
  constexpr uint32_t kFrames = 60;
  const Scene scene = generateScene("city", 5'000, 1);
  const DrawScene draw = makeDrawScene(scene, {.split = 256});
  const WalkFrames frames = test::generatedFrames("city", 5'000, kFrames, {97, 61}, draw);
  double now = 0;
  const WalkClock clock = [&] { return now += 0.001; };
  const WalkScene walk{scene, draw};
  const std::vector<std::string> methods = {"vfc", "stop-and-wait", "chc", "chc++", "opti-chc++"};
  ReplayOptions options{.repeats = 1, .check = false};
  options.method.schedule.fixed = true;
  WalkReplay found[2][2];
  for (const int device : {0, 1}) {
    const auto drawn_by = makeWalkDevice(device == 0 ? "cpu" : "vulkan", walk, clock);
    for (const int run : {0, 1}) {
      found[device][run] = replayWalk(*drawn_by, walk, frames, methods, options, nullptr, clock);
    }
  }
  for (size_t m = 0; m < methods.size(); ++m) {
    uint32_t other = 0;
    double triangles[2] = {0, 0}, queries[2] = {0, 0};
    for (const int device : {0, 1}) {
      const auto& counts = found[device][0].methods[m].counts;
      EXPECT_EQ(counts, found[device][1].methods[m].counts) << methods[m];
      ASSERT_EQ(counts.size(), kFrames);
      for (const FrameCounts& c : counts)
        triangles[device] += double(c.triangles), queries[device] += double(c.queries);
    }
    for (uint32_t f = 0; f < kFrames; ++f) {
      other += found[0][0].methods[m].counts[f] != found[1][0].methods[m].counts[f] ? 1 : 0;
    }
    EXPECT_LE(other, kFrames / 6) << methods[m];
    EXPECT_NEAR(triangles[0], triangles[1], 0.002 * triangles[0]) << methods[m];
    EXPECT_NEAR(queries[0], queries[1], 0.002 * queries[0]) << methods[m];
    if (methods[m] == "vfc") {
      EXPECT_EQ(other, 0u) << "asks nothing";
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, VulkanWalk,
                         testing::Values(WalkedScene{"city", {160, 120}}, WalkedScene{"city", {97, 61}},
                                         WalkedScene{"bistro", {97, 61}}, WalkedScene{"plant", {64, 1}}),
                         [](const auto& c) {
                           return c.param.name + "_" + std::to_string(c.param.size.x) + "x" +
                                  std::to_string(c.param.size.y);
                         });

}  // namespace
}  // namespace sightline
