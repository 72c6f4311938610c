// What an OpenCL device saves of voxelising: the processor's voxeliser on so many threads and the device's,
// in turns, with equal bytes or the run fails.
//
//   bench_voxels_opencl SCENE|KIND:TRIANGLES [--voxel SIZE] [--along N] [--separate NAME] [--device NAME]
//
// Medians of the runs; the first of all warms up and does not count. The device's time is from the scene in
// the host's memory to blocks in the host's memory; to find the device, compile for it and upload the scene
// is told apart, as is what it does of the rest.
#include <fmt/core.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <vector>

#include "core/formats/load_scene.h"
#include "core/generate/generate.h"
#include "core/voxel/opencl/voxelize_opencl.h"
#include "tests/bench/bench_main.h"

namespace sightline {
namespace {

struct VoxelBenchOptions {
  std::string scene, device = "opencl", separate = "conservative";
  double voxel = 0;
  uint64_t along = 512;
  int runs = 3, threads = 2;
  bool ids = true;
  OpenClVoxelizing tuning;
};

double medianOf(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

Scene sceneOf(const std::string& text) {
  const size_t colon = text.find(':');
  if (colon == std::string::npos) return loadScene(text);
  return generateScene(text.substr(0, colon), std::stoull(text.substr(colon + 1)), 1);
}

void benchVoxelizing(const VoxelBenchOptions& bench) {
  const Scene scene = sceneOf(bench.scene);
  VoxelizeOptions options;
  options.lattice = bench.voxel > 0 ? latticeOf(bench.voxel) : latticeFor(sceneBounds(scene), bench.along);
  options.separation = bench.separate == "26"  ? Separation::k26
                       : bench.separate == "6" ? Separation::k6
                                               : Separation::kConservative;
  options.with_triangles = bench.ids;
  std::vector<double> seconds[2], parts[4];
  OpenClVoxelized done;
  uint64_t voxels = 0;
  for (int run = 0; run <= bench.runs; ++run) {
    std::vector<VoxelBlock> blocks[2];
    for (int which = 0; which < 2; ++which) {
      const auto take = [&](VoxelBlock&& block) { blocks[which].push_back(std::move(block)); };
      const auto start = std::chrono::steady_clock::now();
      if (which == 0) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, size_t(bench.threads));
        voxelize(scene, options, take);
      } else {
        done = voxelizeOpenCl(scene, options, bench.device, take, bench.tuning);
      }
      const double taken = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      if (run > 0) seconds[which].push_back(which == 0 ? taken : taken - done.setup_seconds);
    }
    if (run > 0) {
      parts[0].push_back(done.setup_seconds);
      parts[1].push_back(done.device_seconds);
      parts[2].push_back(done.host_seconds);
      parts[3].push_back(done.bin_seconds);
    }
    if (blocks[0] != blocks[1]) throw Error(bench.scene + ": the device's voxels differ");
    voxels = 0;
    for (const VoxelBlock& block : blocks[0]) voxels += block.count();
  }
  const double host = medianOf(seconds[0]), device = medianOf(seconds[1]), working = medianOf(parts[1]),
               collecting = medianOf(parts[2]), binning = medianOf(parts[3]);
  fmt::print(
      "{}: {} triangles, voxels of {}: {} voxels, {} pairs; {} triangles, {} rows and {} pairs open, {} "
      "launches again\n",
      bench.scene, scene.triangleCount(), options.lattice.voxelSize(), voxels, done.pairs,
      done.open_triangles, done.open_rows, done.open_pairs, done.repeats);
  fmt::print("  processor, {} threads: {:.4f} s, {:.1f} Mvoxels/s\n", bench.threads, host,
             double(voxels) * 1e-6 / host);
  fmt::print(
      "  {}, {} threads on the host: {:.4f} s, {:.1f} Mvoxels/s, {:.1f} times; of it bins {:.4f}, voxels and "
      "bus {:.4f}, "
      "bricks and open rows {:.4f}, ids and the rest {:.4f} s; before it {:.3f} s\n",
      bench.device, tbb::info::default_concurrency(), device, double(voxels) * 1e-6 / device, host / device,
      binning, working, collecting, device - working - collecting - binning, medianOf(parts[0]));
}

}  // namespace
}  // namespace sightline

int main(int argc, char** argv) {
  sightline::VoxelBenchOptions options;
  CLI::App app("Voxelising on the processor and on an OpenCL device", "bench_voxels_opencl");
  app.add_option("SCENE", options.scene, "a file, or KIND:TRIANGLES to generate")->required();
  app.add_option("--voxel", options.voxel, "size");
  app.add_option("--along", options.along, "without a size: voxels along the longest side")
      ->capture_default_str();
  app.add_option("--separate", options.separate)
      ->check(CLI::IsMember({"conservative", "26", "6"}))
      ->capture_default_str();
  app.add_option("--device", options.device)->capture_default_str();
  app.add_option("--threads", options.threads, "of the processor's voxeliser")->capture_default_str();
  app.add_option("--runs", options.runs)->check(CLI::Range(1, 1000))->capture_default_str();
  app.add_option("--group", options.tuning.group, "work items a block");
  app.add_option("--blocks", options.tuning.blocks_a_time, "a launch")->capture_default_str();
  app.add_flag("--floats", options.tuning.floats);
  app.add_flag("!--no-ids", options.ids, "without the triangles of blocks");
  return sightline::benchMain(app, argc, argv, [&] { sightline::benchVoxelizing(options); });
}
