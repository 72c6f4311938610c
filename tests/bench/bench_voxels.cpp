// How long exact voxels take on one thread, next to the plain loop that engines have: for each triangle, the
// separating axes of Schwarz and Seidel 2010 in floats, precomputed, asked of every voxel of its box, bits
// set in a dense grid; and next to OpenVDB's meshToVolume where libopenvdb-dev is installed.
//
//   bench_voxels SCENE [--along N ...] [--runs N] [--openvdb]
//
// CPU seconds, since other load on the machine must not count; contestants in turns, medians of the runs, the
// first of all warms up and does not count. Compares the sets: the plain loop's rounding loses and adds
// voxels.
#include <fmt/core.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <ctime>
#include <string>
#include <vector>

#include "core/formats/load_scene.h"
#include "core/voxel/pyramid.h"
#include "core/voxel/voxelize.h"
#include "tests/bench/bench_main.h"

#ifdef SL_HAVE_OPENVDB
#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>
#endif

namespace sightline {
namespace {

struct Options {
  std::string scene;
  std::vector<uint64_t> along{256, 512};
  int runs = 5;
  bool openvdb = false;
};

double cpuSeconds() {
  timespec time{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
}

template <typename Work>
double timeOf(Work&& work) {
  const double start = cpuSeconds();
  work();
  return cpuSeconds() - start;
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

// Bits of all voxels of a box, rows of whole words.
struct DenseGrid {
  glm::ivec3 low, size;
  size_t words_a_row;
  std::vector<uint64_t> words;

  explicit DenseGrid(const VoxelBox& box)
      : low(box.low), size(box.high - box.low + 1), words_a_row(size_t(size.x + 63) / 64) {
    words.assign(words_a_row * size_t(size.y) * size_t(size.z), 0);
  }
  uint64_t& word(int x, int y, int z) {
    return words[(size_t(z) * size_t(size.y) + size_t(y)) * words_a_row + size_t(x) / 64];
  }
  bool contains(const glm::ivec3& voxel) {
    const glm::ivec3 at = voxel - low;
    return ((word(at.x, at.y, at.z) >> (at.x & 63)) & 1) != 0;
  }
  uint64_t count() const {
    uint64_t sum = 0;
    for (const uint64_t word : words) sum += uint64_t(std::popcount(word));
    return sum;
  }
};

// Schwarz and Seidel 2010, section 3.1: plane and edge functions with the critical corners folded in.
void plainLoop(const Scene& scene, float voxels_a_unit, DenseGrid& grid) {
  const glm::vec3 origin(grid.low);
  for (uint32_t id = 0; id < scene.triangleCount(); ++id) {
    const auto corners = scene.corners(id);
    const glm::vec3 v[3] = {corners[0] * voxels_a_unit - origin, corners[1] * voxels_a_unit - origin,
                            corners[2] * voxels_a_unit - origin};
    const glm::vec3 e[3] = {v[1] - v[0], v[2] - v[1], v[0] - v[2]};
    const glm::vec3 n = glm::cross(e[0], e[1]);
    // With the voxels on both sides of what lies on the lattice, as the exact set has them.
    const glm::vec3 least = glm::min(v[0], glm::min(v[1], v[2])), most = glm::max(v[0], glm::max(v[1], v[2]));
    const glm::ivec3 low = glm::max(glm::ivec3(glm::ceil(least)) - 1, glm::ivec3(0));
    const glm::ivec3 high = glm::min(glm::ivec3(glm::floor(most)), grid.size - 1);
    const glm::vec3 corner(n.x > 0 ? 1.f : 0.f, n.y > 0 ? 1.f : 0.f, n.z > 0 ? 1.f : 0.f);
    const float d1 = glm::dot(n, corner - v[0]), d2 = glm::dot(n, (1.f - corner) - v[0]);
    glm::vec2 xy[3], yz[3], zx[3];
    float dxy[3], dyz[3], dzx[3];
    for (int i = 0; i < 3; ++i) {
      const float sz = n.z >= 0 ? 1.f : -1.f, sx = n.x >= 0 ? 1.f : -1.f, sy = n.y >= 0 ? 1.f : -1.f;
      xy[i] = glm::vec2(-e[i].y, e[i].x) * sz;
      yz[i] = glm::vec2(-e[i].z, e[i].y) * sx;
      zx[i] = glm::vec2(-e[i].x, e[i].z) * sy;
      dxy[i] = -glm::dot(xy[i], glm::vec2(v[i].x, v[i].y)) + std::max(0.f, xy[i].x) + std::max(0.f, xy[i].y);
      dyz[i] = -glm::dot(yz[i], glm::vec2(v[i].y, v[i].z)) + std::max(0.f, yz[i].x) + std::max(0.f, yz[i].y);
      dzx[i] = -glm::dot(zx[i], glm::vec2(v[i].z, v[i].x)) + std::max(0.f, zx[i].x) + std::max(0.f, zx[i].y);
    }
    for (int z = low.z; z <= high.z; ++z) {
      for (int y = low.y; y <= high.y; ++y) {
        for (int x = low.x; x <= high.x; ++x) {
          const glm::vec3 p(x, y, z);
          const float np = glm::dot(n, p);
          if ((np + d1) * (np + d2) > 0) continue;
          bool in = true;
          for (int i = 0; i < 3; ++i) {
            in = in && glm::dot(xy[i], glm::vec2(p.x, p.y)) + dxy[i] >= 0 &&
                 glm::dot(yz[i], glm::vec2(p.y, p.z)) + dyz[i] >= 0 &&
                 glm::dot(zx[i], glm::vec2(p.z, p.x)) + dzx[i] >= 0;
          }
          if (in) grid.word(x, y, z) |= uint64_t(1) << (x & 63);
        }
      }
    }
  }
}

#ifdef SL_HAVE_OPENVDB
uint64_t openVdb(const Scene& scene, double voxel) {
  const auto transform = openvdb::math::Transform::createLinearTransform(voxel);
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  points.reserve(scene.positions.size());
  for (uint32_t id = 0; id < scene.triangleCount(); ++id) {
    for (const glm::vec3& p : scene.corners(id)) {
      points.push_back(openvdb::Vec3s(transform->worldToIndex(openvdb::Vec3d(p.x, p.y, p.z))));
    }
    triangles.emplace_back(3 * id, 3 * id + 1, 3 * id + 2);
  }
  const openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec3I> mesh(points, triangles);
  const auto grid = openvdb::tools::meshToVolume<openvdb::FloatGrid>(mesh, *transform, 0.87f, 0.87f,
                                                                     openvdb::tools::UNSIGNED_DISTANCE_FIELD);
  return grid->activeVoxelCount();
}
#endif

// Voxels of the exact set that the plain loop lacks, and those that it has too many.
void sayDifference(const VoxelGrid& exact, DenseGrid& plain) {
  uint64_t lost = 0, count = 0;
  for (const VoxelBlock& block : exact.blocks) {
    for (const VoxelBrick& brick : block.bricks) {
      const glm::ivec3 low = block.place * kBlockSide +
                             8 * glm::ivec3(brick.place & 7, (brick.place >> 3) & 7, brick.place >> 6);
      for (int i = 0; i < 512; ++i) {
        const glm::ivec3 at(i & 7, (i >> 3) & 7, i >> 6);
        if (!brick.contains(at.x, at.y, at.z)) continue;
        ++count;
        lost += !plain.contains(low + at);
      }
    }
  }
  fmt::print(
      "  the plain loop lacks {} of {} voxels that triangles meet or touch, and has {} that none does\n",
      lost, count, plain.count() - (count - lost));
}

void race(const Scene& scene, uint64_t along, const Options& options) {
  const Lattice lattice = latticeFor(sceneBounds(scene), along);
  const VoxelizeOptions with_ids{.lattice = lattice};
  VoxelGrid exact = voxelize(scene, with_ids);
  const VoxelBox box = boxOf(exact);
  std::vector<double> ours, plain, coarser_levels, vdb;
  DenseGrid grid(box);
  uint64_t vdb_voxels = 0;
  for (int run = 0; run <= options.runs; ++run) {
    const double t_ours = timeOf([&] { exact = voxelize(scene, with_ids); });
    std::ranges::fill(grid.words, 0);
    const double t_plain = timeOf([&] { plainLoop(scene, float(1 / lattice.voxelSize()), grid); });
    VoxelGrid copy = exact;
    const double t_levels = timeOf([&] { pyramidOf(std::move(copy)); });
    double t_vdb = 0;
#ifdef SL_HAVE_OPENVDB
    if (options.openvdb) t_vdb = timeOf([&] { vdb_voxels = openVdb(scene, lattice.voxelSize()); });
#endif
    if (run == 0) continue;
    ours.push_back(t_ours);
    plain.push_back(t_plain);
    coarser_levels.push_back(t_levels);
    vdb.push_back(t_vdb);
  }
  const double ours_s = median(ours), plain_s = median(plain), levels_s = median(coarser_levels);
  fmt::print("{} along ({:g}): {} voxels, {} blocks\n", along, lattice.voxelSize(), exact.count(),
             exact.blocks.size());
  fmt::print(
      "  exact {:.1f} ms ({:.1f} M voxels/s), plain loop {:.1f} ms: {:.2f} times its speed; coarser levels "
      "{:.1f} ms "
      "({:.0f} %)\n",
      1e3 * ours_s, double(exact.count()) / ours_s * 1e-6, 1e3 * plain_s, plain_s / ours_s, 1e3 * levels_s,
      100 * levels_s / ours_s);
  if (vdb_voxels != 0) {
    fmt::print("  OpenVDB {:.1f} ms: exact has {:.0f} times its speed\n", 1e3 * median(vdb),
               median(vdb) / ours_s);
  }
  sayDifference(exact, grid);
}

void run(const Options& options) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const Scene scene = loadScene(options.scene, {});
  fmt::print("{}: {} triangles; one thread, CPU time\n", options.scene, scene.triangleCount());
  for (const uint64_t along : options.along) race(scene, along, options);
}

}  // namespace
}  // namespace sightline

int main(int argc, char** argv) {
  sightline::Options options;
  CLI::App app("Exact voxels next to a plain loop");
  app.add_option("SCENE", options.scene)->required();
  app.add_option("--along", options.along, "Voxels along the longest side");
  app.add_option("--runs", options.runs)->capture_default_str();
  app.add_flag("--openvdb", options.openvdb, "Time OpenVDB too, where it is installed");
  return sightline::benchMain(app, argc, argv, [&] { sightline::run(options); });
}
