// No ray slips through a closed mesh: rays from inside, aimed exactly at vertices and at points of edges.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "core/device/opencl/opencl_scene.h"
#include "core/trace/cpu_tracer.h"
#include "tests/backend/trace_cases.h"

namespace sightline {
namespace {

/// Ten million rays in all on the OpenCL device: two meshes in five places.
constexpr uint32_t kRays = 1'000'000;
constexpr uint32_t kCpuRays = 100'000;

/// Radius 1 about the origin; all faces of a corner meet in one vertex.
Scene makeSphere(uint32_t rows, uint32_t columns) {
  Scene scene;
  scene.positions.push_back({0, 1, 0});
  for (uint32_t i = 1; i < rows; ++i) {
    const double polar = std::numbers::pi * i / rows;
    for (uint32_t k = 0; k < columns; ++k) {
      const double azimuth = 2 * std::numbers::pi * k / columns;
      scene.positions.push_back(glm::dvec3(std::sin(polar) * std::cos(azimuth), std::cos(polar),
                                           std::sin(polar) * std::sin(azimuth)));
    }
  }
  scene.positions.push_back({0, -1, 0});
  const uint32_t south = uint32_t(scene.positions.size()) - 1;
  const auto at = [&](uint32_t row, uint32_t k) { return 1 + (row - 1) * columns + k % columns; };
  for (uint32_t k = 0; k < columns; ++k) {
    scene.triangles.push_back({0, at(1, k + 1), at(1, k)});
    scene.triangles.push_back({south, at(rows - 1, k), at(rows - 1, k + 1)});
    for (uint32_t row = 1; row + 1 < rows; ++row) {
      scene.triangles.push_back({at(row, k), at(row, k + 1), at(row + 1, k)});
      scene.triangles.push_back({at(row, k + 1), at(row + 1, k + 1), at(row + 1, k)});
    }
  }
  return scene;
}

/// The cube [-1, 1]^3 with `side` squares along each edge: axis-aligned, so that boxes have no thickness.
Scene makeCube(uint32_t side) {
  Scene scene;
  std::map<std::array<uint32_t, 3>, uint32_t> index;
  const auto vertex = [&](std::array<uint32_t, 3> p) {
    const auto [place, fresh] = index.emplace(p, uint32_t(scene.positions.size()));
    if (fresh) scene.positions.push_back(vec3(p[0], p[1], p[2]) * (2.0f / float(side)) - 1.0f);
    return place->second;
  };
  for (uint32_t axis = 0; axis < 3; ++axis) {
    for (uint32_t level : {0u, side}) {
      for (uint32_t i = 0; i < side; ++i) {
        for (uint32_t k = 0; k < side; ++k) {
          const auto corner = [&](uint32_t u, uint32_t v) {
            std::array<uint32_t, 3> p{};
            p[axis] = level;
            p[(axis + 1) % 3] = i + u;
            p[(axis + 2) % 3] = k + v;
            return vertex(p);
          };
          const uint32_t a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
          scene.triangles.push_back({a, b, c});
          scene.triangles.push_back({a, c, d});
        }
      }
    }
  }
  return scene;
}

struct Place {
  vec3 offset;
  float scale;
};

const Place kPlaces[] = {{vec3(0), 1},
                         {vec3(100, -50, 3), 1},
                         {vec3(1e7f, -1e7f, 1e7f), 2000},
                         {vec3(0.25f, 0, 7), 1e-3f},
                         {vec3(-3e5f, 0, 1e4f), 1e6f}};

/// Random bits by counter (Steele et al., SplitMix64, 2014): any ray alone, in any order.
uint64_t bitsOf(uint64_t counter) {
  uint64_t z = (counter + 1) * 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

float unitOf(uint64_t bits) {
  return float(bits >> 40) * 0x1p-24f;
}

/// Ray i: from the inner half of the mesh to a vertex, an edge's point, or, one in eight, an edge's middle.
Ray aimedRay(const Scene& scene, const Place& place, uint64_t i) {
  const uint64_t r = bitsOf(4 * i), s = bitsOf(4 * i + 1);
  const vec3 inner(unitOf(bitsOf(4 * i + 2)), unitOf(bitsOf(4 * i + 3)), unitOf(s));
  const vec3 origin = place.offset + (inner - 0.5f) * (0.5f * place.scale);
  const glm::uvec3 corners = scene.triangles[(r >> 8) % scene.triangles.size()];
  const vec3 a = scene.positions[corners[int(r % 3)]], b = scene.positions[corners[int((r + 1) % 3)]];
  const uint64_t kind = (r >> 3) % 8;
  const vec3 target = kind < 3 ? a : (kind == 3 ? (a + b) * 0.5f : glm::mix(a, b, unitOf(s << 7)));
  return {vec4(origin, 0), vec4(target - origin, 0)};
}

Scene moved(Scene scene, const Place& place) {
  for (vec3& p : scene.positions) p = p * place.scale + place.offset;
  return scene;
}

/// Hits must exist, at the target: t = 1 up to the spacing of the coordinates.
testing::AssertionResult reachesTheMesh(const Hit& hit, const Ray& ray, const Place& place, uint64_t i) {
  if (hit.triangle == kNoTriangle) {
    return testing::AssertionFailure() << fmt::format("ray {} {} is lost (offset {}, scale {})", i,
                                                      describeRay(ray), place.offset.x, place.scale);
  }
  if (std::fabs(hit.t - 1) > 0.02f) {
    return testing::AssertionFailure()
           << fmt::format("ray {} {} hits triangle {} at t = {} (offset {}, scale {})", i, describeRay(ray),
                          hit.triangle, hit.t, place.offset.x, place.scale);
  }
  return testing::AssertionSuccess();
}

void traceOnOpenCl(const Scene& mesh, uint32_t per_item) {
  if (listOpenClDevices().empty()) GTEST_SKIP() << "no OpenCL device";
  OpenClContext context("opencl");
  buildKernels(context, per_item);
  const ClKernel kernel = context.kernel("traceRaysKernel");
  std::vector<Ray> rays(kRays);
  std::vector<Hit> hits(kRays);
  const ClBuffer ray_buffer = context.buffer(kRays * sizeof(Ray), "rays");
  const ClBuffer hit_buffer = context.buffer(kRays * sizeof(Hit), "hits");
  for (const Place& place : kPlaces) {
    const Scene scene = moved(mesh, place);
    const OpenClScene uploaded =
        uploadScene(context, scene, buildBvh(scene.positions, scene.triangles), per_item);
    tbb::parallel_for(0u, kRays, [&](uint32_t i) { rays[i] = aimedRay(scene, place, i); });
    context.write(ray_buffer, rays.data(), kRays * sizeof(Ray));
    context.launch(kernel, (kRays + per_item - 1) / per_item, 8, uploaded.nodes, uploaded.triangles,
                   uploaded.reach, ray_buffer, hit_buffer, kRays);
    context.read(hit_buffer, hits.data(), kRays * sizeof(Hit));
    for (uint32_t i = 0; i < kRays; ++i) ASSERT_TRUE(reachesTheMesh(hits[i], rays[i], place, i));
  }
}

TEST(Watertight, SphereOnOpenClInPackets) {
  traceOnOpenCl(makeSphere(64, 100), 8);
}
TEST(Watertight, SphereOnOpenClRayByRay) {
  traceOnOpenCl(makeSphere(64, 100), 1);
}
TEST(Watertight, CubeOnOpenClInPackets) {
  traceOnOpenCl(makeCube(30), 8);
}
TEST(Watertight, CubeOnOpenClRayByRay) {
  traceOnOpenCl(makeCube(30), 1);
}

TEST(Watertight, SphereAndCubeOnTheProcessor) {
  for (const Scene& mesh : {makeSphere(40, 60), makeCube(12)}) {
    for (const Place& place : kPlaces) {
      const Scene scene = moved(mesh, place);
      const Bvh bvh = buildBvh(scene.positions, scene.triangles);
      const CpuTracer tracer(scene, bvh);
      for (uint32_t i = 0; i < kCpuRays; ++i) {
        const Ray ray = aimedRay(scene, place, i);
        ASSERT_TRUE(reachesTheMesh(tracer.trace(ray), ray, place, i));
      }
    }
  }
}

}  // namespace
}  // namespace sightline
