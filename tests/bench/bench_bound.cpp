// What is proved hidden from view cells, and how long that takes, beside a bake of the same cells.
#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <ctime>
#include <string>

#include "core/base/splitmix.h"
#include "core/bound/bound_cell.h"
#include "core/cell/cell_frame.h"
#include "core/formats/cells_file.h"
#include "core/formats/load_scene.h"
#include "core/pvs/pvs_file.h"
#include "tests/bench/bench_main.h"

namespace sightline {
namespace {

/// A number 0 .. 1.
double unit(uint64_t& state) {
  return double(mixBits(state += kSplitmixStep) >> 11) * 0x1p-53;
}

/// Whether a segment enters no opaque voxel, up to corners of voxels.
bool isFree(const glm::dvec3& from, const glm::dvec3& to, BlockedView& view) {
  const glm::dvec3 way = to - from;
  const double nudge = 0x1p-16 / std::max({std::abs(way.x), std::abs(way.y), std::abs(way.z), 1.0});
  bool is_free = true;
  view.visitAlong(from, way, nudge, [&](double, bool blocked) { return is_free = !blocked; });
  return is_free;
}

/// How many of the triangles some of so many segments from the cell meet without an opaque voxel on the way:
/// no bound by these voxels leaves them out.
uint32_t reachable(const BoundScene& scene, const ViewCell& cell, const std::vector<uint32_t>& triangles,
                   int segments) {
  const BlockedSpace inner = innerVoxels(scene, cell);
  const CellFrame frame = cellFrame(cell);
  std::atomic<uint32_t> count{0};
  tbb::parallel_for(tbb::blocked_range<size_t>(0, triangles.size(), 256), [&](const auto& range) {
    BlockedView view(inner);
    for (size_t i = range.begin(); i < range.end(); ++i) {
      const auto corners = scene.scene.corners(triangles[i]);
      uint64_t state = mixBits(triangles[i]);
      for (int k = 0; k < segments; ++k) {
        glm::dvec3 local;
        for (int axis = 0; axis < 3; ++axis) local[axis] = (2 * unit(state) - 1) * frame.half_size[axis];
        double u = unit(state), v = unit(state);
        if (u + v > 1) u = 1 - u, v = 1 - v;
        const glm::dvec3 a(corners[0]), b(corners[1]), c(corners[2]);
        const double scale = 1 / scene.all.lattice.voxelSize();
        if (!isFree(frame.toWorld(local) * scale, (a + (b - a) * u + (c - a) * v) * scale, view)) continue;
        ++count;
        break;
      }
    }
  });
  return count;
}

double processorSeconds() {
  return double(std::clock()) / CLOCKS_PER_SEC;
}

using Clock = std::chrono::steady_clock;

void run(const std::string& scene_file, const std::string& cells_file, const std::string& pvs_file,
         double voxel, const BoundOptions& options, int segments, const std::string& only) {
  const Scene scene = loadScene(scene_file);
  const PvsFile pvs = loadPvs(pvs_file);
  double begun = processorSeconds();
  const BoundScene voxels = makeBoundScene(scene, {.lattice = latticeOf(voxel)});
  fmt::print("{} voxels of {:g}: {:.2f} s of processor time\n", voxels.all.count(), voxel,
             processorSeconds() - begun);
  fmt::print(
      "| cell | seen | bound | hidden | of which proved | inner M | hidden M | outside the bound | seconds | "
      "processor | reachable |\n");
  for (const ViewCell& cell : loadCells(cells_file)) {
    const auto baked = std::find_if(pvs.cells.begin(), pvs.cells.end(),
                                    [&](const CellPvs& c) { return c.cell.name == cell.name; });
    if (baked == pvs.cells.end() || (!only.empty() && only != cell.name)) continue;
    begun = processorSeconds();
    const auto start = Clock::now();
    const CellBound bound = boundCell(voxels, cell, options);
    const double processor = processorSeconds() - begun,
                 seconds = std::chrono::duration<double>(Clock::now() - start).count();
    std::vector<uint32_t> leaks;
    std::set_difference(baked->triangles.begin(), baked->triangles.end(), bound.triangles.begin(),
                        bound.triangles.end(), std::back_inserter(leaks));
    const double all = scene.triangleCount(), hidden = all - double(baked->triangles.size());
    fmt::print("| {} | {} | {} | {} | {:.1f} % | {:.2f} | {:.2f} | {} | {:.2f} | {:.2f} | {} |\n", cell.name,
               baked->triangles.size(), bound.triangles.size(), hidden,
               100 * (all - double(bound.triangles.size())) / hidden, double(bound.opaque_voxels) * 1e-6,
               double(bound.hidden_voxels) * 1e-6, leaks.size(), seconds, processor,
               reachable(voxels, cell, bound.triangles, segments));
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace sightline

int main(int argc, char** argv) {
  std::string scene, cells, pvs, only;
  double voxel = 0.5;
  int segments = 256;
  sightline::BoundOptions options;
  CLI::App app("What is proved hidden from view cells, beside a bake of them", "bench_bound");
  app.add_option("scene", scene)->required();
  app.add_option("cells", cells)->required();
  app.add_option("--pvs", pvs, "a bake of the cells")->required();
  app.add_option("--voxel", voxel)->capture_default_str();
  app.add_option("--free-side", options.free_side)->capture_default_str();
  app.add_option("--surface-side", options.surface_side)->capture_default_str();
  app.add_option("--part-size", options.part_size)->capture_default_str();
  app.add_option("--triangle-part-size", options.triangle_part_size)->capture_default_str();
  app.add_option("--segments", segments, "to each triangle of the bound: 0, none")->capture_default_str();
  app.add_option("--cell", only);
  return sightline::benchMain(app, argc, argv,
                              [&] { sightline::run(scene, cells, pvs, voxel, options, segments, only); });
}
