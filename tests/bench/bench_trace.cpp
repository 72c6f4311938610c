// Speed of tracing on a generated city: the devices cpu, opencl and, if named, vulkan and, as the peer,
// Embree 3 (robust, single rays, all threads), in turns in one run; hits are compared in the same run.
//
//   bench_trace [--triangles N] [--rays N] [--runs N] [--device opencl[:...]] [--leaf N] [--spatial] [--json]
//               [--vulkan vulkan[:...]] [--processor-time] [--skip cpu,opencl,embree]
//
// random: rays of the first flat, volumetric and street cell, N a cell over its faces by area. Our devices
// generate the rays themselves, in strata order, and that counts; Embree gets them ready-made in Halton
// order. border: rays to the border polygons of triangles that the random rays hit, ready-made for all, same
// order.
#include <fmt/core.h>

#include <algorithm>
#include <string>
#include <vector>

#include "core/cli/number_checks.h"
#include "core/device/device.h"
#include "tests/bench/bench_main.h"
#include "tests/bench/embree_contestant.h"
#include "tests/bench/trace_contestants.h"
#include "tests/bench/trace_race.h"

namespace sightline {
namespace {

struct Options {
  uint64_t triangles = 2'000'000;
  uint32_t rays = 4'000'000;
  std::string device = "opencl";
  std::string vulkan;  ///< empty: none
  BvhConfig bvh;
  std::vector<std::string> skip;  ///< contestants to leave out
  RaceOptions race;
};

void run(const Options& options) {
  const Workload work = makeWorkload(options.triangles, options.rays, options.bvh);
  const auto wanted = [&](const char* name) {
    return std::find(options.skip.begin(), options.skip.end(), name) == options.skip.end();
  };
  std::vector<Contestant> contestants;
  if (wanted("cpu")) contestants.push_back(cpuContestant(work));
  if (wanted("opencl") && !listOpenClDevices().empty()) {
    contestants.push_back(openClContestant(work, options.device));
  }
  if (!options.vulkan.empty()) contestants.push_back(vulkanContestant(work, options.vulkan));
#ifdef SL_HAVE_EMBREE
  if (wanted("embree")) contestants.push_back(embreeContestant(work));
#endif
  if (contestants.empty()) throw Error("no contestant is left", kExitUsage);
  if (!options.race.json) {
    fmt::print(
        "city of {} triangles, {} random and {} border rays; median of {} runs in turns\n"
        "device   rays      Mrays/s  to Embree spread % equal hits %      ties     other\n",
        work.scene.triangles.size(), work.random.size(), work.border.size(), options.race.runs);
  }
  race(options.race, contestants, false, work.random.size());
  race(options.race, contestants, true, work.border.size());
}

}  // namespace
}  // namespace sightline

int main(int argc, char** argv) {
  using sightline::between;
  sightline::Options options;
  CLI::App app("Speed of tracing on a generated city, next to Embree's", "bench_trace");
  app.add_option("--triangles", options.triangles)->check(between(1000, 20e6))->capture_default_str();
  app.add_option("--rays", options.rays, "random rays of each cell")
      ->check(between(1, 1u << 30))
      ->capture_default_str();
  app.add_option("--runs", options.race.runs)->check(between(1, 1e6))->capture_default_str();
  app.add_option("--device", options.device, "of OpenCL")->capture_default_str();
  app.add_option("--vulkan", options.vulkan, "also this device: vulkan[:...]");
  app.add_option("--leaf", options.bvh.max_leaf_size, "triangles of a leaf at most")->check(between(1, 8));
  app.add_option("--skip", options.skip, "contestants to leave out")
      ->delimiter(',')
      ->check(CLI::IsMember({"cpu", "opencl", "embree"}));
  app.add_flag("--spatial", options.bvh.spatial_splits, "a tree with spatial splits");
  app.add_flag("--processor-time", options.race.processor_time, "of all threads, by the number of cores");
  app.add_flag("--json", options.race.json, "a line of JSON for each kind of ray and contestant");
  return sightline::benchMain(app, argc, argv, [&] { sightline::run(options); });
}
