// The replay's own work: order, repeats, medians, counts, pops and how it ends, by scripted players; then all
// methods of the processor on a drawn scene.
#include "core/walk/replay.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "core/base/error.h"
#include "core/device/registry/make_device.h"
#include "core/draw/make_camera.h"
#include "core/generate/generate.h"
#include "core/scene/scene_tree.h"
#include "core/walk/walk_report.h"
#include "tests/support/boxes.h"
#include "tests/walk/walk_frames.h"

namespace sightline {
namespace {

/// What a scripted device is asked to do, and the time that passes.
struct Script {
  std::vector<std::string> log;  ///< "method frame", in order of draws
  double now = 0;
  std::map<std::string, uint32_t> replays;  ///< begun, by method
  /// Milliseconds of a frame of a method, in its replay of this number (0: the first).
  std::function<double(const std::string&, uint32_t replay, uint32_t frame)> takes = [](auto&&...) {
    return 1.0;
  };
  std::function<FrameCheck(const std::string&, uint32_t frame)> check = [](auto&&...) {
    return FrameCheck{};
  };
  std::function<void(const std::string&, uint32_t replay, uint32_t frame)> before = [](auto&&...) {};
};

class ScriptedPlayer : public WalkPlayer {
 public:
  ScriptedPlayer(Script& script, std::string name) : script_(script), name_(std::move(name)) {}
  void draw(const Camera&, uint64_t number, uint32_t in_flight, FrameTimes& times) override {
    frame_ = uint32_t(number);
    in_flight_ = in_flight;
    script_.before(name_, replay_, frame_);
    script_.log.push_back(name_ + " " + std::to_string(number));
    script_.now += script_.takes(name_, replay_, frame_);
    times.cpu[0] = double(frame_);
  }
  void gpuTimes(uint64_t number, FrameTimes& times) override {
    EXPECT_EQ(number, asked_++) << "each frame once, in order";
    EXPECT_LE(number + in_flight_ - 1, uint64_t(frame_) + in_flight_);
    times.gpu_frame = 100 + double(number);
  }
  FrameCounts counts() override { return {.objects = frame_ + 1}; }
  std::vector<uint32_t> drawn() override { return {frame_}; }
  FrameCheck check() override { return script_.check(name_, frame_); }
  std::vector<size_t> falsePixels() override {
    std::vector<size_t> pixels(script_.check(name_, frame_).false_pixels);
    std::iota(pixels.begin(), pixels.end(), 7);
    return pixels;
  }
  std::vector<float> referenceDepth() override { return {}; }
  std::vector<uint32_t> referenceDrawables() override { return {}; }
  void forget() override {
    replay_ = script_.replays[name_]++;
    asked_ = 0;
  }

 private:
  Script& script_;
  std::string name_;
  uint32_t replay_ = 0, frame_ = 0, in_flight_ = 1;
  uint64_t asked_ = 0;
};

class ScriptedDevice : public WalkDevice {
 public:
  explicit ScriptedDevice(Script& script) : script_(script) {}
  DeviceInfo info() const override { return {}; }
  bool timesGpu() const override { return true; }
  std::string whyNot(const std::string&) const override { return ""; }
  std::unique_ptr<WalkPlayer> play(const std::string& method, const WalkMethodOptions&) override {
    return std::make_unique<ScriptedPlayer>(script_, method);
  }

 private:
  Script& script_;
};

WalkReplay replayScript(Script& script, const std::vector<std::string>& methods, uint32_t frames,
                        const ReplayOptions& options, const ReplayHooks& hooks = {}) {
  ScriptedDevice device(script);
  const Scene scene;
  DrawScene draw;
  Drawable ten;
  ten.triangle_count = 10;
  draw.drawables.list.resize(5, ten);
  WalkFrames walk;
  walk.cameras.resize(frames);
  for (Camera& camera : walk.cameras) camera.size = {16, 16, 0, 0};
  return replayWalk(
      device, {scene, draw}, walk, methods, options, nullptr, [&] { return script.now; }, hooks);
}

TEST(Replay, RotatesMethodsDropsTheFirstReplayAndTakesMedians) {
  Script script;
  script.takes = [](const std::string& method, uint32_t replay, uint32_t frame) {
    if (replay == 0) return 1000.0;  // the dropped one
    return (method == "none" ? 10.0 : 20.0) + frame + (replay == 2 ? 5 : replay == 3 ? 0.5 : 0);
  };
  const WalkReplay found = replayScript(script, {"none", "vfc"}, 3, {.repeats = 3, .check = false});
  const std::vector<std::string> order = {"none 0", "none 1", "none 2", "vfc 0",  "vfc 1",  "vfc 2",
                                          "vfc 0",  "vfc 1",  "vfc 2",  "none 0", "none 1", "none 2"};
  for (size_t i = 0; i < script.log.size(); ++i) EXPECT_EQ(script.log[i], order[i % order.size()]) << i;
  EXPECT_EQ(script.log.size(), 24u);
  EXPECT_TRUE(found.complete);
  ASSERT_EQ(found.methods.size(), 2u);
  for (uint32_t frame = 0; frame < 3; ++frame) {
    EXPECT_EQ(found.methods[0].times[frame].frame, 10.5 + frame);
    EXPECT_EQ(found.methods[1].times[frame].frame, 20.5 + frame);
    EXPECT_EQ(found.methods[1].times[frame].gpu_frame, 100 + frame);
    EXPECT_EQ(found.methods[1].times[frame].cpu[0], frame);
    EXPECT_EQ(found.methods[1].counts[frame].objects, frame + 1);
  }
  EXPECT_EQ(found.methods[0].repeats, 3u);
  EXPECT_TRUE(found.methods[0].checks.empty());
}

TEST(Replay, MedianOfAnEvenNumberIsTheMeanOfTheMiddle) {
  Script script;
  script.takes = [](const std::string&, uint32_t replay, uint32_t) { return replay == 1 ? 4.0 : 8.0; };
  EXPECT_EQ(replayScript(script, {"vfc"}, 2, {.repeats = 2, .check = false}).methods[0].times[1].frame, 6);
}

TEST(Replay, ChecksInAPassOfItsOwn) {
  Script script;
  script.takes = [](const std::string&, uint32_t replay, uint32_t) { return replay == 2 ? 1e6 : 1.0; };
  script.check = [](const std::string&, uint32_t frame) {
    FrameCheck check;
    check.shown = {0, 1, 4};
    if (frame >= 2 && frame <= 4) check.missing.push_back({3, 10u * frame});
    if (frame == 4 || frame == 6) check.missing.push_back({1, 1});
    for (const auto& m : check.missing) check.false_pixels += m.pixels;
    return check;
  };
  ReplayOptions options{.repeats = 1, .kept_frames = 2, .shown_frames = {5}};
  const WalkReplay found = replayScript(script, {"late"}, 8, options);
  const MethodReplay& m = found.methods[0];
  for (const FrameTimes& t : m.times) EXPECT_EQ(t.frame, 1) << "the check's time is not in it";
  ASSERT_EQ(m.checks.size(), 8u);
  EXPECT_EQ(m.checks[4], (CheckedFrame{41, 0, 40, 2, 3, 30, 41, 0}));
  EXPECT_EQ(m.checks[5], (CheckedFrame{0, 0, 0, 0, 3, 30}));
  EXPECT_EQ(m.pop_count, 3u);
  ASSERT_EQ(m.pops.size(), 3u);
  EXPECT_EQ(m.pops[0], (Pop{3, 2, 3, 40}));
  EXPECT_EQ(m.pops[1].frames, 1u);
  ASSERT_EQ(m.worst.size(), 2u);
  EXPECT_EQ(m.worst[0].frame, 4u);
  EXPECT_EQ(m.worst[0].pixels.size(), 41u);
  EXPECT_EQ(m.worst[1].frame, 3u);
  EXPECT_EQ(m.drawn, (std::vector<std::vector<uint32_t>>{{5}}));
}

TEST(Replay, IsMissingToTheLastFrame) {
  Script script;
  script.check = [](const std::string&, uint32_t) { return FrameCheck{4, 0, {{2, 4}}, {}}; };
  const MethodReplay m = replayScript(script, {"late"}, 5, {.repeats = 1}).methods[0];
  ASSERT_EQ(m.pops.size(), 1u);
  EXPECT_EQ(m.pops[0], (Pop{2, 0, 5, 4}));
}

TEST(Replay, EndsWellWhereItIsStopped) {
  for (const uint32_t in_replay : {0u, 1u, 2u}) {
    Script script;
    std::atomic<bool> stop = false;
    script.before = [&](const std::string& method, uint32_t replay, uint32_t frame) {
      if (method == "vfc" && replay == in_replay && frame == 2) stop = true;
    };
    const WalkReplay found =
        replayScript(script, {"none", "vfc"}, 5, {.repeats = 1}, {.progress = {}, .stop = &stop});
    EXPECT_FALSE(found.complete);
    EXPECT_EQ(found.problem, "");
    const MethodReplay& m = found.methods[1];
    EXPECT_EQ(m.repeats, in_replay == 2 ? 1u : 0u);
    EXPECT_EQ(m.times.size(), in_replay == 2 ? 5u : 3u) << "the frames so far";
    EXPECT_EQ(m.checks.size(), in_replay == 2 ? 3u : 0u);
    EXPECT_EQ(m.counts.size(), in_replay == 0 ? 3u : in_replay == 1 ? 5u : 5u);
  }
}

WalkReport reportOf(const WalkReplay& found, uint32_t frames) {
  WalkReport report;
  report.replay = found;
  report.frames.cameras.resize(frames);
  report.gpu_times = true;
  return report;
}

TEST(Replay, StoppedInTheWarmUpSaysWhatWasNotRun) {
  Script script;
  std::atomic<bool> stop = false;
  script.before = [&](const std::string& method, uint32_t, uint32_t frame) {
    if (method == "vfc" && frame == 2) stop = true;
  };
  const WalkReplay found =
      replayScript(script, {"none", "vfc", "chc"}, 5, {.repeats = 1}, {.progress = {}, .stop = &stop});
  ASSERT_EQ(found.methods.size(), 3u);
  EXPECT_TRUE(found.methods[0].warm_up && found.methods[1].warm_up && !found.methods[2].warm_up);
  EXPECT_EQ(found.methods[0].times.size(), 5u) << "what was measured is kept";
  EXPECT_EQ(found.methods[1].times.size(), 3u);
  for (const FrameTimes& t : found.methods[1].times) EXPECT_GE(t.gpu_frame, 100) << "of the last frame, too";
  const WalkReport report = reportOf(found, 5);
  const Json json = walkJson(report);
  EXPECT_EQ(json["methods"][0]["frames"], 5);
  EXPECT_EQ(json["methods"][0]["warm_up"], true);
  EXPECT_EQ(json["methods"][0]["mean_ms"], 1);
  EXPECT_EQ(json["methods"][2]["frames"], 0);
  EXPECT_EQ(json["methods"][2]["warm_up"], false);
  for (const char* key :
       {"mean_ms", "median_ms", "slowest_1_percent_ms", "slowest_01_percent_ms", "gpu_ms", "cpu_ms",
        "objects", "triangles", "queries", "submits", "waits", "frames_outside"}) {
    EXPECT_TRUE(json["methods"][2][key].is_null()) << key;
    EXPECT_FALSE(json["methods"][0][key].is_null()) << key;
  }
  EXPECT_EQ(walkCsv(report).find("\nchc,"), std::string::npos);
  EXPECT_NE(walkTable(report).find("\nchc              not run\n"), std::string::npos) << walkTable(report);
  EXPECT_EQ(walkNotes(report),
            (std::vector<std::string>{
                "times of none, vfc are of the warm-up: the walk was stopped before a repeat"}));
}

TEST(Replay, AWholeRepeatIsNoWarmUp) {
  Script script;
  std::atomic<bool> stop = false;
  script.takes = [](const std::string&, uint32_t replay, uint32_t) { return replay == 0 ? 50.0 : 2.0; };
  script.before = [&](const std::string& method, uint32_t replay, uint32_t frame) {
    if (method == "none" && replay == 1 && frame == 1) stop = true;  // "vfc" is the first of the repeat
  };
  const WalkReplay found =
      replayScript(script, {"none", "vfc"}, 5, {.repeats = 1}, {.progress = {}, .stop = &stop});
  EXPECT_FALSE(found.methods[0].warm_up);
  EXPECT_EQ(found.methods[0].times.size(), 2u);
  EXPECT_EQ(found.methods[0].times[1].frame, 2) << "not of the warm-up";
  EXPECT_FALSE(found.methods[1].warm_up);
  EXPECT_EQ(found.methods[1].repeats, 1u);
  EXPECT_TRUE(walkNotes(reportOf(found, 5)).empty());
}

TEST(WalkReport, WarnsOfADeviceThatDrawsWhatNoRayMeets) {
  WalkReport report;
  report.width = 100, report.height = 10;
  report.replay.traced = {{.frame = 0, .other_pixels = 9, .unexplained_pixels = 1},
                          {.frame = 50, .unexplained_pixels = 1}};
  EXPECT_TRUE(walkNotes(report).empty()) << "surfaces in one place give some";
  report.replay.traced[1].unexplained_pixels = 2;
  ASSERT_EQ(walkNotes(report).size(), 1u);
  EXPECT_EQ(walkNotes(report)[0].find("3 of the 2000 pixels of traced frames show what no ray"), 0u);
}

TEST(Replay, KeepsTheFramesBeforeADeviceIsLost) {
  Script script;
  script.before = [](const std::string& method, uint32_t, uint32_t frame) {
    if (method == "vfc" && frame == 3) throw Error("vkQueueSubmit: device lost");
  };
  const WalkReplay found = replayScript(script, {"none", "vfc"}, 5, {.repeats = 1});
  EXPECT_FALSE(found.complete);
  EXPECT_EQ(found.problem, "vkQueueSubmit: device lost");
  EXPECT_EQ(found.problem_code, kExitFailed);
  EXPECT_EQ(found.methods[1].times.size(), 3u);
  const std::string csv = walkCsv(reportOf(found, 5));
  EXPECT_NE(csv.find("\nvfc,2,"), std::string::npos) << csv;
  EXPECT_EQ(csv.find("\nvfc,3,"), std::string::npos) << csv;
}

TEST(Replay, TellsHowFarItIs) {
  Script script;
  uint64_t calls = 0, all = 0;
  replayScript(script, {"none", "vfc"}, 5, {.repeats = 2},
               {.progress =
                    [&](const ReplayProgress& p) {
                      EXPECT_EQ(p.done, calls++);
                      all = p.all;
                    },
                .stop = nullptr});
  EXPECT_EQ(calls, all);
  EXPECT_EQ(all, 2u * 5 * 4);
}

/// Methods of the processor on a city.
class SoftwareWalk : public testing::Test {
 protected:
  static constexpr uint32_t kFrames = 60;
  Scene scene_ = generateScene("city", 5'000, 1);
  DrawScene draw_ = makeDrawScene(scene_);
  WalkFrames frames_ = test::generatedFrames("city", 5'000, kFrames, {97, 61}, draw_);
  PvsUnits units_ = test::unitsOfAll(scene_, draw_.drawables);
  double now_ = 0;

  WalkReplay replay(const std::vector<std::string>& methods, bool traced = false) {
    const WalkScene walk{scene_, draw_, &units_};
    const WalkClock clock = [&] { return now_ += 0.001; };
    const auto device = makeWalkDevice("cpu", walk, clock);
    const Bvh bvh = buildSceneTree(scene_);
    const auto tracer = makeTracer("cpu", scene_, bvh);
    ReplayOptions options{.repeats = 1, .trace_every = 5};
    options.method.schedule.fixed = true;
    return replayWalk(*device, walk, frames_, methods, options, traced ? tracer.get() : nullptr, clock);
  }
};

TEST_F(SoftwareWalk, ExactMethodsMissNoPixelAndLateDoes) {
  std::vector<std::string> methods;
  for (const WalkMethodInfo& info : walkMethods()) {
    if (!info.on_gpu) methods.push_back(info.name);
  }
  const WalkReplay found = replay(methods);
  ASSERT_TRUE(found.complete) << found.problem;
  for (const MethodReplay& m : found.methods) {
    const WalkSummary s = summarize(m, 0, kFrames);
    ASSERT_EQ(m.checks.size(), kFrames) << m.name;
    EXPECT_EQ(s.near_pixels, 0u) << m.name;
    if (m.name == "late") {
      EXPECT_GT(s.false_pixels, 0u);
      EXPECT_GT(m.pop_count, 0u);
      continue;
    }
    EXPECT_EQ(s.false_pixels, 0u) << m.name;
    for (size_t i = 0; i < kFrames; ++i) {
      EXPECT_GE(m.counts[i].objects, m.checks[i].optimal_drawables) << m.name << " " << i;
      EXPECT_GE(m.counts[i].triangles, m.checks[i].optimal_triangles) << m.name << " " << i;
      EXPECT_LE(m.counts[i].objects, draw_.drawables.list.size()) << m.name << " " << i;
    }
  }
}

TEST_F(SoftwareWalk, CountsTheSameEachTime) {
  const WalkReplay a = replay({"opti-chc++", "chc", "late"}), b = replay({"late", "chc", "opti-chc++"});
  EXPECT_EQ(a.methods[0].counts, b.methods[2].counts);
  EXPECT_EQ(a.methods[0].checks, b.methods[2].checks);
  EXPECT_EQ(a.methods[2].checks, b.methods[0].checks);
  EXPECT_EQ(a.methods[2].pops, b.methods[0].pops);
}

TEST_F(SoftwareWalk, DrawsWhatTracingFinds) {
  const WalkReplay found = replay({"vfc"}, true);
  ASSERT_EQ(found.traced.size(), kFrames / 5);
  for (const TracedFrame& t : found.traced) {
    EXPECT_EQ(t.unexplained_pixels, 0u) << t.frame;
    EXPECT_LT(t.other_pixels, 97u * 61 / 50) << t.frame;
    EXPECT_LE(t.triangles, t.drawable_triangles);
    EXPECT_NEAR(double(t.drawables), double(found.methods[0].checks[t.frame].optimal_drawables), 2)
        << t.frame;
  }
}

TEST_F(SoftwareWalk, FindsWhatASetMisses) {
  // Of the cell that holds all, the drawable that most pixels of the first frame show is left out.
  const WalkReplay before = replay({"pvs"});
  EXPECT_EQ(summarize(before.methods[0], 0, kFrames).false_pixels, 0u);
  const WalkScene walk{scene_, draw_, &units_};
  const WalkClock clock = [&] { return now_ += 0.001; };
  const auto device = makeWalkDevice("cpu", walk, clock);
  const auto player = device->play("none", {});
  FrameTimes times;
  player->draw(frames_.cameras[0], 0, 1, times);
  player->check();
  std::vector<uint32_t> shown = player->referenceDrawables();
  std::erase(shown, kNoTriangle);
  std::ranges::sort(shown);
  uint32_t most = 0, victim = 0;
  for (const uint32_t d : shown) {
    const auto pixels = uint32_t(std::ranges::count(shown, d));
    if (pixels > most) most = pixels, victim = d;
  }
  std::erase(units_.drawables[0], victim);
  const auto gone = draw_.drawables.trianglesOf(victim);
  std::erase_if(units_.triangles.lists[0].ids,
                [&](uint32_t id) { return std::ranges::find(gone, id) != gone.end(); });
  units_.triangles.lists[0].masked_begin = units_.triangles.lists[0].blended_begin =
      uint32_t(units_.triangles.lists[0].ids.size());
  const WalkReplay after = replay({"pvs", "pvs+vfc", "none"});
  EXPECT_EQ(after.methods[0].checks[0].false_pixels, most);
  EXPECT_EQ(after.methods[1].checks[0].false_pixels, most);
  EXPECT_EQ(after.methods[2].checks[0].false_pixels, 0u);
  ASSERT_FALSE(after.methods[0].worst.empty());
  EXPECT_EQ(after.methods[0].worst[0].pixels.size(),
            std::ranges::max(after.methods[0].checks, {}, &CheckedFrame::false_pixels).false_pixels);
}

/// A wall, in part behind a pane of glass and behind leaves with holes: where a set misses the wall, what
/// shows through those is told apart. Expected by where rays meet the plane of pane and leaves.
TEST(WalkOfAlpha, FalsePixelsBehindHolesAndGlassAreToldApart) {
  testing_support::SceneOfBoxes made;
  made.addRectangle({-4, -4, -10}, {8, 0, 0}, {0, 8, 0});
  made.addRectangle({-1.63f, -0.77f, -5}, {1.1f, 0, 0}, {0, 1.4f, 0});
  made.addRectangle({0.41f, -0.77f, -5}, {1.1f, 0, 0}, {0, 1.4f, 0});
  Scene scene = made.finish();
  scene.objects = {{"wall", 0, 2}, {"pane", 2, 2}, {"leaves", 4, 2}};
  scene.surfaces.words = {0, 0, kSurfaceGlass, kSurfaceGlass, kSurfaceMasked, kSurfaceMasked};
  scene.surfaces.texels = {0b0110u};  // 4 texels, two of them holes
  scene.surfaces.masks.push_back({{2, 2, kWrapClamp + 4 * kWrapClamp, 0}});
  scene.surfaces.masked.push_back(
      {{kTexelOffset, kTexelOffset, kTexelOffset + 2, kTexelOffset}, {kTexelOffset, kTexelOffset + 2, 0, 0}});
  const DrawScene draw = makeDrawScene(scene);
  PvsUnits units = test::unitsOfAll(scene, draw.drawables);
  units.drawables[0] = {1, 2};
  units.triangles.lists[0] = {{4, 5, 2, 3}, 0, 2};
  WalkFrames frames;
  frames.cameras = {
      makeCamera(lookAt({0, 0, 0}, {0, 0, -1}, 60, 96, 64), 96, 64, nearDistance(boundsOf(draw.drawables)))};
  double now = 0;
  const WalkClock clock = [&] { return now += 0.001; };
  const WalkScene walk{scene, draw, &units};
  const auto device = makeWalkDevice("cpu", walk, clock);
  ReplayOptions options;
  options.repeats = 1;
  const WalkReplay found = replayWalk(*device, walk, frames, {"pvs", "none"}, options, nullptr, clock);
  ASSERT_TRUE(found.complete) << found.problem;
  EXPECT_TRUE(found.alpha);
  uint64_t expected = 0, through_leaves = 0;
  ASSERT_EQ(found.methods[0].worst.size(), 1u);
  for (const size_t pixel : found.methods[0].worst[0].pixels) {
    const Ray ray = pixelRay(frames.cameras[0], uint32_t(pixel % 96), uint32_t(pixel / 96));
    const glm::dvec3 at = glm::dvec3(ray.direction) * (5 / -double(ray.direction.z));
    const bool high = at.y > -0.77 && at.y < 0.63;
    const bool leaves = high && at.x > 0.41 && at.x < 1.51;
    expected += leaves || (high && at.x > -1.63 && at.x < -0.53) ? 1 : 0;
    through_leaves += leaves ? 1 : 0;
  }
  const CheckedFrame& checked = found.methods[0].checks[0];
  EXPECT_GT(through_leaves, 0u);
  EXPECT_EQ(checked.behind_alpha, expected);
  EXPECT_GT(checked.false_pixels, expected);
  EXPECT_LE(checked.largest_region, checked.false_pixels);
  EXPECT_GT(checked.largest_region, checked.false_pixels / 2) << "the wall around the leaves";
  EXPECT_EQ(found.methods[1].checks[0].behind_alpha, 0u);
}

TEST(WalkReport, SummarizesLowsAndStretches) {
  MethodReplay m{.name = "vfc"};
  for (int i = 0; i < 1000; ++i) {
    m.times.push_back({.frame = i == 500 ? 100.0 : i < 10 ? 20.0 : 1.0});
    m.counts.push_back({.triangles = uint64_t(i < 500 ? 10 : 30)});
  }
  const WalkSummary s = summarize(m, 0, 1000);
  EXPECT_DOUBLE_EQ(s.slowest_01, 100);
  EXPECT_DOUBLE_EQ(s.slowest_1, (100 + 9 * 20) / 10.0);
  EXPECT_DOUBLE_EQ(s.median, 1);
  EXPECT_DOUBLE_EQ(s.mean, (100 + 200 + 989) / 1000.0);
  EXPECT_DOUBLE_EQ(s.triangles, 20);
  EXPECT_DOUBLE_EQ(summarize(m, 500, 1000).triangles, 30);
  WalkFrames frames;
  frames.cameras.resize(1000);
  frames.cuts = {10, 500};
  const auto stretches = stretchesOf(frames);
  ASSERT_EQ(stretches.size(), 3u);
  EXPECT_EQ(stretches[1].begin, 10u);
  EXPECT_EQ(stretches[2].end, 1000u);
}

TEST(WalkReport, NamesWhatIsPastTheLimit) {
  WalkReport report;
  for (const char* name : {"vfc", "late", "pvs"}) {
    MethodReplay m{.name = name};
    m.checks = {{0}, {7}, {2}};
    report.replay.methods.push_back(m);
  }
  EXPECT_EQ(
      pastFalse(report, 8),
      (std::vector<std::string>{"vfc: 9 false pixels in 2 frames, at most 8 allowed; most in frame 1"}));
  EXPECT_TRUE(pastFalse(report, 9).empty());
}

}  // namespace
}  // namespace sightline
