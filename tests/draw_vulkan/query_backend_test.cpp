// What Vulkan draws and answers, against the processor's own drawing and against rays in double.
#include <cmath>
#include <optional>

#include "core/draw/cull_methods.h"
#include "core/draw/pvs_units.h"
#include "core/draw/software_backend.h"
#include "tests/draw/method_cases.h"
#include "tests/draw_vulkan/mixed_scene.h"
#include "tests/support/random_triangles.h"

namespace sightline {
namespace {

using drawing_cases::City;
using drawing_cases::withSurfaces;
using testing_support::Random;

uint64_t falsePixels(const City& city, CullMethod& method, const std::vector<Camera>& path) {
  VulkanDrawing drawing("vulkan", city.scene, city.parts.drawables);
  VulkanQueryBackend backend(drawing);
  DepthCheck check(drawing);
  std::vector<uint32_t> drawn;
  uint64_t result = 0, number = 0;
  for (const Camera& camera : path) {
    drawn.clear();
    method.drawFrame(camera, number++, backend, drawn);
    const DepthDifference difference = check.compare();
    result += difference.false_pixels;
    EXPECT_EQ(difference.too_near_pixels, 0u);
    for (const DepthDifference::Missing& missing : difference.missing) {
      EXPECT_EQ(std::count(drawn.begin(), drawn.end(), missing.drawable), 0) << "drawn, and missing";
    }
  }
  return result;
}

TEST(VulkanQueries, EveryMethodShowsWhatDrawingEverythingShows) {
  SL_SKIP_WITHOUT_DRAWING();
  const City city;
  for (const bool fixed : {true, false}) {
    for (const auto& its : draw_cases::exactMethods()) {
      const auto method = its.make(city.parts, {.fixed = fixed});
      EXPECT_EQ(falsePixels(city, *method, city.path(12, 97, 61)), 0u)
          << its.name << (fixed ? " fixed" : " live");
    }
  }
  for (const auto& its : draw_cases::exactMethods()) {
    if (its.name.find(' ') != std::string::npos) continue;  // of CHC++ its two versions
    EXPECT_EQ(falsePixels(city, *its.make(city.parts, {}), city.path(10, 160, 120)), 0u) << its.name;
    EXPECT_EQ(falsePixels(city, *its.make(city.parts, {}), city.path(6, 1, 1)), 0u) << its.name;
  }
  EXPECT_GT(falsePixels(city, *cullLate(city.parts), city.path(24, 160, 120)), 0u)
      << "the comparison sees nothing";
}

TEST(VulkanQueries, MethodsKnowGlassHolesAndSides) {
  SL_SKIP_WITHOUT_DRAWING();
  const City mixed(withSurfaces(generateScene("city", 4000, 2), true));
  for (const auto& its : draw_cases::exactMethods()) {
    if (its.name.find(' ') != std::string::npos) continue;
    EXPECT_EQ(falsePixels(mixed, *its.make(mixed.parts, {}), mixed.path(8, 97, 61)), 0u) << its.name;
  }
}

/// Images are those of the processor: the same drawable at all but a few pixels (edges, depth that is nearly
/// the same), and there the same depth but for its last digits.
TEST(VulkanQueries, DrawsWhatTheProcessorDraws) {
  SL_SKIP_WITHOUT_DRAWING();
  const City mixed(withSurfaces(generateScene("city", 4000, 2), true));
  VulkanDrawing drawing("vulkan", mixed.scene, mixed.parts.drawables);
  VulkanQueryBackend vulkan(drawing);
  SoftwareBackend processor(mixed.scene, mixed.parts.drawables);
  const auto owner = drawableOfTriangles(mixed.parts.drawables);
  uint64_t pixels = 0, other = 0, other_depth = 0;
  for (const Camera& camera : mixed.path(6, 160, 120)) {
    for (QueryBackend* backend : std::initializer_list<QueryBackend*>{&vulkan, &processor}) {
      std::vector<uint32_t> drawn;
      cullNothing(mixed.parts)->drawFrame(camera, 0, *backend, drawn);
    }
    const auto ids = drawing.readIds();
    const auto depth = drawing.readDepth();
    for (size_t i = 0; i < ids.size(); ++i) {
      const uint32_t triangle = processor.image().ids()[i];
      ++pixels;
      other += ids[i] != (triangle == kNoTriangle ? kNoDrawable : owner[triangle]);
      other_depth += std::fabs(depth[i] - processor.image().depth()[i]) > 2e-3f * depth[i];
    }
  }
  EXPECT_LE(other * 200, pixels) << other << " of " << pixels;
  EXPECT_LE(other_depth * 200, pixels) << other_depth << " of " << pixels;
}

/// Where a ray through the middle of a pixel enters the box: distance along `forward`; nothing if it misses.
std::optional<double> entry(const Camera& camera, const AxisBox& box, uint32_t x, uint32_t y) {
  const glm::dvec3 eye(xyz3(camera.eye)), forward(xyz3(camera.forward)), across(xyz3(camera.across)),
      down(xyz3(camera.down));
  const double a = 2 * (x + 0.5) / camera.size.x - 1, b = 2 * (y + 0.5) / camera.size.y - 1;
  const glm::dvec3 direction =
      forward + across * (a / glm::dot(across, across)) + down * (b / glm::dot(down, down));
  double first = 0, last = INFINITY;
  for (int axis = 0; axis < 3; ++axis) {
    double near = (box.low[axis] - eye[axis]) / direction[axis],
           far = (box.high[axis] - eye[axis]) / direction[axis];
    if (near > far) std::swap(near, far);
    first = std::max(first, near);
    last = std::min(last, far);
  }
  if (!(first < last)) return {};
  return first;
}

/// Answers against rays through all pixels, where these leave no doubt: by a box a little smaller and nearer,
/// and by one a little larger and farther.
TEST(VulkanQueries, AnswersAreWhatRaysSay) {
  SL_SKIP_WITHOUT_DRAWING();
  const City city;
  VulkanDrawing drawing("vulkan", city.scene, city.parts.drawables);
  VulkanQueryBackend backend(drawing);
  Random random(3);
  uint64_t seen = 0, hidden = 0;
  for (const Camera& camera : city.path(6, 64, 48)) {
    backend.beginFrame(camera);
    std::vector<uint32_t> all(city.parts.drawables.list.size());
    for (uint32_t i = 0; i < all.size(); ++i) all[i] = i;
    std::vector<AxisBox> boxes;
    const glm::vec3 eye = xyz3(camera.eye), forward = xyz3(camera.forward);
    while (boxes.size() < 300) {
      const float distance = 2 + 60 * random.unit();
      const glm::vec3 middle = eye + forward * distance + random.point(0.5f * distance);
      const glm::vec3 half = glm::abs(random.point(0.1f * distance)) + 0.02f;
      const AxisBox box{middle - half, middle + half};
      bool ahead = true;
      for (int c = 0; c < 8; ++c) {
        const glm::vec3 p(c & 1 ? box.low.x : box.high.x, c & 2 ? box.low.y : box.high.y,
                          c & 4 ? box.low.z : box.high.z);
        ahead = ahead && clipPosition(camera, p).w > 0.5f;
      }
      if (ahead) boxes.push_back(box);
    }
    std::vector<OcclusionQuery> queries;
    for (const AxisBox& box : boxes) queries.push_back({{&box, 1}});
    const QueryId first = backend.submit(all, queries);
    std::vector<bool> answers;
    for (size_t i = 0; i < boxes.size(); ++i) answers.push_back(backend.visible(first + i));
    backend.endFrame();
    const auto depth = drawing.readDepth();
    for (size_t i = 0; i < boxes.size(); ++i) {
      const glm::vec3 little = (boxes[i].high - boxes[i].low) * 0.02f;
      const glm::vec3 pixel(0.02f * glm::length(boxes[i].high - eye) / 24);
      const AxisBox smaller{boxes[i].low + little, boxes[i].high - little};
      const AxisBox larger{boxes[i].low - little - pixel, boxes[i].high + little + pixel};
      bool surely = false, perhaps = false;
      for (uint32_t y = 0; y < 48; ++y) {
        for (uint32_t x = 0; x < 64; ++x) {
          const double at = depth[y * 64 + x];
          const auto inner = entry(camera, smaller, x, y), outer = entry(camera, larger, x, y);
          surely = surely || (inner && camera.eye.w / *inner > at * 1.001);
          perhaps = perhaps || (outer && camera.eye.w / *outer >= at * 0.999);
        }
      }
      if (surely || !perhaps) {
        EXPECT_EQ(answers[i], surely) << "box " << i;
      }
      seen += surely;
      hidden += !perhaps;
    }
  }
  EXPECT_GT(seen, 100u);
  EXPECT_GT(hidden, 100u);
}

/// Many submits in a frame, answers of the frame before, and of submits whose command buffers were used again
/// since.
TEST(VulkanQueries, AnswersOutliveTheirCommandBuffers) {
  SL_SKIP_WITHOUT_DRAWING();
  testing_support::SceneOfBoxes made;
  made.addRectangle({-1, -1, -5}, {2, 0, 0}, {0, 2, 0});
  const City city(made.finish());
  VulkanDrawing drawing("vulkan", city.scene, city.parts.drawables);
  VulkanQueryBackend backend(drawing);
  const Camera camera = drawing_cases::cameraAt(city.parts, {0, 0, 0}, {0, 0, -1}, 8, 8);
  const AxisBox before{{-1, -1, -4}, {1, 1, -3}}, behind{{-1, -1, -8}, {1, 1, -7}};
  const uint32_t wall = 0;
  for (int frame = 0; frame < 3; ++frame) {
    backend.beginFrame(camera);
    const OcclusionQuery both[] = {{{&before, 1}}, {{&behind, 1}}};
    const QueryId first = backend.submit({&wall, 1}, both);
    EXPECT_EQ(first, uint64_t(frame) * 2 * 201);
    for (int i = 0; i < 200; ++i) backend.submit({}, both);
    for (QueryId id = first; id < first + 2 * 201; ++id) EXPECT_EQ(backend.visible(id), id % 2 == 0);
    EXPECT_TRUE(backend.arrived(first));
    EXPECT_GE(drawing.ring().size(), 64u);
    const uint64_t waits = drawing.ring().waits();
    drawing.ring().drain();
    for (QueryId id = first; id < first + 2 * 201; ++id) EXPECT_TRUE(backend.arrived(id));
    EXPECT_TRUE(backend.visible(first));
    EXPECT_EQ(drawing.ring().waits(), waits) << "what has arrived is not waited for";
    if (frame > 0) {
      EXPECT_TRUE(backend.visible(first - 2 * 201)) << "of the frame before";
    }
    backend.endFrame();
  }
  EXPECT_THROW(backend.visible(0), std::out_of_range) << "two frames ago";
  EXPECT_THROW(backend.visible(1'000'000), std::out_of_range);
}

/// Submits that wait for each other by semaphores give the same frames, and the same answers.
TEST(VulkanQueries, SemaphoresChangeNothing) {
  SL_SKIP_WITHOUT_DRAWING();
  const City city;
  std::vector<std::vector<float>> depths[2];
  std::vector<FrameCounts> counts[2];
  for (const bool semaphores : {false, true}) {
    VulkanDrawing drawing("vulkan", city.scene, city.parts.drawables, {},
                          {.chain = semaphores ? SubmitChain::semaphores : SubmitChain::barriers});
    VulkanQueryBackend backend(drawing);
    DepthCheck check(drawing);
    const auto method = cullChcPlus(city.parts, plainChc(), {.fixed = true});
    uint64_t number = 0;
    for (const Camera& camera : city.path(8, 97, 61)) {
      std::vector<uint32_t> drawn;
      counts[semaphores].push_back(method->drawFrame(camera, number++, backend, drawn));
      EXPECT_EQ(check.compare().false_pixels, 0u);
      depths[semaphores].push_back(drawing.readDepth());
    }
  }
  EXPECT_EQ(counts[0], counts[1]);
  EXPECT_EQ(depths[0], depths[1]);
  EXPECT_GT(counts[0].front().submits, 10u);
}

/// What happened when adds up to what is told of parts, without an overlap.
TEST(VulkanQueries, SpansAddUpToTimes) {
  SL_SKIP_WITHOUT_DRAWING();
  const City city;
  double now = 0;
  VulkanDrawing drawing("vulkan", city.scene, city.parts.drawables, {},
                        {.clock = [&] { return now += 0.001; }});
  VulkanQueryBackend backend(drawing);
  const auto method = cullChcPlus(city.parts, {});
  uint64_t number = 0;
  for (const Camera& camera : city.path(4, 97, 61)) {
    std::vector<uint32_t> drawn;
    const FrameCounts counts = method->drawFrame(camera, number++, backend, drawn);
    const CpuTimes cpu = drawing.ring().cpuTimes();
    const FrameSpans spans = drawing.ring().spans(drawing.frame());
    const GpuTimes gpu = drawing.ring().gpuTimes(drawing.frame());
    std::array<double, kGpuParts> parts{};
    ASSERT_GE(spans.gpu.size(), counts.submits);
    EXPECT_EQ(spans.gpu.front().begin, 0);
    double end = 0;
    for (const auto& span : spans.gpu) {
      EXPECT_GE(span.begin, end - 1e-9 * gpu.frame);
      EXPECT_GE(span.end, span.begin);
      end = span.end;
      parts[size_t(span.part)] += span.end - span.begin;
    }
    EXPECT_NEAR(end, gpu.frame, 1e-9 * gpu.frame);
    for (size_t i = 0; i < kGpuParts; ++i) EXPECT_NEAR(parts[i], gpu.part[i], 1e-9 * gpu.frame);
    std::array<double, 3> work{};
    uint64_t submits = 0;
    end = 0;
    for (const auto& span : spans.cpu) {
      EXPECT_GE(span.begin, end);
      end = span.end;
      work[size_t(span.part)] += span.end - span.begin;
      submits += span.part == CpuWork::submit;
    }
    EXPECT_EQ(submits, counts.submits);
    EXPECT_NEAR(work[size_t(CpuWork::record)], cpu.record, 1e-9 * end);
    EXPECT_NEAR(work[size_t(CpuWork::submit)], cpu.submit, 1e-9 * end);
    EXPECT_GE(work[size_t(CpuWork::wait)], cpu.look + cpu.wait - 1e-9 * end)
        << "and that for the frame's end";
  }
}

TEST(VulkanQueries, AFrameWithoutDrawsIsEmpty) {
  SL_SKIP_WITHOUT_DRAWING();
  const City city(1000);
  VulkanDrawing drawing("vulkan", city.scene, city.parts.drawables);
  VulkanQueryBackend backend(drawing);
  for (const Camera& camera : city.path(2, 33, 21)) {
    std::vector<uint32_t> drawn;
    cullNothing(city.parts)->drawFrame(camera, 0, backend, drawn);
    backend.beginFrame(camera);
    backend.endFrame();
    for (const uint32_t id : drawing.readIds()) ASSERT_EQ(id, kNoDrawable);
    for (const float depth : drawing.readDepth()) ASSERT_EQ(depth, 0.0f);
  }
}

/// A list draws its triangles, of every kind, and no others.
TEST(VulkanQueries, ListsDrawTheirTriangles) {
  SL_SKIP_WITHOUT_DRAWING();
  const City mixed(withSurfaces(generateScene("city", 2000, 2), false));
  const Drawables& drawables = mixed.parts.drawables;
  TriangleLists lists;
  std::vector<std::vector<uint32_t>> chosen(2);
  for (uint32_t list = 0; list < 2; ++list) {
    TriangleList& its = lists.lists.emplace_back();
    for (const AlphaKind kind : {AlphaKind::opaque, AlphaKind::masked, AlphaKind::blended}) {
      if (kind == AlphaKind::masked) its.masked_begin = uint32_t(its.ids.size());
      if (kind == AlphaKind::blended) its.blended_begin = uint32_t(its.ids.size());
      for (uint32_t d = 0; d < drawables.list.size(); ++d) {
        if (drawables.list[d].alpha != kind || d % 3 == list) continue;
        chosen[list].push_back(d);
        for (const uint32_t id : drawables.trianglesOf(d)) its.ids.push_back(id);
      }
    }
  }
  VulkanDrawing drawing("vulkan", mixed.scene, drawables, lists);
  VulkanQueryBackend backend(drawing);
  for (const Camera& camera : mixed.path(4, 97, 61)) {
    for (uint32_t list = 0; list < 2; ++list) {
      backend.beginFrame(camera);
      backend.submit(chosen[list], {});
      backend.endFrame();
      const auto depth = drawing.readDepth();
      auto shown = drawing.readIds();
      for (uint32_t& id : shown) id = id == kNoDrawable ? kNoDrawable : kSomeDrawable;
      backend.beginFrame(camera);
      backend.submitList(list);
      backend.endFrame();
      EXPECT_EQ(drawing.readDepth(), depth);
      EXPECT_EQ(drawing.readIds(), shown);
    }
  }
}

}  // namespace
}  // namespace sightline
