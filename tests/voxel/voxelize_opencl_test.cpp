#include "core/voxel/opencl/voxelize_opencl.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "core/generate/generate.h"
#include "tests/support/instanced_scene.h"

namespace sightline {
namespace {

struct DeviceGrid {
  std::vector<VoxelBlock> blocks;
  OpenClVoxelized done;
};

DeviceGrid onDevice(const Scene& scene, const VoxelizeOptions& options, const OpenClVoxelizing& tuning = {}) {
  DeviceGrid grid;
  grid.done = voxelizeOpenCl(
      scene, options, "opencl", [&](VoxelBlock&& block) { grid.blocks.push_back(std::move(block)); }, tuning);
  return grid;
}

// Of some kinds, each of which breaks floats in its own way.
Scene hardScene(int kind, int triangles) {
  std::mt19937_64 random(uint64_t(kind) + 31);
  const auto number = [&](double low, double high) {
    return float(low + (high - low) * double(random() >> 11) * 0x1p-53);
  };
  const auto whole = [&](int low, int high) { return float(low + int(random() % uint64_t(high - low + 1))); };
  Scene scene;
  for (int i = 0; i < triangles; ++i) {
    std::array<glm::vec3, 3> t;
    const float reach = i % 25 == 0 ? 100 : 5;
    glm::vec3 middle(0);
    for (int axis = 0; axis < 3; ++axis) middle[axis] = whole(-60, 60);
    for (glm::vec3& p : t) {
      for (int axis = 0; axis < 3; ++axis) {
        const float step = number(-reach, reach), speck = whole(-1, 1);
        switch (kind) {
          case 0:  // anywhere
            p[axis] = middle[axis] + step;
            break;
          case 1:  // in planes of the lattice, with corners on its corners
            p[axis] = axis == i % 3 ? middle[axis] : middle[axis] + std::round(step);
            break;
          case 2:  // on corners and middles
            p[axis] = middle[axis] + std::round(2 * step) / 2;
            break;
          case 3:  // a floor's noise
            p[axis] = axis == 1 ? speck * 1e-17f : middle[axis] + step;
            break;
          case 4:  // far from the origin
            p[axis] = (axis == 0 ? 4194304.f : axis == 1 ? -16777216.f : 33554432.f) + middle[axis] + step;
            break;
          case 5:  // next to corners
            p[axis] = middle[axis] + std::round(step) + speck * 0x1p-18f;
            break;
          default:  // specks, also below what floats hold
            p[axis] = std::ldexp(number(-1, 1), -10 - 15 * (i % 9)) + (i % 2 == 0 ? std::round(step) : 0);
            break;
        }
      }
    }
    if (i % 7 == 3) t[2] = t[0] + (t[1] - t[0]) * number(0, 1);  // a sliver
    if (i % 50 == 4) t[2] = t[0];                                // a segment
    if (i % 6 == 5) t[2] = {t[0].x, t[0].y + 3, t[0].z};         // a wall that stands upright
    for (const glm::vec3& p : t) scene.positions.push_back(p);
    const auto first = uint32_t(3 * i);
    scene.triangles.emplace_back(first, first + 1, first + 2);
  }
  scene.objects.push_back({"all", 0, uint32_t(triangles)});
  return scene;
}

constexpr Separation kAllSeparations[] = {Separation::kConservative, Separation::k26, Separation::k6};

// Right: the device's blocks are the processor's, byte for byte.
TEST(VoxelizeOpenCl, IsTheProcessorsByteForByte) {
  uint64_t open_of_doubles = 0, open_of_floats = 0, open_triangles = 0;
  for (int kind = 0; kind < 7; ++kind) {
    const Scene scene = hardScene(kind, 120);
    for (const Separation separation : kAllSeparations) {
      const VoxelizeOptions options{.lattice = latticeOf(1), .separation = separation};
      const std::vector<VoxelBlock> wanted = voxelize(scene, options).blocks;
      EXPECT_GT(wanted.size(), 5u);
      for (const bool floats : {false, true}) {
        const DeviceGrid found = onDevice(scene, options, {.floats = floats});
        EXPECT_TRUE(found.blocks == wanted)
            << "kind " << kind << ", separation " << int(separation) << ", floats " << floats;
        EXPECT_GT(found.done.pairs, 120u);
        const uint64_t open = found.done.open_rows + found.done.open_pairs;
        open_triangles += found.done.open_triangles;
        (floats ? open_of_floats : open_of_doubles) += open;
        // Doubles decide all of what has few bits, ties too.
        EXPECT_TRUE(kind > 2 || floats || open < 10) << "kind " << kind << ": " << open;
      }
    }
  }
  EXPECT_GT(open_triangles, 20u);
  EXPECT_GT(open_of_doubles, 100u);
  EXPECT_GT(open_of_floats, open_of_doubles);
}

TEST(VoxelizeOpenCl, DoesNotDependOnListsGroupsAndBatches) {
  const Scene scene = hardScene(6, 400);
  VoxelizeOptions options{.lattice = latticeOf(0.5), .attributes = {.normals = true, .objects = true}};
  const std::vector<VoxelBlock> wanted = voxelize(scene, options).blocks;
  const DeviceGrid short_lists = onDevice(scene, options, {.bricks = 1, .open_rows = 1});
  EXPECT_TRUE(short_lists.blocks == wanted);
  EXPECT_GT(short_lists.done.repeats, 0u);
  options.memory = 1;
  for (const uint32_t group : {1u, 8u, 256u}) {
    EXPECT_TRUE(onDevice(scene, options, {.blocks_a_time = 3, .group = group}).blocks == wanted) << group;
  }
}

TEST(VoxelizeOpenCl, KnowsGeneratedScenesAndInstances) {
  const Scene city = generateScene("city", 3000, 1);
  const Scene instances = testing_support::randomInstances(3, 20, 40);
  for (const Separation separation : kAllSeparations) {
    const VoxelizeOptions coarse{.lattice = latticeOf(1), .separation = separation};
    EXPECT_TRUE(onDevice(city, coarse).blocks == voxelize(city, coarse).blocks);
    const VoxelizeOptions fine{.lattice = latticeFor(sceneBounds(instances), 200), .separation = separation};
    EXPECT_TRUE(onDevice(instances, fine).blocks == voxelize(instances, fine).blocks);
  }
}

}  // namespace
}  // namespace sightline
