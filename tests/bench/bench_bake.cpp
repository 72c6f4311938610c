// Where the time of a bake goes: seconds of each kind of device call, and of the host between them. The
// tracing stages make their rays and insert what they hit in the same launch.
//
//   bench_bake SCENE CELLS.json [--device NAME] [--runs N] [--batch-rays N] [--spatial-splits]
//
// Of each cell: the run with the median time; the first run of all warms up and does not count.
#include <fmt/core.h>

#include <algorithm>
#include <string>
#include <vector>

#include "core/cli/number_checks.h"
#include "core/device/registry/make_device.h"
#include "core/formats/cells_file.h"
#include "core/formats/load_scene.h"
#include "core/gvs/bake_cell.h"
#include "core/scene/scene_tree.h"
#include "tests/bench/bench_main.h"
#include "tests/bench/timed_device.h"

namespace sightline {
namespace {

struct Options {
  std::string scene, cells, device = "opencl";
  int runs = 3;
  uint32_t batch_rays = BakeParams{}.batch_rays;
  bool spatial_splits = false;
};

struct Run {
  double seconds;
  CellStats stats;
  size_t set;
  std::map<std::string, double> parts;
};

Run bakeOnce(Device& device, const Scene& scene, const ViewCell& cell, uint32_t index,
             const Options& options) {
  BakeParams params;
  params.batch_rays = options.batch_rays;
  TimedDevice timed(device);
  const auto start = std::chrono::steady_clock::now();
  const CellPvs pvs = bakeCell(timed, scene, cell, index, params);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return {seconds, pvs.stats, pvs.triangles.size(), timed.seconds()};
}

void print(const std::string& cell, const Run& run) {
  const CellStats& s = run.stats;
  const uint64_t rays = s.random.rays + s.border.rays + s.reverse.rays + s.validation_rays;
  fmt::print("{}: {:.3f} s, {} triangles, {:.1f} million rays, {:.0f} Mrays/s\n", cell, run.seconds, run.set,
             double(rays) * 1e-6, double(rays) * 1e-6 / run.seconds);
  const std::map<std::string, uint64_t> rays_of = {{"trace random", s.random.rays},
                                                   {"trace border", s.border.rays},
                                                   {"trace reverse", s.reverse.rays},
                                                   {"trace validation", s.validation_rays}};
  double device = 0, tracing = 0;
  for (const auto& [what, seconds] : run.parts) {
    const auto traced = rays_of.find(what);
    device += seconds;
    if (traced != rays_of.end()) tracing += seconds;
    fmt::print("  {:<17} {:8.4f} s {:5.1f} %", what, seconds, 100 * seconds / run.seconds);
    if (traced != rays_of.end()) fmt::print("  {:7.0f} Mrays/s", double(traced->second) * 1e-6 / seconds);
    fmt::print("\n");
  }
  fmt::print("  {:<17} {:8.4f} s {:5.1f} %\n", "host", run.seconds - device,
             100 * (run.seconds - device) / run.seconds);
  fmt::print("  tracing stages in all: {:.1f} %\n", 100 * tracing / run.seconds);
}

void bench(const Options& options) {
  const Scene scene = loadScene(options.scene);
  const std::vector<ViewCell> cells = loadCells(options.cells);
  const Bvh bvh = buildSceneTree(scene, {.spatial_splits = options.spatial_splits});
  const auto device = makeDevice(options.device, scene, bvh);
  fmt::print("{} ({}), {} triangles\n", device->info().id, device->info().name, scene.triangleCount());
  bakeOnce(*device, scene, cells.at(0), 0, options);
  for (uint32_t i = 0; i < cells.size(); ++i) {
    std::vector<Run> runs;
    for (int run = 0; run < options.runs; ++run) {
      runs.push_back(bakeOnce(*device, scene, cells[i], i, options));
    }
    std::sort(runs.begin(), runs.end(), [](const Run& a, const Run& b) { return a.seconds < b.seconds; });
    print(cells[i].name, runs[runs.size() / 2]);
  }
}

}  // namespace
}  // namespace sightline

int main(int argc, char** argv) {
  using sightline::between;
  sightline::Options options;
  CLI::App app("Where the time of a bake goes", "bench_bake");
  app.add_option("SCENE", options.scene)->required();
  app.add_option("CELLS", options.cells, "view cells, JSON")->required();
  app.add_option("--device", options.device)->capture_default_str();
  app.add_option("--runs", options.runs, "of each cell")->check(between(1, 1e6))->capture_default_str();
  app.add_option("--batch-rays", options.batch_rays, "as of sightline bake")
      ->check(between(4096, 1u << 28))
      ->capture_default_str();
  app.add_flag("--spatial-splits", options.spatial_splits);
  return sightline::benchMain(app, argc, argv, [&] { sightline::bench(options); });
}
