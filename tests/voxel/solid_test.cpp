#include "core/voxel/solid.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Side_of_triangle_mesh.h>
#include <CGAL/Surface_mesh.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <functional>
#include <map>
#include <random>

#include "core/base/error.h"
#include "core/base/interrupted.h"
#include "core/voxel/reach.h"
#include "core/voxel/voxelize.h"

namespace sightline {
namespace {

using SolidKernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using SolidMesh = CGAL::Surface_mesh<SolidKernel::Point_3>;

// Adds triangles to the scene's last object, or to a new one.
void addTriangles(Scene& scene, const std::vector<glm::vec3>& points,
                  const std::vector<glm::uvec3>& triangles, bool is_new_object) {
  const auto first = uint32_t(scene.positions.size()), id = uint32_t(scene.triangles.size());
  scene.positions.insert(scene.positions.end(), points.begin(), points.end());
  for (const glm::uvec3& t : triangles) scene.triangles.push_back(t + first);
  if (is_new_object || scene.objects.empty()) {
    scene.objects.push_back({fmt::format("part {}", scene.objects.size() + 1), id, 0});
  }
  scene.objects.back().triangle_count += uint32_t(triangles.size());
}

void addBox(Scene& scene, const glm::vec3& low, const glm::vec3& high, bool turned, bool is_new_object) {
  std::vector<glm::vec3> points;
  for (int i = 0; i < 8; ++i) {
    points.emplace_back((i & 1) != 0 ? high.x : low.x, (i & 2) != 0 ? high.y : low.y,
                        (i & 4) != 0 ? high.z : low.z);
  }
  std::vector<glm::uvec3> triangles{{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  if (turned) {
    for (glm::uvec3& t : triangles) std::swap(t.y, t.z);
  }
  addTriangles(scene, points, triangles, is_new_object);
}

// A sphere of 8 * 4^levels triangles with a rough surface, corners rounded to whole multiples of `step`.
void roughSphere(uint64_t seed, int levels, double radius, double step, std::vector<glm::vec3>& points,
                 std::vector<glm::uvec3>& triangles) {
  std::vector<glm::dvec3> directions{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> middles;
    const auto middle = [&](uint32_t a, uint32_t b) {
      const auto [at, is_new] = middles.try_emplace(std::minmax(a, b), uint32_t(directions.size()));
      if (is_new) directions.push_back(glm::normalize(directions[a] + directions[b]));
      return at->second;
    };
    std::vector<glm::uvec3> finer;
    for (const glm::uvec3& t : triangles) {
      const uint32_t x = middle(t.x, t.y), y = middle(t.y, t.z), z = middle(t.z, t.x);
      for (const glm::uvec3& part : {glm::uvec3(t.x, x, z), {x, t.y, y}, {z, y, t.z}, {x, y, z}}) {
        finer.push_back(part);
      }
    }
    triangles = finer;
  }
  std::mt19937_64 random(seed);
  points.clear();
  for (const glm::dvec3& direction : directions) {
    const double roughness = 0.75 + 0.25 * double(random() >> 11) * 0x1p-53;
    points.emplace_back(glm::round(direction * (radius * roughness / step)) * step);
  }
}

// Right: a voxel is inner if all of its corners are inside of the mesh and no triangle meets it.
TEST(Solid, IsWhatIsInsideOfAClosedMesh) {
  for (const double step :
       {0x1p-20, 0.5, 1.0}) {  // corners anywhere; on middles of voxels; on corners of them
    for (uint64_t seed = 1; seed <= 3; ++seed) {
      std::vector<glm::vec3> points;
      std::vector<glm::uvec3> triangles;
      roughSphere(seed, 2, 14, step, points, triangles);
      Scene scene;
      addTriangles(scene, points, triangles, true);
      SolidMesh mesh;
      for (const glm::vec3& p : points) mesh.add_vertex({double(p.x), double(p.y), double(p.z)});
      using Vertex = SolidMesh::Vertex_index;
      for (const glm::uvec3& t : triangles) mesh.add_face(Vertex(t.x), Vertex(t.y), Vertex(t.z));
      const CGAL::Side_of_triangle_mesh<SolidMesh, SolidKernel> side(mesh);
      const VoxelGrid grid = voxelize(scene, {.lattice = latticeOf(1)});
      const VoxelBox around = boxOf(grid);
      for (const InsideRule rule : {InsideRule::kParity, InsideRule::kWinding}) {
        const ClosedParts parts = closedParts(scene, rule);
        EXPECT_EQ(parts.closed, 1u);
        const VoxelSpace space = solidParts(scene, grid, parts, rule);
        uint64_t inner = 0;
        for (int i = 0; i < 40 * 40 * 40; ++i) {
          const glm::ivec3 voxel(i % 40 - 20, i / 40 % 40 - 20, i / 1600 - 20);
          const VoxelState state = space.state(voxel);
          if (state == VoxelState::kSurface || (state == VoxelState::kFree && !holds(around, voxel)))
            continue;
          inner += state == VoxelState::kInner;
          const CGAL::Bounded_side expected =
              state == VoxelState::kInner ? CGAL::ON_BOUNDED_SIDE : CGAL::ON_UNBOUNDED_SIDE;
          for (int corner = 0; corner < 8; ++corner) {
            const glm::ivec3 at = voxel + glm::ivec3(corner & 1, (corner >> 1) & 1, corner >> 2);
            ASSERT_EQ(side(SolidKernel::Point_3(at.x, at.y, at.z)), expected)
                << "seed " << seed << ", step " << step << ", " << at.x << ' ' << at.y << ' ' << at.z;
          }
        }
        EXPECT_GT(inner, 1000u);
        // What a closed mesh holds is not reached from outside either.
        const VoxelSpace reached = reach(grid, {.from_outside = true});
        for (int i = 0; i < 40 * 40 * 40; ++i) {
          const glm::ivec3 voxel(i % 40 - 20, i / 40 % 40 - 20, i / 1600 - 20);
          if (space.state(voxel) == VoxelState::kInner) {
            ASSERT_EQ(reached.state(voxel), VoxelState::kInner);
          }
        }
      }
    }
  }
}

struct SolidBox {
  glm::ivec3 low, high;  // in halves of a voxel
  bool turned;
  int object;
};

// Boxes over each other, in each other, some turned inside out, of one object or of several: in each object
// counted by the boxes that hold a voxel's middle.
TEST(Solid, CountsTheBoxesOfAnObject) {
  std::mt19937_64 random(17);
  for (int run = 0; run < 12; ++run) {
    Scene scene;
    std::vector<SolidBox> boxes;
    for (int i = 0; i < 6; ++i) {
      SolidBox box{};
      for (int axis = 0; axis < 3; ++axis) {
        box.low[axis] = int(random() % 160) - 100;
        box.high[axis] = box.low[axis] + 2 + int(random() % 120);
      }
      box.turned = random() % 3 == 0;
      const bool is_new_object = i == 0 || random() % 2 == 0;
      box.object = is_new_object ? int(scene.objects.size()) : boxes.back().object;
      addBox(scene, glm::vec3(box.low) * 0.125f, glm::vec3(box.high) * 0.125f, box.turned, is_new_object);
      boxes.push_back(box);
    }
    const VoxelGrid grid = voxelize(scene, {.lattice = latticeOf(0.25)});
    for (const InsideRule rule : {InsideRule::kParity, InsideRule::kWinding}) {
      const VoxelSpace space = solidParts(scene, grid, closedParts(scene, rule), rule);
      const VoxelBox around = boxOf(grid);
      uint64_t inner = 0;
      for (int z = around.low.z - 1; z <= around.high.z + 1; ++z) {
        for (int y = around.low.y - 1; y <= around.high.y + 1; ++y) {
          for (int x = around.low.x - 1; x <= around.high.x + 1; ++x) {
            const VoxelState state = space.state({x, y, z});
            if (state == VoxelState::kSurface) continue;
            std::map<int, int> counts;
            const glm::ivec3 middle = 2 * glm::ivec3(x, y, z) + 1;
            for (const SolidBox& box : boxes) {
              if (!holds({box.low, box.high}, middle)) continue;
              counts[box.object] += rule == InsideRule::kParity || !box.turned ? 1 : -1;
            }
            bool is_inside = false;
            for (const auto& [object, count] : counts) {
              is_inside = is_inside || (rule == InsideRule::kParity ? count % 2 != 0 : count != 0);
            }
            ASSERT_EQ(state == VoxelState::kInner, is_inside) << run << ": " << x << ' ' << y << ' ' << z;
            inner += is_inside;
          }
        }
      }
      EXPECT_EQ(space.counts().inner, inner);
      EXPECT_GT(inner, 0u);
    }
  }
}

TEST(Solid, IsTheSameOnAnyThreadsAndStops) {
  Scene scene;
  std::vector<glm::vec3> points;
  std::vector<glm::uvec3> triangles;
  roughSphere(4, 4, 100, 0x1p-20, points, triangles);
  addTriangles(scene, points, triangles, true);
  const VoxelGrid grid = voxelize(scene, {.lattice = latticeOf(1)});
  const ClosedParts parts = closedParts(scene, InsideRule::kParity);
  const VoxelSpace space = solidParts(scene, grid, parts, InsideRule::kParity);
  EXPECT_GT(space.counts().inner, 1000000u);
  EXPECT_EQ(space.innerInBlock(glm::ivec3(0)), Share::kSome);
  for (const size_t threads : {1, 2, 7}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const VoxelSpace again = solidParts(scene, grid, parts, InsideRule::kParity);
    for (int i = 0; i < 100000; ++i) {
      const glm::ivec3 voxel(i % 199 - 99, i / 199 % 199 - 99, i / (199 * 199) * 67 % 199 - 99);
      ASSERT_EQ(again.state(voxel), space.state(voxel));
    }
  }
  const std::atomic<bool> stop{true};
  EXPECT_THROW(solidParts(scene, grid, parts, InsideRule::kParity, {{}, &stop}), Interrupted);
}

// Right: the set is the surface and what is inner, of the box around the surface.
TEST(Solid, FillsTheGrid) {
  Scene scene;
  addBox(scene, glm::vec3(-70.5f, 3.5f, 3.5f), glm::vec3(80.5f, 90.5f, 20.5f), false, true);
  addBox(scene, glm::vec3(100), glm::vec3(120), false, true);
  const VoxelGrid grid = voxelize(scene, {.lattice = latticeOf(1)});
  const VoxelSpace outside = reach(grid, {.from_outside = true});
  const VoxelSpace inside = reach(grid, {.seeds = {glm::dvec3(10)}});  // outside is inner
  for (const VoxelSpace* space : {&outside, &inside}) {
    const VoxelGrid filled = filledGrid(*space);
    const VoxelLookup lookup(filled);
    const VoxelBox box = boxOf(grid);
    uint64_t count = 0;
    for (int z = box.low.z - 2; z <= box.high.z + 2; ++z) {
      for (int y = box.low.y - 2; y <= box.high.y + 2; ++y) {
        for (int x = box.low.x - 2; x <= box.high.x + 2; ++x) {
          const bool is_solid = holds(box, {x, y, z}) && space->state({x, y, z}) != VoxelState::kFree;
          ASSERT_EQ(lookup.contains({x, y, z}), is_solid) << x << ' ' << y << ' ' << z;
          count += is_solid;
        }
      }
    }
    EXPECT_EQ(filled.count(), count);
    EXPECT_EQ(space->counts().inner + space->counts().surface, count);
    for (size_t i = 0; i < filled.blocks.size(); ++i) {
      EXPECT_FALSE(filled.blocks[i].bricks.empty());
      EXPECT_TRUE(i == 0 || placeBefore(filled.blocks[i - 1].place, filled.blocks[i].place));
    }
  }
}

std::string openMessage(const Scene& scene, InsideRule rule) {
  try {
    requireClosed(scene, closedParts(scene, rule));
  } catch (const Error& error) {
    return error.what();
  }
  return "closed";
}

TEST(ClosedParts, NameObjectAndEdgeOfWhatIsOpen) {
  Scene scene;
  addBox(scene, glm::vec3(0), glm::vec3(1), false, true);
  addBox(scene, glm::vec3(3), glm::vec3(4), true, false);
  addBox(scene, glm::vec3(0.5), glm::vec3(2), false, true);
  for (const InsideRule rule : {InsideRule::kParity, InsideRule::kWinding}) {
    EXPECT_EQ(openMessage(scene, rule), "closed");
    EXPECT_EQ(closedText(closedParts(scene, rule)), "closed parts: 3 of 3");
  }
  Scene turned = scene;  // a triangle whose winding is not that of the others
  std::swap(turned.triangles[12].y, turned.triangles[12].z);
  EXPECT_EQ(openMessage(turned, InsideRule::kParity), "closed");
  EXPECT_EQ(closedText(closedParts(turned, InsideRule::kWinding)), "closed parts: 2 of 3");
  Scene open = scene;  // without its last triangle, which shares an edge with the fourth
  open.triangles.pop_back();
  --open.objects.back().triangle_count;
  open.offset = {1000, 0, 0};
  EXPECT_EQ(openMessage(open, InsideRule::kParity),
            "part 2 is not closed: its triangle 27 has an open edge from 1002,0.5,2 to 1002,2,2; closed "
            "parts: 2 of 3; close it, or say what is solid by what is reached");
  const ClosedParts parts = closedParts(open, InsideRule::kParity);
  for (uint32_t id = 0; id < open.triangleCount(); ++id) EXPECT_EQ(parts.is_closed[id], id < 24);
}

// A corner on an edge opens it, and a triangle without area along the edge closes it again.
TEST(ClosedParts, CountTrianglesWithoutArea) {
  Scene scene;
  addBox(scene, glm::vec3(0), glm::vec3(2), false, true);
  // 0 2 1 becomes 0 2 8 and 8 2 1, with 8 in the middle of the edge from 1 to 0.
  scene.positions.emplace_back(1, 0, 0);
  scene.triangles[0] = {0, 2, 8};
  scene.triangles.push_back({8, 2, 1});
  ++scene.objects[0].triangle_count;
  EXPECT_EQ(closedText(closedParts(scene, InsideRule::kWinding)), "closed parts: 0 of 1");
  scene.triangles.push_back({0, 8, 1});
  ++scene.objects[0].triangle_count;
  EXPECT_EQ(closedText(closedParts(scene, InsideRule::kWinding)), "closed parts: 1 of 1");
  EXPECT_EQ(closedText(closedParts(scene, InsideRule::kParity)), "closed parts: 1 of 1");
  const VoxelGrid grid = voxelize(scene, {.lattice = latticeOf(0.125)});
  const VoxelSpace space =
      solidParts(scene, grid, closedParts(scene, InsideRule::kParity), InsideRule::kParity);
  EXPECT_EQ(space.counts().inner, 14u * 14u * 14u);
}

}  // namespace
}  // namespace sightline
