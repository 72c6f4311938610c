// What a scene with instances costs: random rays of its cells through two levels, and through the plain scene
// that it stands for, in turns; with what both take to build, and their memory on the device.
//
//   bench_instances SCENE CELLS.json [--device NAME] [--rays N] [--runs N] [--holes]
//
// --holes: every other stored triangle gets holes, half of its area.
// The scene must be one that loads with instances. Both find the same triangles, or the run fails (of devices
// that trace by their own test: says how many differ). Medians of the runs; the first of all warms up and
// does not count.
#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <vector>

#include "core/device/registry/make_device.h"
#include "core/formats/cells_file.h"
#include "core/formats/load_scene.h"
#include "core/sampling/make_stage_params.h"
#include "core/sampling/random_segment.h"
#include "core/scene/instances.h"
#include "core/scene/masked_triangle.h"
#include "core/scene/scene_tree.h"
#include "tests/bench/bench_main.h"

namespace sightline {
namespace {

using Clock = std::chrono::steady_clock;

struct Options {
  std::string scene, cells, device = "opencl";
  uint32_t rays = 2'000'000;
  int runs = 5;
  bool holes = false;
};

/// Squares, every other one a hole, 32 on each of every other triangle.
void addHoles(Scene& scene) {
  constexpr uint32_t kSide = 8;
  const uint32_t mask = addMask(scene.surfaces, kSide, kSide, {kWrapClamp, kWrapClamp},
                                [](uint64_t i) { return (i / kSide + i) % 2 == 0; });
  const glm::dvec2 corners[3] = {{0, 0}, {kSide, 0}, {0, kSide}};
  const MaskedTriangle places = *maskedTriangle(scene.surfaces, mask, corners);
  scene.surfaces.words.assign(scene.triangles.size(), 0u);
  for (size_t i = 0; i < scene.triangles.size(); i += 2) {
    scene.surfaces.words[i] = kSurfaceMasked | uint32_t(scene.surfaces.masked.size());
    scene.surfaces.masked.push_back(places);
  }
}

double since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// A scene in one of its forms, on a device.
struct Form {
  Form(const char* form_name, Scene form_scene, const std::string& selector)
      : name(form_name), scene(std::move(form_scene)) {
    const auto start = Clock::now();
    bvh = buildSceneTree(scene);
    build_seconds = since(start);
    device = makeDevice(selector, scene, bvh);
  }

  /// Seconds of `rays` random rays of the cell.
  double trace(const ViewCell& cell, uint32_t rays) {
    const std::vector<Face> faces = cellFaces(cell);
    device->beginCell(faces, makeStageParams(BakeParams(), faces, uvec4(1, 2, 3, 4)));
    device->counters();
    const auto start = Clock::now();
    const auto count = uint32_t(rays / faces.size());
    for (uint32_t face = 0; face < faces.size(); ++face) {
      device->traceRandom(makeRandomSegment(face, uint64_t(face) * count, count, 1 + face * count));
    }
    traced = device->counters().rays;
    return since(start);
  }

  std::vector<uint32_t> found() {
    device->collect(kStageRandom);
    std::vector<uint32_t> ids;
    for (const PvsEntry& entry : device->readPvs()) ids.push_back(entry.origin_triangle.w);
    return ids;
  }

  const char* name;
  Scene scene;
  Bvh bvh;
  std::unique_ptr<Device> device;
  double build_seconds = 0;
  uint64_t traced = 0;
};

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

void bench(const Options& options) {
  Scene scene = loadScene(options.scene);
  if (!scene.hasInstances()) throw Error(options.scene + ": loads as a plain scene");
  if (options.holes) addHoles(scene);
  const std::vector<ViewCell> cells = loadCells(options.cells);
  Scene plain = flatten(scene);
  Form forms[2] = {{"instances", std::move(scene), options.device},
                   {"flattened", std::move(plain), options.device}};
  fmt::print("{}, {} runs of {} random rays a cell\n", forms[0].device->info().name, options.runs,
             options.rays);
  for (Form& form : forms) {
    fmt::print("{}: {} triangles, {} stored; tree built in {:.2f} s, {:.1f} MiB on the device\n", form.name,
               form.scene.triangleCount(), form.scene.triangles.size(), form.build_seconds,
               double(form.device->counters().memory_bytes) / 0x1p20);
  }
  double total[2] = {};
  uint64_t rays = 0;
  for (const ViewCell& cell : cells) {
    std::vector<double> seconds[2];
    for (int run = 0; run <= options.runs; ++run) {
      for (int f = 0; f < 2; ++f) {
        const double taken = forms[f].trace(cell, options.rays);
        if (run > 0) seconds[f].push_back(taken);
      }
    }
    const std::vector<uint32_t> ids[2] = {forms[0].found(), forms[1].found()};
    std::vector<uint32_t> differ;
    std::ranges::set_symmetric_difference(ids[0], ids[1], std::back_inserter(differ));
    if (!differ.empty() && forms[0].device->info().exact) throw Error(cell.name + ": the sets differ");
    const double both[2] = {median(seconds[0]), median(seconds[1])};
    fmt::print("  {:<10} {:8.1f} Mrays/s with instances, {:8.1f} flattened: {:.2f}; {} triangles{}\n",
               cell.name, double(forms[0].traced) * 1e-6 / both[0], double(forms[1].traced) * 1e-6 / both[1],
               both[1] / both[0], ids[0].size(),
               differ.empty() ? "" : fmt::format(", {} in one only", differ.size()));
    for (int f = 0; f < 2; ++f) total[f] += both[f];
    rays += forms[0].traced;
  }
  fmt::print("all: {:.1f} Mrays/s with instances, {:.1f} flattened: {:.2f}\n", double(rays) * 1e-6 / total[0],
             double(rays) * 1e-6 / total[1], total[1] / total[0]);
}

}  // namespace
}  // namespace sightline

int main(int argc, char** argv) {
  sightline::Options options;
  CLI::App app("Rays through instances, and through the plain scene", "bench_instances");
  app.add_option("SCENE", options.scene)->required();
  app.add_option("CELLS", options.cells, "view cells, JSON")->required();
  app.add_option("--device", options.device)->capture_default_str();
  app.add_option("--rays", options.rays, "of each cell")->capture_default_str();
  app.add_option("--runs", options.runs)->capture_default_str();
  app.add_flag("--holes", options.holes, "in every other stored triangle");
  return sightline::benchMain(app, argc, argv, [&] { sightline::bench(options); });
}
