// What each way of drawing a generated walk costs a GPU, by part, and whether it shows what it should.
//
//   bench_walk [--scene city] [--triangles N] [--device vulkan] [--width 1280 --height 720] [--frames 300]
//   [--split 2048]
//
// Mean milliseconds a frame over the walk, one frame in flight, after a walk that warms up; then every
// `--check`th frame against the drawing of everything. Of the drawing thread on the processor: recording and
// submitting; finding out whether answers have arrived; what the method itself takes; and all until the frame
// has been drawn. By the fixed schedule a method does the same on all devices, so that its own time can be
// compared between builds.
#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <string>
#include <vector>

#include "core/cli/number_checks.h"
#include "core/draw/cull_methods.h"
#include "core/draw/make_camera.h"
#include "core/draw/vulkan/depth_check.h"
#include "core/draw/vulkan/vulkan_query_backend.h"
#include "core/generate/generate.h"
#include "tests/bench/bench_main.h"

namespace sightline {
namespace {

struct Settings {
  std::string scene = "city", device = "vulkan";
  uint64_t triangles = 2'000'000;
  std::vector<std::string> methods;  ///< by name; empty: all
  uint32_t width = 1280, height = 720, frames = 300, split = kDefaultSplit, check = 10;
};

double milliseconds() {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

/// Of this thread, which a driver that draws on the processor does not slow down.
double processorMilliseconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return double(time.tv_sec) * 1e3 + double(time.tv_nsec) * 1e-6;
}

/// A way of drawing: a frame, what it did, and the method on the GPU, if it is one.
struct Contestant {
  std::string name;
  std::function<void(const Camera&, uint64_t)> draw;
  std::function<FrameCounts()> counts;
  std::function<void()> forget;
  GpuCulling* culling = nullptr;
};

struct Sums {
  GpuTimes gpu;
  CpuTimes cpu;
  double own = 0;  ///< of the method on the processor
  double all = 0;  ///< of the processor, until the frame has been drawn
  uint64_t triangles = 0, draws = 0, false_pixels = 0, shown = 0, checked = 0;
};

Sums replay(VulkanDrawing& drawing, DepthCheck& check, const Contestant& contestant,
            const std::vector<Camera>& path, uint32_t check_each) {
  Sums sums;
  contestant.forget();
  for (size_t f = 0; f < path.size(); ++f) {
    const double start = milliseconds(), start_own = processorMilliseconds();
    contestant.draw(path[f], f);
    const CpuTimes cpu = drawing.ring().cpuTimes();
    sums.own += processorMilliseconds() - start_own - cpu.record - cpu.submit - cpu.look - cpu.wait;
    const GpuTimes gpu = drawing.ring().gpuTimes(drawing.frame());
    sums.all += milliseconds() - start;
    for (size_t i = 0; i < kGpuParts; ++i) sums.gpu.part[i] += gpu.part[i];
    sums.gpu.rest += gpu.rest;
    sums.gpu.frame += gpu.frame;
    sums.cpu.record += cpu.record;
    sums.cpu.submit += cpu.submit;
    sums.cpu.look += cpu.look;
    sums.cpu.wait += cpu.wait;
    const FrameCounts counts = contestant.counts();
    sums.triangles += counts.triangles;
    sums.draws += counts.draws;
    if (check_each == 0 || f % check_each != 0) continue;
    const DepthDifference difference = check.compare(contestant.culling);
    sums.false_pixels += difference.false_pixels;
    sums.shown += difference.shown.size();
    ++sums.checked;
  }
  return sums;
}

void print(const Contestant& contestant, const Sums& timed, const Sums& checked, size_t frames) {
  const double n = double(frames);
  fmt::print(
      "{:<22} {:8.3f} {:8.3f} {:8.3f} {:8.3f} {:8.3f} {:8.3f} {:8.3f} {:8.3f} {:8.3f} {:8.3f} {:10.0f} "
      "{:12.0f} "
      "{:8}\n",
      contestant.name, timed.gpu.frame / n, timed.gpu.part[0] / n, timed.gpu.part[1] / n,
      timed.gpu.part[2] / n, timed.gpu.part[3] / n, timed.gpu.rest / n,
      (timed.cpu.record + timed.cpu.submit) / n, timed.cpu.look / n, timed.own / n, timed.all / n,
      double(timed.draws) / n, double(timed.triangles) / n, checked.false_pixels);
}

void bench(const Settings& settings) {
  const Scene scene = generateScene(settings.scene, settings.triangles, 1);
  const DrawScene parts = makeDrawScene(scene, {.split = settings.split});
  VulkanDrawing drawing(settings.device, scene, parts.drawables, {}, {.clock = processorMilliseconds});
  const DeviceInfo& info = drawing.context().info();
  fmt::print("{} ({}; {})\n", info.id, info.name, info.driver);
  const CameraPath walk = generateWalk(settings.scene, settings.triangles, 1, settings.frames);
  std::vector<Camera> path;
  const float near = nearDistance(boundsOf(parts.drawables));
  for (uint32_t f = 0; f < walk.frames(); ++f) {
    const PathPlace at = placeAt(walk, f);
    path.push_back(makeCamera(lookAt(at.eye, at.look, walk.fov, settings.width, settings.height),
                              settings.width, settings.height, near));
  }
  fmt::print("{} of {} triangles in {} drawables, {} frames of {} x {}\n", settings.scene,
             scene.triangleCount(), parts.drawables.list.size(), path.size(), settings.width,
             settings.height);

  std::vector<Contestant> contestants;
  VulkanQueryBackend backend(drawing);
  std::vector<uint32_t> drawn;
  FrameCounts counts;
  std::vector<std::unique_ptr<CullMethod>> methods;
  const auto addMethod = [&](const char* name, std::unique_ptr<CullMethod> method) {
    CullMethod* its = methods.emplace_back(std::move(method)).get();
    contestants.push_back({name,
                           [&, its](const Camera& camera, uint64_t number) {
                             drawn.clear();
                             counts = its->drawFrame(camera, number, backend, drawn);
                           },
                           [&] { return counts; }, [its] { its->forget(); }});
  };
  addMethod("none", cullNothing(parts));
  addMethod("vfc", cullFrustum(parts));
  addMethod("chc", cullChc(parts));
  addMethod("chc++", cullChcPlus(parts, plainChc()));
  addMethod("opti-chc++", cullChcPlus(parts, {}));
  addMethod("opti-chc++, fixed", cullChcPlus(parts, {}, {.fixed = true}));
  std::vector<std::unique_ptr<GpuCulling>> cullings;
  const auto addCulling = [&](const char* name, GpuMethod method, bool mesh_shaders) {
    GpuCulling* its = cullings
                          .emplace_back(std::make_unique<GpuCulling>(
                              drawing, method, GpuCullingOptions{.mesh_shaders = mesh_shaders}))
                          .get();
    if (method == GpuMethod::hizMeshlets && its->usesMeshShaders() != mesh_shaders) return;
    contestants.push_back({name, [its](const Camera& camera, uint64_t) { its->drawFrame(camera); },
                           [its] { return its->counts(); }, [its] { its->forget(); }, its});
  };
  addCulling("hiz", GpuMethod::hiz, true);
  addCulling("boxes", GpuMethod::boxes, true);
  addCulling("hiz-meshlets, mesh", GpuMethod::hizMeshlets, true);
  addCulling("hiz-meshlets, lists", GpuMethod::hizMeshlets, false);

  fmt::print("{:<22} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>10} {:>12} {:>8}\n",
             "ms a frame", "GPU", "draw", "query", "pyramid", "cull", "rest", "record", "look", "own", "all",
             "draws", "triangles", "false");
  DepthCheck check(drawing);
  for (const Contestant& contestant : contestants) {
    if (!settings.methods.empty() &&
        std::ranges::find(settings.methods, contestant.name) == settings.methods.end())
      continue;
    const Sums checked = replay(drawing, check, contestant, path, settings.check);  // warms up, too
    print(contestant, replay(drawing, check, contestant, path, 0), checked, path.size());
  }
}

}  // namespace
}  // namespace sightline

int main(int argc, char** argv) {
  using sightline::between;
  sightline::Settings settings;
  CLI::App app("What each way of drawing a generated walk costs a GPU", "bench_walk");
  app.add_option("--scene", settings.scene)->capture_default_str();
  app.add_option("--triangles", settings.triangles)->check(between(1000, 2e7))->capture_default_str();
  app.add_option("--device", settings.device)->capture_default_str();
  app.add_option("--width", settings.width)->check(between(1, 16384))->capture_default_str();
  app.add_option("--height", settings.height)->check(between(1, 16384))->capture_default_str();
  app.add_option("--frames", settings.frames)->check(between(2, 1e6))->capture_default_str();
  app.add_option("--split", settings.split)->check(between(0, 1e9))->capture_default_str();
  app.add_option("--method", settings.methods, "Only these, by their names in the table");
  app.add_option("--check", settings.check, "Compare each so many frames; 0: none")->check(between(0, 1e6));
  return sightline::benchMain(app, argc, argv, [&] { sightline::bench(settings); });
}
