// What holes, sides and glass cost: a forest of leaves, two triangles each, in a box; the same rays in the
// same leaves, opaque, masked, single-sided and of glass, in turns in one run, as a share of the opaque
// speed.
//
//   bench_surfaces [--triangles N] [--rays N] [--runs N] [--device cpu,opencl,vulkan,...]
//
// Masks are 64 by 64 texels, of which a disc holds (64 %). Of glass is every 16th leaf. Rays begin anywhere
// in the box and go anywhere; masked leaves let them fly farther, which counts.
#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "bvh/bvh.h"
#include "core/cli/number_checks.h"
#include "core/device/registry/make_device.h"
#include "core/scene/masked_triangle.h"
#include "tests/bench/bench_main.h"

namespace sightline {
namespace {

struct Options {
  uint64_t triangles = 2'000'000;
  uint32_t rays = 1'000'000;
  int runs = 5;
  std::vector<std::string> devices = {"cpu", "opencl"};
};

enum class Leaves { kOpaque, kMasked, kSingleSided, kGlass };
constexpr const char* kNames[] = {"opaque", "masked", "single-sided", "glass"};
constexpr uint32_t kMaskSide = 64;
constexpr uint32_t kGlassEvery = 16;

class Forest {
 public:
  explicit Forest(uint64_t triangles) {
    // So large that a ray flies through a fifth of the box before it meets one.
    const float size = std::sqrt(7.2f / float(triangles));
    for (uint64_t i = 0; i < triangles / 2; ++i) {
      const vec3 center = point(), across = (point() * 2.0f - 1.0f) * size,
                 along = (point() * 2.0f - 1.0f) * size;
      const auto first = uint32_t(scene_.positions.size());
      scene_.positions.insert(scene_.positions.end(), {center - across - along, center + across - along,
                                                       center + across + along, center - across + along});
      scene_.triangles.emplace_back(first, first + 1, first + 2);
      scene_.triangles.emplace_back(first, first + 2, first + 3);
    }
    scene_.objects = {{"leaves", 0, scene_.triangleCount()}};
    bvh_ = buildBvh(scene_.positions, scene_.triangles);
  }

  Scene with(Leaves kind) const {
    Scene scene = scene_;
    if (kind == Leaves::kOpaque) return scene;
    Surfaces& surfaces = scene.surfaces;
    const double side = kMaskSide;
    if (kind == Leaves::kMasked) {
      const uint32_t mask =
          addMask(surfaces, kMaskSide, kMaskSide, {kWrapClamp, kWrapClamp}, [&](uint64_t i) {
            const double x = double(i % kMaskSide) - side / 2 + 0.5,
                         y = double(i / kMaskSide) - side / 2 + 0.5;
            return x * x + y * y < 0.64 * side * side / 3.1415926;
          });
      const MaskedTriangle lower =
          *maskedTriangle(surfaces, mask, {glm::dvec2(0, side), {side, side}, {side, 0}});
      const MaskedTriangle upper = *maskedTriangle(surfaces, mask, {glm::dvec2(0, side), {side, 0}, {0, 0}});
      for (uint32_t i = 0; i < scene.triangleCount(); ++i)
        surfaces.masked.push_back(i % 2 == 0 ? lower : upper);
    }
    for (uint32_t i = 0; i < scene.triangleCount(); ++i) {
      const bool glass = i / 2 % kGlassEvery == 0;
      surfaces.words.push_back(kind == Leaves::kMasked        ? kSurfaceMasked | i
                               : kind == Leaves::kSingleSided ? kSurfaceFrontOnly
                                                              : (glass ? kSurfaceGlass : 0u));
    }
    return scene;
  }

  std::vector<Ray> rays(uint32_t count) {
    std::vector<Ray> rays(count);
    for (Ray& ray : rays) ray = {vec4(point(), 0), vec4(point() * 2.0f - 1.0f, 0)};
    return rays;
  }

  const Bvh& bvh() const { return bvh_; }

 private:
  vec3 point() {
    const auto unit = [&] { return float(random_() >> 8) * 0x1p-24f; };
    const float x = unit(), y = unit(), z = unit();
    return {x, y, z};
  }

  std::mt19937 random_{1};
  Scene scene_;
  Bvh bvh_;
};

double seconds(Device& device, const std::vector<Ray>& rays, std::vector<Hit>& hits, bool glass) {
  const auto start = std::chrono::steady_clock::now();
  device.traceRays(rays, hits);
  if (glass) device.traceGlass(rays, hits);
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void run(const Options& options) {
  Forest forest(options.triangles);
  const std::vector<Ray> rays = forest.rays(options.rays);
  std::vector<Hit> hits(rays.size());
  fmt::print(
      "forest of {} triangles, {} rays; median of {} runs in turns\ndevice    leaves        Mrays/s  share "
      "of opaque  spread %  hits %\n",
      options.triangles / 2 * 2, rays.size(), options.runs);
  for (const std::string& name : options.devices) {
    std::vector<std::unique_ptr<Device>> devices;
    std::vector<Scene> scenes;
    scenes.reserve(4);
    for (int kind = 0; kind < 4; ++kind) {
      scenes.push_back(forest.with(Leaves(kind)));
      devices.push_back(makeDevice(name, scenes.back(), forest.bvh()));
    }
    std::vector<std::vector<double>> times(devices.size());
    std::vector<double> met(devices.size());
    for (int turn = -1; turn < options.runs; ++turn) {  // the first warms up
      for (size_t kind = 0; kind < devices.size(); ++kind) {
        const double took = seconds(*devices[kind], rays, hits, Leaves(kind) == Leaves::kGlass);
        if (turn >= 0) times[kind].push_back(took);
        met[kind] =
            double(std::ranges::count_if(hits, [](const Hit& h) { return h.triangle != kNoTriangle; })) /
            double(hits.size());
      }
    }
    double opaque = 0;
    for (size_t kind = 0; kind < devices.size(); ++kind) {
      std::ranges::sort(times[kind]);
      const double median = times[kind][times[kind].size() / 2];
      if (kind == 0) opaque = median;
      fmt::print("{:9} {:13} {:7.2f} {:16.2f} {:9.1f} {:7.1f}\n", name, kNames[kind],
                 double(rays.size()) / median * 1e-6, opaque / median,
                 100 * (times[kind].back() - times[kind].front()) / median, 100 * met[kind]);
    }
  }
}

}  // namespace
}  // namespace sightline

int main(int argc, char** argv) {
  using sightline::between;
  sightline::Options options;
  CLI::App app("What holes, sides and glass cost", "bench_surfaces");
  app.add_option("--triangles", options.triangles)->check(between(1000, 20e6))->capture_default_str();
  app.add_option("--rays", options.rays)->check(between(1, 1u << 30))->capture_default_str();
  app.add_option("--runs", options.runs)->check(between(1, 1e6))->capture_default_str();
  app.add_option("--device", options.devices, "devices, each in its turn")
      ->delimiter(',')
      ->capture_default_str();
  return sightline::benchMain(app, argc, argv, [&] { sightline::run(options); });
}
