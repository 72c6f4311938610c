// Every method draws all that has a pixel, on scenes and walks like those of a replay; and what is wrong is
// found.
#include <gtest/gtest.h>

#include "core/base/splitmix.h"
#include "core/draw/box_guard.h"
#include "tests/draw/draw_cases.h"
#include "tests/draw/method_cases.h"

namespace sightline {
namespace {

using draw_cases::MethodCase;
using draw_cases::Wrong;

struct Replay {
  uint64_t false_pixels = 0, missing = 0;
  std::vector<FrameCounts> counts;
  std::vector<std::vector<uint32_t>> drawn;
};

/// A scene with its walk and what brute force says of each frame.
struct Walk {
  Scene scene;
  DrawScene parts;
  std::vector<Camera> cameras;
  std::vector<draw_cases::Truth> truths;

  Walk(Scene s, uint32_t split, uint32_t frames, uint32_t width, uint32_t height)
      : scene(std::move(s)), parts(makeDrawScene(scene, {.split = split})) {
    cameras = draw_cases::cityWalk(parts, frames, width, height);
    for (const Camera& camera : cameras) truths.push_back(draw_cases::bruteForce(scene, parts, camera));
  }

  Replay replay(CullMethod& method, SoftwareBackend& backend, QueryBackend& between) const {
    Replay result;
    for (size_t f = 0; f < cameras.size(); ++f) {
      std::vector<uint32_t> drawn{12345};
      result.counts.push_back(method.drawFrame(cameras[f], f, between, drawn));
      const Wrong wrong = draw_cases::compare(truths[f], backend.image(), drawn);
      result.false_pixels += wrong.false_pixels;
      result.missing += wrong.missing_drawables;
      result.drawn.push_back(drawn);
    }
    return result;
  }
  Replay replay(CullMethod& method, const SoftwareAnswers& answers = {}) const {
    SoftwareBackend backend(scene, parts.drawables, nullptr, answers);
    return replay(method, backend, backend);
  }
};

Scene withKinds(Scene scene) {
  scene.surfaces.words.assign(scene.triangles.size(), 0);
  for (size_t o = 0; o < scene.objects.size(); ++o) {
    for (uint32_t i = 0; i < scene.objects[o].triangle_count; ++i) {
      if (o % 5 == 2) scene.surfaces.words[scene.objects[o].first_triangle + i] = kSurfaceGlass;
      if (o % 5 == 4) scene.surfaces.words[scene.objects[o].first_triangle + i] = kSurfaceMasked;
    }
  }
  // One mask of 4 texels, two of them holes.
  scene.surfaces.texels = {0b0110u};
  scene.surfaces.masks.push_back({{2, 2, kWrapClamp + 4 * kWrapClamp, 0}});
  scene.surfaces.masked.push_back(
      {{kTexelOffset, kTexelOffset, kTexelOffset + 2, kTexelOffset}, {kTexelOffset, kTexelOffset + 2, 0, 0}});
  return scene;
}

const Walk& cityWalk() {
  static const Walk walk(generateScene("city", 8000, 1), 200, 40, 97, 61);
  return walk;
}
const Walk& mixedWalk() {
  static const Walk walk(withKinds(generateScene("city", 5000, 2)), 100, 30, 64, 48);
  return walk;
}
const Walk& plantWalk() {
  static const Walk walk(generateScene("plant", 8000, 1), 0, 20, 33, 47);
  return walk;
}

/// What any method draws must be in the image's frustum, and be drawn once; counts must agree with it.
void expectSound(const Walk& walk, const Replay& replay, bool culls) {
  for (size_t f = 0; f < replay.drawn.size(); ++f) {
    const Frustum frustum(walk.cameras[f]);
    const FrameCounts& counts = replay.counts[f];
    std::set<uint32_t> once;
    uint64_t triangles = 0;
    int kind = 0;
    for (const uint32_t d : replay.drawn[f]) {
      EXPECT_TRUE(once.insert(d).second) << "frame " << f << " draws " << d << " twice";
      const Drawable& drawable = walk.parts.drawables.list[d];
      if (culls) {
        EXPECT_NE(frustum.sideOf(drawable.box), FrustumSide::outside);
      }
      EXPECT_GE(int(drawable.alpha), kind) << "opaque, masked, blended";
      kind = int(drawable.alpha);
      triangles += drawable.triangle_count;
    }
    EXPECT_EQ(counts.objects, once.size());
    EXPECT_EQ(counts.draws, once.size());
    EXPECT_EQ(counts.triangles, triangles);
    EXPECT_LE(counts.failed_queries, counts.multi_queries);
    EXPECT_LE(counts.multi_queries + counts.retest_queries, counts.queries);
    EXPECT_GE(counts.query_boxes, counts.queries);
  }
}

TEST(Cull, DrawsAllThatHasAPixel) {
  for (const Walk* walk : {&cityWalk(), &mixedWalk(), &plantWalk()}) {
    for (const MethodCase& c : draw_cases::exactMethods()) {
      for (const bool fixed : {true, false}) {
        for (const uint32_t polls : {0u, 3u, 1000u}) {
          if (fixed && polls != 3) continue;
          SCOPED_TRACE(c.name + (fixed ? " fixed" : " live " + std::to_string(polls)));
          const auto method = c.make(walk->parts, {.fixed = fixed});
          const Replay replay = walk->replay(*method, {.polls = polls});
          EXPECT_EQ(replay.false_pixels, 0u);
          EXPECT_EQ(replay.missing, 0u);
          expectSound(*walk, replay, c.name != "none");
        }
      }
    }
  }
}

TEST(Cull, DrawsLittleThatHasNone) {
  uint64_t optimal = 0, frustum = 0, opti = 0;
  for (const auto& truth : cityWalk().truths) optimal += truth.drawables.size();
  const auto total = [](const Replay& replay) {
    uint64_t sum = 0;
    for (const FrameCounts& c : replay.counts) sum += c.objects;
    return sum;
  };
  frustum = total(cityWalk().replay(*cullFrustum(cityWalk().parts)));
  opti = total(cityWalk().replay(*cullChcPlus(cityWalk().parts, {}, {.fixed = true})));
  const uint64_t waiting = total(cityWalk().replay(*cullStopAndWait(cityWalk().parts, {.fixed = true})));
  EXPECT_LT(waiting, frustum);
  EXPECT_LE(waiting, opti);
  EXPECT_LT(opti, frustum);
  EXPECT_GE(waiting, optimal);
}

/// Leaves that show by answers that depend on no order: the method's meaning in ten lines.
void visibleLeaves(const BoxTree& tree, const BoxGuard& guard, const SoftwareImage& all, uint32_t index,
                   std::set<uint32_t>& leaves) {
  const BoxNode& node = tree.nodes[index];
  if (guard.frustum().sideOf(node.box) == FrustumSide::outside) return;
  const auto grown = guard.grown(node.box);
  if (grown && !all.seesBox(*grown)) return;
  if (node.isLeaf()) leaves.insert(node.item);
  if (!node.isLeaf()) visibleLeaves(tree, guard, all, node.children[0], leaves);
  if (!node.isLeaf()) visibleLeaves(tree, guard, all, node.children[1], leaves);
}

std::vector<std::set<uint32_t>> visibleInFrames(const Walk& walk) {
  std::vector<std::set<uint32_t>> result;
  SoftwareImage all(walk.scene);
  for (const Camera& camera : walk.cameras) {
    all.begin(camera);
    for (uint32_t d = 0; d < walk.parts.drawables.list.size(); ++d) {
      if (walk.parts.drawables.list[d].alpha != AlphaKind::opaque) continue;
      for (const uint32_t id : walk.parts.drawables.trianglesOf(d)) all.draw(id);
    }
    visibleLeaves(walk.parts.tree, BoxGuard(camera), all, 0, result.emplace_back());
  }
  return result;
}

TEST(Cull, IsTheRecursiveReference) {
  for (const Walk* walk : {&cityWalk(), &mixedWalk(), &plantWalk()}) {
    const auto visible = visibleInFrames(*walk);
    for (const MethodCase& c : draw_cases::exactMethods()) {
      const bool remembers = c.name == "chc" || c.name.find("assumed 0") != std::string::npos;
      if (!remembers && c.name != "stop-and-wait") continue;
      for (const uint32_t polls : {0u, 5u}) {
        SCOPED_TRACE(c.name);
        const auto method = c.make(walk->parts, {});
        const Replay replay = walk->replay(*method, {.polls = polls, .of_all = true});
        for (size_t f = 0; f < visible.size(); ++f) {
          std::set<uint32_t> expected = visible[f];
          const Frustum frustum(walk->cameras[f]);
          if (remembers && f > 0) {  // what was visible is drawn before it is asked about
            for (const uint32_t d : visible[f - 1]) {
              if (frustum.sideOf(walk->parts.drawables.list[d].box) != FrustumSide::outside)
                expected.insert(d);
            }
          }
          EXPECT_EQ(std::set<uint32_t>(replay.drawn[f].begin(), replay.drawn[f].end()), expected)
              << "frame " << f;
        }
      }
    }
  }
}

TEST(Cull, FixedScheduleGivesTheSameCounts) {
  for (const MethodCase& c : draw_cases::exactMethods()) {
    SCOPED_TRACE(c.name);
    const auto first = c.make(cityWalk().parts, {.fixed = true}),
               second = c.make(cityWalk().parts, {.fixed = true});
    const Replay a = cityWalk().replay(*first), b = cityWalk().replay(*second, {.polls = 77});
    EXPECT_EQ(a.counts, b.counts);
    EXPECT_EQ(a.drawn, b.drawn);
    first->forget();
    const Replay again = cityWalk().replay(*first);
    EXPECT_EQ(a.counts, again.counts);
    EXPECT_EQ(a.drawn, again.drawn);
  }
}

TEST(Cull, SeedMovesReTests) {
  const Replay a = cityWalk().replay(*cullChcPlus(cityWalk().parts, {}, {.fixed = true, .seed = 1}));
  const Replay b = cityWalk().replay(*cullChcPlus(cityWalk().parts, {}, {.fixed = true, .seed = 2}));
  EXPECT_NE(a.counts, b.counts);
}

TEST(Cull, EachMeasureSaves) {
  const auto sum = [](const ChcOptions& options, auto field) {
    const Replay replay = cityWalk().replay(*cullChcPlus(cityWalk().parts, options, {.fixed = true}));
    uint64_t total = 0;
    for (const FrameCounts& c : replay.counts) total += c.*field;
    return total;
  };
  EXPECT_LT(sum({}, &FrameCounts::submits), sum(plainChc(), &FrameCounts::submits));
  EXPECT_LT(sum({}, &FrameCounts::submits), sum({.batching = false}, &FrameCounts::submits));
  EXPECT_LT(sum({}, &FrameCounts::queries), sum({.assumed_frames = 0}, &FrameCounts::queries));
  EXPECT_LT(sum({}, &FrameCounts::queries), sum({.multi_queries = false}, &FrameCounts::queries));
  EXPECT_GT(sum({}, &FrameCounts::multi_queries), 0u);
  EXPECT_EQ(sum({.multi_queries = false}, &FrameCounts::multi_queries), 0u);
  uint64_t chc = 0;
  for (const FrameCounts& c : cityWalk().replay(*cullChc(cityWalk().parts, {.fixed = true})).counts)
    chc += c.queries;
  EXPECT_LT(sum({}, &FrameCounts::queries), chc);
}

TEST(Cull, LateDrawsWhatItSawTheFrameBefore) {
  const Replay replay = cityWalk().replay(*cullLate(cityWalk().parts));
  EXPECT_GT(replay.false_pixels, 0u);
  EXPECT_GT(replay.missing, 0u);
  expectSound(cityWalk(), replay, true);
  // A camera that stands still shows all from the second frame on, and from the first, as nothing was asked
  // before.
  const Walk still = [] {
    Walk walk(generateScene("city", 5000, 1), 100, 5, 64, 48);
    walk.cameras.assign(5, walk.cameras[2]);
    walk.truths.assign(5, draw_cases::bruteForce(walk.scene, walk.parts, walk.cameras[2]));
    return walk;
  }();
  const Replay same = still.replay(*cullLate(still.parts));
  EXPECT_EQ(same.missing, 0u);
  EXPECT_LT(same.counts[2].objects, same.counts[0].objects);
}

// Faults that must be found: between the method and the backend.
class FaultyBackend : public QueryBackend {
 public:
  FaultyBackend(QueryBackend& inner) : inner_(inner) {}
  void beginFrame(const Camera& camera) override {
    camera_ = camera;
    inner_.beginFrame(camera);
  }
  QueryId submit(std::span<const uint32_t> draws, std::span<const OcclusionQuery> queries) override {
    return inner_.submit(draws, queries);
  }
  void submitList(uint32_t list) override { inner_.submitList(list); }
  bool arrived(QueryId query) override { return inner_.arrived(query); }
  bool visible(QueryId query) override { return inner_.visible(query); }
  void endFrame() override { inner_.endFrame(); }

 protected:
  QueryBackend& inner_;
  Camera camera_{};
};

/// Boxes that are smaller, by so many pixels to each side.
class ShrunkenBoxes : public FaultyBackend {
 public:
  ShrunkenBoxes(QueryBackend& inner, double pixels) : FaultyBackend(inner), pixels_(pixels) {}
  QueryId submit(std::span<const uint32_t> draws, std::span<const OcclusionQuery> queries) override {
    std::vector<std::vector<AxisBox>> boxes;
    for (const OcclusionQuery& query : queries) {
      boxes.emplace_back();
      for (AxisBox box : query.boxes) {
        const Frustum::Distances distances = Frustum(camera_).distancesOf(box);
        const float by =
            float(pixels_ * 2 * distances.least / (double(glm::length(vec3(camera_.down))) * camera_.size.y));
        const vec3 middle = (box.low + box.high) * 0.5f;
        boxes.back().push_back({glm::min(box.low + by, middle), glm::max(box.high - by, middle)});
      }
    }
    std::vector<OcclusionQuery> changed;
    for (const std::vector<AxisBox>& of : boxes) changed.push_back({of});
    return inner_.submit(draws, changed);
  }

 private:
  double pixels_;
};

/// Only the first box of a query is drawn.
class FirstBoxOnly : public FaultyBackend {
 public:
  using FaultyBackend::FaultyBackend;
  QueryId submit(std::span<const uint32_t> draws, std::span<const OcclusionQuery> queries) override {
    std::vector<OcclusionQuery> changed;
    for (const OcclusionQuery& query : queries) changed.push_back({query.boxes.first(1)});
    return inner_.submit(draws, changed);
  }
};

/// Each answer is that of the query before it.
class MixedUpAnswers : public FaultyBackend {
 public:
  using FaultyBackend::FaultyBackend;
  bool visible(QueryId query) override { return inner_.visible(query > 0 ? query - 1 : query); }
};

/// Whoever has not arrived yet is hidden.
class NoWait : public FaultyBackend {
 public:
  using FaultyBackend::FaultyBackend;
  bool visible(QueryId query) override { return inner_.arrived(query) && inner_.visible(query); }
};

/// Answers with which every eighth visible node is called hidden.
class Forgetful : public FaultyBackend {
 public:
  using FaultyBackend::FaultyBackend;
  bool visible(QueryId query) override { return inner_.visible(query) && mixBits(query + 1) % 8 != 0; }
};

TEST(CullFaults, AreSeen) {
  for (const MethodCase& c : draw_cases::exactMethods()) {
    if (c.name != "stop-and-wait" && c.name != "chc" && c.name != "chc++" && c.name != "opti-chc++") continue;
    const auto wrong = [&](auto&& fault, uint32_t polls = 0) {
      SoftwareBackend backend(cityWalk().scene, cityWalk().parts.drawables, nullptr, {.polls = polls});
      auto between = fault(backend);
      const auto method = c.make(cityWalk().parts, {.fixed = polls == 0});
      return cityWalk().replay(*method, backend, between).false_pixels;
    };
    SCOPED_TRACE(c.name);
    EXPECT_EQ(wrong([](QueryBackend& b) { return FaultyBackend(b); }), 0u);
    EXPECT_GT(wrong([](QueryBackend& b) { return ShrunkenBoxes(b, 1); }), 0u);
    EXPECT_GT(wrong([](QueryBackend& b) { return MixedUpAnswers(b); }), 0u);
    EXPECT_GT(wrong([](QueryBackend& b) { return NoWait(b); }, 1000), 0u);
    EXPECT_GT(wrong([](QueryBackend& b) { return Forgetful(b); }), 0u);
    if (c.name == "opti-chc++" || c.name == "chc++") {
      EXPECT_GT(wrong([](QueryBackend& b) { return FirstBoxOnly(b); }), 0u);
    }
  }
}

}  // namespace
}  // namespace sightline
