// Where gvs++ spends its rays, and where it finds triangles: by stage, by the triangle's apparent size, and
// by its distance.
//
//   bench_waste SCENE CELLS.json [--device NAME] [--cell NAME] [--n-rand N] [--thesis]
//
// Bakes the cell, then traces the border rays of every triangle of the set once more: they tell how many
// reverse rays it caused. The apparent size is the solid angle seen from where the triangle was found, in
// pixels of a view of 1000 x 1000 with 90 degrees (at its centre: 4e-6 sr each).
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "core/cli/number_checks.h"
#include "core/device/registry/make_device.h"
#include "core/formats/cells_file.h"
#include "core/formats/load_scene.h"
#include "core/gvs/bake_cell.h"
#include "core/gvs/thesis_params.h"
#include "core/sampling/face_rays.h"
#include "core/sampling/make_stage_params.h"
#include "core/sampling/stage_rays.h"
#include "core/scene/scene.h"
#include "tests/bench/bench_main.h"

namespace sightline {
namespace {

constexpr double kPixel = 4e-6;  ///< steradians
constexpr size_t kBins = 9;
constexpr size_t kChunkEntries = 20'000;

struct Options {
  std::string scene, cells, cell, device = "opencl";
  BakeParams params;
};

/// What the triangles of a bin cost and were worth.
struct Bin {
  uint64_t triangles = 0;
  std::array<uint64_t, 4> found{};  ///< of them, by the stage that found them
  uint64_t border_rays = 0, reverse_rays = 0;
  uint64_t discontinuities = 0, runs = 0;  ///< the latter: those of one edge with the same occluder once
};

/// Solid angle of a triangle (Van Oosterom and Strackee 1983).
double solidAngle(const Scene& scene, uint32_t triangle, const glm::dvec3& eye) {
  glm::dvec3 corner[3];
  for (int i = 0; i < 3; ++i) corner[i] = glm::normalize(glm::dvec3(scene.corners(triangle)[size_t(i)]) - eye);
  const double volume = glm::dot(corner[0], glm::cross(corner[1], corner[2]));
  const double sum =
      1 + glm::dot(corner[0], corner[1]) + glm::dot(corner[1], corner[2]) + glm::dot(corner[2], corner[0]);
  return std::abs(2 * std::atan2(volume, sum));
}

double distanceTo(const Scene& scene, uint32_t triangle, const glm::dvec3& eye) {
  glm::dvec3 sum(0);
  for (int i = 0; i < 3; ++i) sum += glm::dvec3(scene.corners(triangle)[size_t(i)]);
  return glm::length(sum / 3.0 - eye);
}

/// Bin 0: below 0.001 pixels, then a bin a factor of ten.
size_t sizeBin(double pixels) {
  return size_t(std::clamp(std::floor(std::log10(std::max(pixels, 1e-30))) + 4, 0.0, double(kBins - 1)));
}

/// Bins of a factor of two, the last from a quarter of `reach` on.
size_t distanceBin(double distance, double reach) {
  const double halvings = std::floor(std::log2(std::max(distance / reach, 1e-30)) + double(kBins) + 1);
  return size_t(std::clamp(halvings, 0.0, double(kBins - 1)));
}

struct Waste {
  std::array<Bin, kBins> by_size, by_distance;
  Bin all;
};

void add(Waste& waste, size_t size, size_t distance, auto&& change) {
  change(waste.by_size[size]);
  change(waste.by_distance[distance]);
  change(waste.all);
}

/// Traces the border rays of the entries first .. and books them.
void addEntries(Tracer& tracer, const Scene& scene, std::span<const PvsEntry> entries,
                const StageParams& params, double reach, Waste& waste) {
  const std::vector<uint64_t> starts = borderStarts(scene, entries, params);
  BorderRays border(scene, entries, starts, params);
  std::vector<Ray> rays(starts.back());
  for (uint32_t i = 0; i < rays.size(); ++i) rays[i] = border(i);
  std::vector<Hit> hits(rays.size());
  tracer.traceRays(rays, hits);
  for (size_t e = 0; e < entries.size(); ++e) {
    const uint32_t triangle = entries[e].origin_triangle.w;
    const uint32_t samples = borderSamplesOf(scene, entries[e], params);
    const glm::dvec3 eye(entryOrigin(entries[e]));
    uint64_t discontinuities = 0, kept = 0, runs = 0;
    for (uint64_t i = starts[e]; i < starts[e + 1]; ++i) {
      if (!isDiscontinuity(rays[i], hits[i], params)) continue;
      const uint32_t place = borderPlace(uint32_t(i - starts[e]), samples);
      const bool follows = place > 0 && isDiscontinuity(rays[i - 1], hits[i - 1], params) &&
                           hits[i - 1].triangle == hits[i].triangle;
      ++discontinuities;
      kept += keepsDiscontinuity(place, follows, params) ? 1 : 0;
      runs += follows ? 0 : 1;
    }
    add(waste, sizeBin(solidAngle(scene, triangle, eye) / kPixel),
        distanceBin(distanceTo(scene, triangle, eye), reach), [&](Bin& bin) {
          ++bin.triangles;
          ++bin.found[entries[e].direction_stage.w];
          bin.border_rays += starts[e + 1] - starts[e];
          bin.reverse_rays += kept * reverseRayCount(params);
          bin.discontinuities += discontinuities;
          bin.runs += runs;
        });
  }
}

std::string row(const std::string& name, const Bin& bin, const Bin& all) {
  const double rays = double(bin.border_rays + bin.reverse_rays),
               total = double(all.border_rays + all.reverse_rays);
  return fmt::format("| {} | {} | {:.1f} % | {} | {} | {} | {:.1f} % | {:.1f} |\n", name, bin.triangles,
                     100 * double(bin.triangles) / double(all.triangles), bin.found[0], bin.found[1],
                     bin.found[2], 100 * rays / total,
                     bin.runs == 0 ? 0.0 : double(bin.discontinuities) / double(bin.runs));
}

void print(const ViewCell& cell, const CellPvs& pvs, const Waste& waste, double reach) {
  const CellStats& s = pvs.stats;
  fmt::print("\n{}: {} triangles\n", cell.name, pvs.triangles.size());
  for (const auto& [name, stage] :
       {std::pair("random", s.random), {"border", s.border}, {"reverse", s.reverse}}) {
    fmt::print("  {:<8} {:8.1f} million rays, {} new triangles, {:.0f} rays each\n", name,
               double(stage.rays) * 1e-6, stage.new_triangles,
               stage.new_triangles == 0 ? 0.0 : double(stage.rays) / double(stage.new_triangles));
  }
  const char* head =
      "triangles | of the set | by random | by border | by reverse | of the border and reverse rays | "
      "discontinuities a run |\n| --- | --- | --- | --- | --- | --- | --- | --- |\n";
  fmt::print("| pixels | {}", head);
  for (size_t b = 0; b < kBins; ++b) {
    const double low = std::pow(10.0, double(b) - 4);
    const std::string name = b == 0 ? "below 0.001" : fmt::format("{:g} to {:g}", low, low * 10);
    if (waste.by_size[b].triangles > 0) fmt::print("{}", row(name, waste.by_size[b], waste.all));
  }
  fmt::print("| distance | {}", head);
  for (size_t b = 0; b < kBins; ++b) {
    const double low = reach * std::exp2(double(b) - double(kBins) - 1);
    const std::string name = fmt::format("{:.3g} to {:.3g}", b == 0 ? 0 : low, low * 2);
    if (waste.by_distance[b].triangles > 0) fmt::print("{}", row(name, waste.by_distance[b], waste.all));
  }
  fmt::print("{}", row("all", waste.all, waste.all));
}

void bench(const Options& options) {
  const Scene scene = loadScene(options.scene);
  const std::vector<ViewCell> cells = loadCells(options.cells);
  const Bvh bvh = buildBvh(scene.positions, scene.triangles);
  const auto device = makeDevice(options.device, scene, bvh);
  const Bounds bounds = sceneBounds(scene);
  const double reach = glm::length(glm::dvec3(bounds.high - bounds.low));
  for (uint32_t c = 0; c < cells.size(); ++c) {
    if (!options.cell.empty() && cells[c].name != options.cell) continue;
    const CellPvs pvs = bakeCell(*device, scene, cells[c], c, options.params);
    std::vector<PvsEntry> entries = device->readPvs();
    std::erase_if(entries, [](const PvsEntry& entry) { return entry.direction_stage.w == kStageContained; });
    const StageParams params = makeStageParams(options.params, cellFaces(cells[c]), uvec4(0));
    Waste waste;
    for (size_t first = 0; first < entries.size(); first += kChunkEntries) {
      const size_t count = std::min(kChunkEntries, entries.size() - first);
      addEntries(*device, scene, std::span(entries).subspan(first, count), params, reach, waste);
    }
    print(cells[c], pvs, waste, reach);
  }
}

}  // namespace
}  // namespace sightline

int main(int argc, char** argv) {
  sightline::Options options;
  CLI::App app("Where gvs++ spends its rays, and where it finds triangles", "bench_waste");
  app.add_option("SCENE", options.scene)->required();
  app.add_option("CELLS", options.cells, "view cells, JSON")->required();
  app.add_option("--device", options.device)->capture_default_str();
  app.add_option("--cell", options.cell, "only the cell of this name");
  // Before the options that win over it: CLI11 takes them in the order of declaration.
  app.add_flag_callback(
      "--thesis", [&] { sightline::setThesisParams(options.params); }, "as of sightline bake");
  app.add_option("--n-rand", options.params.n_rand, "random rays an iteration")
      ->check(sightline::between(1, 4294967293.0))
      ->capture_default_str();
  return sightline::benchMain(app, argc, argv, [&] { sightline::bench(options); });
}
