// What hairline gaps of a room cost, and what --smallest-hole makes of them: sets, times and leaks by the
// width of the gaps, with the same bake repeated.
#include <fmt/core.h>

#include <algorithm>
#include <string>

#include "core/device/naive/naive_device.h"
#include "core/device/registry/make_device.h"
#include "core/gvs/bake_cell.h"
#include "core/gvs/find_leaks.h"
#include "tests/bench/bench_main.h"
#include "tests/support/leaky_room.h"
#include "tests/support/make_cell.h"

namespace sightline {
namespace {

CellPvs bakeRoom(Device& device, const Scene& scene, float hole, uint32_t n_rand) {
  BakeParams params;
  params.n_rand = n_rand;
  params.validation_rays = 0;
  params.smallest_hole = hole;
  return bakeCell(device, scene, testing_support::makeCell({0, 1.5, 0}, {0.5, 0.5, 0.5}), 0, params);
}

void run(const std::string& driver, uint32_t n_rand, float hole) {
  fmt::print("| gap | triangles | seconds | leaks | their search | with {:g} | seconds |\n", hole);
  fmt::print("| --- | --- | --- | --- | --- | --- | --- |\n");
  for (const float gap : {0.0f, 1e-6f, 1e-5f, 1e-4f, 1e-3f, 1e-2f}) {
    const testing_support::LeakyRoom room(gap);
    const Bvh bvh = buildBvh(room.scene.positions, room.scene.triangles);
    const auto device = makeDevice(driver, room.scene, bvh);
    const auto closing = makeNaiveDevice(makeDevice(driver, room.scene, bvh), room.scene, hole);
    const CellPvs exact = bakeRoom(*device, room.scene, 0, n_rand);
    const Leaks leaks = findLeaks(*device, room.scene, exact, leakWidth(exact.cell));
    const CellPvs closed = bakeRoom(*closing, room.scene, hole, n_rand);
    fmt::print("| {:g} m | {} | {:.2f} | {} | {:.2f} | {} | {:.2f} |\n", gap, exact.triangles.size(),
               exact.stats.seconds, leaks.triangles, leaks.seconds, closed.triangles.size(),
               closed.stats.seconds);
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace sightline

int main(int argc, char** argv) {
  std::string device = "cpu";
  uint32_t n_rand = 1'000'000;
  float hole = 0.002f;
  CLI::App app("What hairline gaps cost, and what closing them does", "bench_gaps");
  app.add_option("--device", device)->capture_default_str();
  app.add_option("--n-rand", n_rand, "random rays an iteration")->capture_default_str();
  app.add_option("--smallest-hole", hole, "metres")->capture_default_str();
  return sightline::benchMain(app, argc, argv, [&] { sightline::run(device, n_rand, hole); });
}
