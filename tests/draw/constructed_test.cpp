// Scenes of which it is known what must be drawn and asked.
#include <gtest/gtest.h>

#include "tests/draw/draw_cases.h"
#include "tests/draw/method_cases.h"

namespace sightline {
namespace {

using draw_cases::cameraAt;
using draw_cases::ObjectScene;

struct Stage {
  Scene scene;
  DrawScene parts;
  explicit Stage(ObjectScene objects) : scene(objects.finish()), parts(makeDrawScene(scene, {.split = 0})) {}

  struct Frame {
    FrameCounts counts;
    std::set<uint32_t> drawn;
    draw_cases::Wrong wrong;
  };
  /// The same view so many times; the last frame.
  Frame look(CullMethod& method, const Camera& camera, uint64_t frames) const {
    SoftwareBackend backend(scene, parts.drawables);
    const draw_cases::Truth truth = draw_cases::bruteForce(scene, parts, camera);
    Frame frame;
    for (uint64_t f = 0; f < frames; ++f) {
      std::vector<uint32_t> drawn;
      frame.counts = method.drawFrame(camera, f, backend, drawn);
      frame.wrong = draw_cases::compare(truth, backend.image(), drawn);
      EXPECT_FALSE(frame.wrong.any()) << "frame " << f << ": " << frame.wrong.false_pixels << " pixels, "
                                      << frame.wrong.missing_drawables << " drawables";
      frame.drawn = {drawn.begin(), drawn.end()};
    }
    return frame;
  }
};

const Schedule kFixed{.fixed = true};

class Constructed : public testing::TestWithParam<draw_cases::MethodCase> {
 protected:
  bool asks() const { return GetParam().name != "none" && GetParam().name != "vfc"; }
  Stage::Frame look(const Stage& stage, const Camera& camera, uint64_t frames = 12) const {
    return stage.look(*GetParam().make(stage.parts, kFixed), camera, frames);
  }
};

INSTANTIATE_TEST_SUITE_P(All, Constructed, testing::ValuesIn(draw_cases::exactMethods()), [](const auto& p) {
  std::string name;
  for (const char c : p.param.name)
    name += std::isalnum(static_cast<unsigned char>(c)) ? c : c == '+' ? 'p' : '_';
  return name;
});

/// A wall that fills the image, and n x n boxes behind it.
Stage wallBeforeBoxes(int n) {
  ObjectScene objects;
  objects.box({-100, -100, -11}, {100, 100, -10});
  for (int i = 0; i < n * n; ++i) {
    const glm::vec3 low(float(i % n) * 2 - float(n), float(i / n) * 2 - float(n), -200);
    objects.box(low, low + 1.0f);
  }
  return Stage(std::move(objects));
}

TEST_P(Constructed, WallHidesAllBehind) {
  const Stage stage = wallBeforeBoxes(8);
  const auto frame = look(stage, cameraAt(stage.parts, {0, 0, 0}, {0, 0, -1}));
  if (asks()) {
    EXPECT_EQ(frame.drawn, std::set<uint32_t>{0});
    EXPECT_EQ(frame.counts.triangles, 12u);
  } else {
    EXPECT_EQ(frame.drawn.size(), 65u);
  }
}

TEST(ConstructedCounts, OneQueryIsEnoughForAllBehindTheWall) {
  for (const int n : {1, 3, 8, 20}) {
    SCOPED_TRACE(n);
    const Stage stage = wallBeforeBoxes(n);
    const Camera camera = cameraAt(stage.parts, {0, 0, 0}, {0, 0, -1});
    // Stop-and-wait: the root, the wall, and what is behind it as a whole.
    const auto waiting = stage.look(*cullStopAndWait(stage.parts, kFixed), camera, 3);
    EXPECT_EQ(waiting.counts.queries, 3u);
    EXPECT_EQ(waiting.counts.waits, 3u);
    EXPECT_EQ(waiting.counts.node_visits, 3u);
    // CHC: the wall, and what is behind it; the root was visible.
    const auto chc = stage.look(*cullChc(stage.parts, kFixed), camera, 3);
    EXPECT_EQ(chc.counts.queries, 2u);
    EXPECT_EQ(chc.counts.retest_queries, 1u);
    for (const ChcOptions& options : {ChcOptions{}, plainChc()}) {
      // Once known: what is behind, in one submit with the wall; every sixth frame the wall too.
      const auto method = cullChcPlus(stage.parts, options, kFixed);
      SoftwareBackend backend(stage.scene, stage.parts.drawables);
      uint64_t retests = 0;
      for (uint64_t f = 0; f < 60; ++f) {
        std::vector<uint32_t> drawn;
        const FrameCounts counts = method->drawFrame(camera, f, backend, drawn);
        if (f < 8) continue;  // first nothing hides; what showed then is taken for visible for a while
        EXPECT_EQ(counts.queries - counts.retest_queries, 1u) << "frame " << f;
        EXPECT_EQ(counts.node_visits, 3u);
        EXPECT_EQ(drawn, std::vector<uint32_t>{0});
        if (options.batching && counts.retest_queries == 0) {
          EXPECT_EQ(counts.submits, 1u);
        }
        if (options.batching && counts.retest_queries == 1) {
          EXPECT_LE(counts.submits, 2u);
        }
        retests += counts.retest_queries;
      }
      EXPECT_GE(retests, 8u);  // in 52 frames, one in six
      EXPECT_LE(retests, 9u);
    }
  }
}

TEST_P(Constructed, GapsOfAFenceShowWhatIsBehind) {
  // Slats with gaps of 1, 2 and 3 pixels' width at their distance; behind each gap a box as wide as some
  // pixels.
  for (const double gap_pixels : {1.0, 2.0, 3.0}) {
    ObjectScene objects;
    const double pixel = 2 * 10 * std::tan(M_PI / 6) / 120;  // at distance 10, 60 degrees, 120 pixels
    const double pitch = 12 * pixel;
    for (int i = -10; i < 10; ++i) {
      const float left = float(i * pitch), right = float(i * pitch + pitch - gap_pixels * pixel);
      objects.box({left, -20, -10.1f}, {right, 20, -10});
    }
    for (int i = -8; i < 8; ++i) {
      const glm::vec3 middle(float(i * pitch * 3), float(i % 3), -30);
      objects.box(middle - 0.2f, middle + 0.2f);
    }
    const Stage stage{std::move(objects)};
    for (const double shift : {0.0, 0.013, 0.31, 0.5}) {
      look(stage, cameraAt(stage.parts, {shift * pixel * 12, 0.1, 0}, {shift * pixel * 12, 0.1, -1}), 4);
    }
  }
}

TEST_P(Constructed, BoxAroundTheCameraHidesAllOutside) {
  ObjectScene objects;
  objects.box({-1, -1, -1}, {1, 1, 1});
  for (int i = 0; i < 30; ++i) {
    const glm::vec3 low(float(i % 5) * 3 - 7, float(i / 5) * 3 - 7, -20);
    objects.box(low, low + 1.0f);
  }
  const Stage stage{std::move(objects)};
  const auto frame = look(stage, cameraAt(stage.parts, {0.2, 0.1, 0.3}, {0.3, 0.1, -1}));
  if (asks()) {
    EXPECT_EQ(frame.drawn, std::set<uint32_t>{0});
  }
}

TEST_P(Constructed, AllBehindTheCameraCostsNothing) {
  ObjectScene objects;
  for (int i = 0; i < 9; ++i) objects.box({float(i), 0, 5}, {float(i) + 0.5f, 1, 6});
  const Stage stage{std::move(objects)};
  const auto frame = look(stage, cameraAt(stage.parts, {0, 0, 0}, {0, 0, -1}), 3);
  if (GetParam().name == "none") return;
  FrameCounts nothing;
  nothing.node_visits = 1;  // the root
  EXPECT_EQ(frame.counts, nothing);
}

TEST_P(Constructed, OneObject) {
  ObjectScene objects;
  objects.box({-1, -1, -6}, {1, 1, -5});
  const Stage stage{std::move(objects)};
  const auto frame = look(stage, cameraAt(stage.parts, {0, 0, 0}, {0, 0, -1}), 1);
  EXPECT_EQ(frame.drawn, std::set<uint32_t>{0});
  EXPECT_EQ(frame.counts.queries, asks() ? 1u : 0u);
  EXPECT_EQ(frame.counts.objects, 1u);
  EXPECT_EQ(frame.counts.triangles, 12u);
  EXPECT_EQ(frame.counts.submits, asks() ? 2u : 1u);
}

TEST_P(Constructed, CoplanarDoublesAreBothThere) {
  // The same rectangle as two objects, and one with other triangles; two that share a plane and overlap.
  ObjectScene objects;
  objects.rectangle({-2, -2, -5}, {4, 0, 0}, {0, 4, 0});
  objects.rectangle({-2, -2, -5}, {4, 0, 0}, {0, 4, 0});
  objects.rectangle({2, -2, -5}, {0, 4, 0}, {-4, 0, 0});
  objects.rectangle({-3, 0, -5}, {2, 0, 0}, {0, 1, 0});
  objects.rectangle({0, 0, -7}, {1, 0, 0}, {0, 1, 0});  // hidden
  const Stage stage{std::move(objects)};
  for (const glm::dvec3 eye : {glm::dvec3(0, 0, 0), glm::dvec3(1, 2, 1), glm::dvec3(-3, 0.1, -4)}) {
    look(stage, cameraAt(stage.parts, eye, {0, 0, -5}), 8);
  }
}

TEST_P(Constructed, CameraOnAFaceOrInAPlane) {
  ObjectScene objects;
  objects.box({-1, -1, -1}, {1, 1, 0});                     // the camera is on its front
  objects.rectangle({-5, 0, -5}, {10, 0, 0}, {0, 0, -10});  // and in this plane
  objects.box({-3, 0.5f, -9}, {3, 1, -8});
  const Stage stage{std::move(objects)};
  for (const glm::dvec3 look_at : {glm::dvec3(0, 0, -1), glm::dvec3(1, 0, 0), glm::dvec3(0.3, 0.2, -1),
                                   glm::dvec3(0, 0, 1), glm::dvec3(0, 1, 0)}) {
    look(stage, cameraAt(stage.parts, {0, 0, 0}, look_at), 5);
  }
}

TEST_P(Constructed, FlatGroundAtAGrazingAngle) {
  // Large flat objects whose boxes have no thickness, seen nearly along their plane, with things on them.
  ObjectScene objects;
  for (int i = 0; i < 16; ++i) {
    const glm::vec3 corner(float(i % 4) * 50 - 100, 0, -float(i / 4) * 200);
    objects.rectangle(corner, {50, 0, 0}, {0, 0, -200});
    objects.rectangle(corner + glm::vec3(5, 0.001f, -5), {3, 0, 0}, {0, 0, -190});
    objects.box(corner + glm::vec3(20, 0, -30), corner + glm::vec3(22, 1, -31));
  }
  const Stage stage{std::move(objects)};
  for (const double height : {0.01, 0.1, 1.7}) {
    for (const uint32_t size : {40u, 97u, 200u}) {
      look(stage, cameraAt(stage.parts, {3, height, 20}, {0, height * 0.9, -300}, size, size / 2), 4);
    }
  }
}

TEST(ConstructedCounts, EveryPixelOfAnImageOfOne) {
  ObjectScene objects;
  objects.box({-1, -1, -6}, {1, 1, -5});
  objects.box({-1, -1, -9}, {1, 1, -8});
  const Stage stage{std::move(objects)};
  for (const auto& c : draw_cases::exactMethods()) {
    stage.look(*c.make(stage.parts, kFixed), cameraAt(stage.parts, {0, 0, 0}, {0, 0, -1}, 1, 1), 4);
    stage.look(*c.make(stage.parts, {}), cameraAt(stage.parts, {0, 0, 0}, {0, 0, -1}, 1, 200), 4);
  }
}

TEST(ConstructedCounts, CutsInTheNumbersOfFramesForgetWhatWasSeen) {
  const Stage stage = wallBeforeBoxes(4);
  const Camera camera = cameraAt(stage.parts, {0, 0, 0}, {0, 0, -1});
  for (const auto& c : draw_cases::exactMethods()) {
    const auto method = c.make(stage.parts, kFixed), fresh = c.make(stage.parts, kFixed);
    SoftwareBackend backend(stage.scene, stage.parts.drawables);
    std::vector<uint32_t> drawn;
    const FrameCounts first = fresh->drawFrame(camera, 9, backend, drawn);
    for (uint64_t f = 0; f < 3; ++f) method->drawFrame(camera, f, backend, drawn);
    const FrameCounts after = method->drawFrame(camera, 9, backend, drawn);
    EXPECT_EQ(after.retest_queries, first.retest_queries) << c.name;
    EXPECT_EQ(first.retest_queries, 0u) << c.name;
  }
}

/// For one frame, what lies within a range of x is visible.
class SeenForAFrame : public SoftwareBackend {
 public:
  using SoftwareBackend::SoftwareBackend;
  bool now = false;
  float from = 0, to = 0;

  QueryId submit(std::span<const uint32_t> draws, std::span<const OcclusionQuery> queries) override {
    const QueryId first = SoftwareBackend::submit(draws, queries);
    seen_.resize(first + queries.size());
    for (size_t i = 0; i < queries.size(); ++i) {
      seen_[first + i] = now && std::ranges::any_of(queries[i].boxes, [&](const AxisBox& box) {
                           return box.low.x > from && box.high.x < to;
                         });
    }
    return first;
  }
  bool visible(QueryId query) override { return SoftwareBackend::visible(query) || seen_[query]; }

 private:
  std::vector<bool> seen_;
};

TEST(ConstructedCounts, NodesThatShowedAreNotAskedAboutWithThoseLongHidden) {
  // Eight walls in a row, and a box close behind each.
  ObjectScene objects;
  for (int i = 0; i < 8; ++i) {
    const glm::vec3 at(float(i) * 20, 0, 0);
    objects.box(at + glm::vec3(-4, -4, -10.5f), at + glm::vec3(4, 4, -10));
    objects.box(at + glm::vec3(-1, -1, -12), at + glm::vec3(1, 1, -11));
  }
  const Stage stage{std::move(objects)};
  const Camera camera = cameraAt(stage.parts, {70, 0, 150}, {70, 0, 0}, 400, 100, 40);
  const auto method = cullChcPlus(stage.parts, {.assumed_frames = 0}, kFixed);
  SeenForAFrame backend(stage.scene, stage.parts.drawables);
  backend.from = 55;
  backend.to = 65;
  for (uint64_t f = 0; f < 26; ++f) {
    SCOPED_TRACE(f);
    backend.now = f == 20;
    std::vector<uint32_t> drawn;
    const FrameCounts counts = method->drawFrame(camera, f, backend, drawn);
    if (f < 10) continue;
    const uint64_t hidden = counts.queries - counts.retest_queries;
    if (f < 20) {  // all eight at once
      EXPECT_EQ(hidden, 1u);
    }
    if (f == 20) {  // that fails: each alone
      EXPECT_EQ(hidden, 1u + 8u);
      EXPECT_EQ(counts.failed_queries, 1u);
      EXPECT_EQ(drawn.size(), 9u);
    }
    if (f == 21) {  // seven at once; the one that showed is re-tested
      EXPECT_EQ(hidden, 1u);
      EXPECT_EQ(counts.retest_queries, 9u);
    }
    if (f >= 22) {  // seven at once, and one of which less is known
      EXPECT_EQ(hidden, 2u);
    }
    if (f != 20 && f != 21) {
      EXPECT_EQ(drawn.size(), 8u);
    }
  }
}

TEST(ConstructedCounts, LateKnowsTheLastFrameOnly) {
  const Stage stage = wallBeforeBoxes(2);
  const Camera ahead = cameraAt(stage.parts, {0, 0, 0}, {0, 0, -1}),
               back = cameraAt(stage.parts, {0, 0, 0}, {0, 0, 1});
  const auto method = cullLate(stage.parts);
  SoftwareBackend backend(stage.scene, stage.parts.drawables);
  std::vector<uint32_t> drawn;
  const auto objects = [&](const Camera& camera, uint64_t number) {
    return method->drawFrame(camera, number, backend, drawn).objects;
  };
  EXPECT_EQ(objects(ahead, 0), 5u);  // nothing is known
  EXPECT_EQ(objects(ahead, 1), 1u);  // the wall hides the rest
  EXPECT_EQ(objects(back, 2), 0u);
  EXPECT_EQ(objects(ahead, 3), 5u);  // what was known before the last frame is no answer
  EXPECT_EQ(objects(ahead, 4), 1u);
  EXPECT_EQ(objects(ahead, 6), 5u);
}

TEST(SoftwareBackend, AnswersForTwoFrames) {
  const Stage stage = wallBeforeBoxes(1);
  SoftwareBackend backend(stage.scene, stage.parts.drawables, nullptr, {.polls = 2});
  const Camera camera = cameraAt(stage.parts, {0, 0, 0}, {0, 0, -1});
  const AxisBox behind{{-1, -1, -50}, {1, 1, -49}}, before{{-1, -1, -5}, {1, 1, -4}};
  const std::vector<OcclusionQuery> queries{{{&behind, 1}}, {{&before, 1}}};
  const uint32_t wall = 0;
  backend.beginFrame(camera);
  const QueryId empty = backend.submit({}, queries), after = backend.submit({&wall, 1}, queries);
  EXPECT_EQ(empty, 0u);
  EXPECT_EQ(after, 2u);
  EXPECT_FALSE(backend.arrived(empty));
  EXPECT_FALSE(backend.arrived(empty));
  EXPECT_TRUE(backend.arrived(empty));
  EXPECT_TRUE(backend.visible(empty));  // before the wall was drawn
  EXPECT_FALSE(backend.arrived(after));
  EXPECT_FALSE(backend.visible(after));
  EXPECT_TRUE(backend.arrived(after));  // waited for
  backend.endFrame();
  EXPECT_TRUE(backend.visible(after + 1));
  backend.beginFrame(camera);
  EXPECT_EQ(backend.submit({}, queries), 4u);
  EXPECT_FALSE(backend.visible(after));
  backend.endFrame();
  backend.beginFrame(camera);
  EXPECT_THROW(backend.visible(after), std::out_of_range);
  EXPECT_TRUE(backend.visible(4));
  EXPECT_THROW(backend.visible(6), std::out_of_range);
}

TEST(ConstructedCounts, NoDrawables) {
  const Scene scene = [] {
    ObjectScene objects;
    objects.box({0, 0, 0}, {1, 1, 1});
    return objects.finish();
  }();
  const DrawScene nothing = makeDrawScene(Drawables{});
  const Camera camera = makeCamera(lookAt({0, 0, 0}, {0, 0, -1}, 60, 8, 8), 8, 8, 0.01f);
  SoftwareBackend backend(scene, nothing.drawables);
  for (const auto& c : draw_cases::exactMethods()) {
    std::vector<uint32_t> drawn;
    EXPECT_EQ(c.make(nothing, {})->drawFrame(camera, 0, backend, drawn), FrameCounts{}) << c.name;
  }
}

TEST(ConstructedCounts, BlendedOnesAreDrawnFarthestFirst) {
  ObjectScene objects;
  for (const int i : {3, 0, 4, 1, 2}) objects.rectangle({-1, -1, -5 - float(i)}, {2, 0, 0}, {0, 2, 0});
  objects.rectangle({-1, -1, -7}, {2, 0, 0}, {0, 2, 0});  // as far as the last one of them
  Scene scene = objects.finish();
  scene.surfaces.words.assign(scene.triangles.size(), kSurfaceGlass);
  const DrawScene parts = makeDrawScene(scene);
  const Camera camera = cameraAt(parts, {0, 0, 0}, {0, 0, -1});
  for (const auto& c : draw_cases::exactMethods()) {
    SoftwareBackend backend(scene, parts.drawables);
    const auto method = c.make(parts, kFixed);
    for (uint64_t f = 0; f < 3; ++f) {
      std::vector<uint32_t> drawn;
      method->drawFrame(camera, f, backend, drawn);
      EXPECT_EQ(drawn, (std::vector<uint32_t>{2, 0, 5, 4, 3, 1})) << c.name;
    }
  }
}

TEST(ConstructedCounts, MaskedOnesHideNothingFromQueries) {
  // A masked sheet without holes before a box: the box is drawn, as the sheet comes after all queries.
  ObjectScene objects;
  objects.rectangle({-9, -9, -5}, {18, 0, 0}, {0, 18, 0});
  objects.box({-1, -1, -9}, {1, 1, -8});
  Scene scene = objects.finish();
  scene.surfaces.words.assign(scene.triangles.size(), 0);
  scene.surfaces.words[0] = scene.surfaces.words[1] = kSurfaceMasked;
  scene.surfaces.texels = {1u};
  scene.surfaces.masks.push_back({{1, 1, 2 + 8, 0}});
  scene.surfaces.masked.push_back(
      {{kTexelOffset, kTexelOffset, kTexelOffset, kTexelOffset}, {kTexelOffset, kTexelOffset, 0, 0}});
  const DrawScene parts = makeDrawScene(scene);
  const Camera camera = cameraAt(parts, {0, 0, 0}, {0, 0, -1});
  for (const auto& c : draw_cases::exactMethods()) {
    SoftwareBackend backend(scene, parts.drawables);
    const auto method = c.make(parts, kFixed);
    for (uint64_t f = 0; f < 4; ++f) {
      std::vector<uint32_t> drawn;
      method->drawFrame(camera, f, backend, drawn);
      EXPECT_EQ(drawn, (std::vector<uint32_t>{1, 0})) << c.name;
      EXPECT_EQ(draw_cases::bruteForce(scene, parts, camera).depth, backend.image().depth());
    }
  }
}

}  // namespace
}  // namespace sightline
