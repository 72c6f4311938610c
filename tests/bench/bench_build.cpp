// How long the tree takes to build, next to Embree's medium-quality build of the same triangles in the same
// run, taken in turns, and what the tree is like.
//
//   bench_build [--triangles N] [--runs N] [--threads N] [--scene city|canyon|plant|bistro|soup]
//   [--plain|--spatial] [--processor-time]
//
// --processor-time counts the seconds that all threads computed instead of those that passed: for a machine
// with other work to do.
#include <fmt/core.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <ctime>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "bvh/bvh.h"
#include "core/cli/number_checks.h"
#include "core/generate/generate.h"
#include "tests/bench/bench_main.h"
#ifdef SL_HAVE_EMBREE
#include <embree3/rtcore.h>
#endif

namespace sightline {
namespace {

struct Options {
  uint32_t triangles = 2'000'000;
  int runs = 5;
  int threads = 0;
  bool plain = true;
  bool spatial = true;
  bool processor_time = false;
  std::string scene = "city";
};

/// Small triangles anywhere, nothing shared: three positions a triangle.
Scene makeSoup(uint32_t triangles) {
  Scene mesh;
  mesh.positions.reserve(size_t{3} * triangles);
  mesh.triangles.reserve(triangles);
  std::mt19937 random(1);
  const auto uniform = [&] { return static_cast<float>(random() >> 8) * 0x1p-24f; };
  const auto point = [&] { return glm::vec3(uniform(), uniform(), uniform()); };
  for (uint32_t i = 0; i < triangles; ++i) {
    const glm::vec3 p = point();
    mesh.positions.push_back(p);
    mesh.positions.push_back(p + 0.01f * point());
    mesh.positions.push_back(p + 0.01f * point());
    mesh.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
  }
  return mesh;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

double secondsNow(const Options& options) {
  if (options.processor_time) return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

#ifdef SL_HAVE_EMBREE
/// Seconds that Embree takes to commit a scene with the triangles, ready in its own buffers.
double embreeSeconds(const Scene& mesh, RTCDevice device, const Options& options) {
  RTCScene scene = rtcNewScene(device);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_MEDIUM);
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  void* v = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(glm::vec3),
                                    mesh.positions.size());
  std::memcpy(v, mesh.positions.data(), mesh.positions.size() * sizeof(glm::vec3));
  void* t = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(glm::uvec3),
                                    mesh.triangles.size());
  std::memcpy(t, mesh.triangles.data(), mesh.triangles.size() * sizeof(glm::uvec3));
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  const double start = secondsNow(options);
  rtcCommitScene(scene);
  const double seconds = secondsNow(options) - start;
  rtcReleaseScene(scene);
  return seconds;
}
#endif

/// Most memory that this process has used so far, in MiB.
double peakMemory() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind("VmHWM:", 0) == 0) return std::strtod(line.c_str() + 6, nullptr) / 1024;
  }
  return 0;
}

struct Row {
  std::string name;
  std::vector<double> seconds;
  Bvh bvh;
};

void print(const Row& row, double embree, size_t triangles) {
  const Bvh& b = row.bvh;
  const double n = static_cast<double>(triangles);
  const double n2 = static_cast<double>(b.nodes2.size()) * sizeof(BvhNode2) / n;
  const double n8 = static_cast<double>(b.nodes8.size()) * sizeof(BvhNode8) / n;
  const double references = static_cast<double>(b.references.size()) / n;
  const auto [low, high] = std::minmax_element(row.seconds.begin(), row.seconds.end());
  fmt::print(
      "{:<16} {:>8.3f} {:>6.3f}..{:<6.3f} {:>6.2f} {:>8.2f} {:>6} {:>6.2f} {:>7.1f} {:>7.1f} {:>7.1f}\n",
      row.name, median(row.seconds), *low, *high, embree > 0 ? median(row.seconds) / embree : 0.0, b.sah_cost,
      b.depth, references, n2, n8, n2 + n8 + 44 * references);
}

void run(const Options& options) {
  const Scene mesh = options.scene == "soup" ? makeSoup(options.triangles)
                                             : generateScene(options.scene, options.triangles, 1);
  const double scene_memory = peakMemory();
  const int threads = options.threads ? options.threads : tbb::info::default_concurrency();
  tbb::global_control control(tbb::global_control::max_allowed_parallelism, static_cast<size_t>(threads));
  std::vector<Row> rows;
  if (options.plain) rows.push_back({"plain", {}, {}});
  if (options.spatial) rows.push_back({"spatial splits", {}, {}});
  std::vector<double> embree;
#ifdef SL_HAVE_EMBREE
  RTCDevice device = rtcNewDevice(fmt::format("threads={}", threads).c_str());
#endif
  for (int i = 0; i < options.runs + 1; ++i) {  // the first run warms up
    for (Row& row : rows) {
      BvhConfig config;
      config.threads = threads;
      config.spatial_splits = row.name != "plain";
      row.bvh = {};
      const double start = secondsNow(options);
      row.bvh = buildBvh(mesh.positions, mesh.triangles, config);
      if (i > 0 || options.runs == 0) row.seconds.push_back(secondsNow(options) - start);
    }
#ifdef SL_HAVE_EMBREE
    if (i > 0) embree.push_back(embreeSeconds(mesh, device, options));
#endif
  }
#ifdef SL_HAVE_EMBREE
  rtcReleaseDevice(device);
#endif
  const double peer = embree.empty() ? 0 : median(embree);
  fmt::print(
      "{} of {} triangles, {} threads, median of {}; bytes a triangle; scene {:.0f} MiB, peak {:.0f} MiB\n",
      options.scene, mesh.triangles.size(), threads, options.runs, scene_memory, peakMemory());
  fmt::print("{:<16} {:>8} {:>14} {:>6} {:>8} {:>6} {:>6} {:>7} {:>7} {:>7}\n", "build", "seconds", "spread",
             "ratio", "SAH", "depth", "refs", "nodes2", "nodes8", "in all");
  if (peer > 0) fmt::print("{:<16} {:>8.3f}\n", "Embree medium", peer);
  for (const Row& row : rows) {
    print(row, peer, mesh.triangles.size());
    const std::string error = validate(row.bvh, mesh.positions, mesh.triangles);
    if (!error.empty()) fmt::print("NOT VALID: {}\n", error);
  }
}

}  // namespace
}  // namespace sightline

int main(int argc, char** argv) {
  using sightline::between;
  sightline::Options options;
  CLI::App app("How long the tree takes to build, next to Embree's", "bench_build");
  app.add_option("--triangles", options.triangles)->check(between(1, 20e6))->capture_default_str();
  app.add_option("--runs", options.runs)->check(between(1, 1e6))->capture_default_str();
  app.add_option("--threads", options.threads, "0: all cores")
      ->check(between(0, 4096))
      ->capture_default_str();
  app.add_option("--scene", options.scene)
      ->check(CLI::IsMember({"city", "canyon", "plant", "bistro", "soup"}))
      ->capture_default_str();
  app.add_flag_callback(
      "--plain", [&] { options.spatial = false; }, "not the tree with spatial splits");
  app.add_flag_callback(
      "--spatial", [&] { options.plain = false; }, "only the tree with spatial splits");
  app.add_flag("--processor-time", options.processor_time, "of all threads, instead of the time that passed");
  return sightline::benchMain(app, argc, argv, [&] { sightline::run(options); });
}
