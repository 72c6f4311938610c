#include "tests/backend/trace_cases.h"

#include <fmt/format.h>

#include <bit>

#include "core/shared/triangle.h"

namespace sightline {
namespace {

using testing_support::addTriangle;
using testing_support::Random;
using testing_support::soup;

/// A height field on a grid: shared vertices, and flat parts where whole boxes have no thickness.
Scene terrain(Random& random, int side, bool flat) {
  Scene scene;
  for (int z = 0; z <= side; ++z) {
    for (int x = 0; x <= side; ++x) {
      scene.positions.push_back({float(x), flat ? 0.0f : random.unit() * 2, float(z)});
    }
  }
  for (int z = 0; z < side; ++z) {
    for (int x = 0; x < side; ++x) {
      const uint32_t i = uint32_t(z * (side + 1) + x), below = i + uint32_t(side) + 1;
      scene.triangles.push_back({i, i + 1, below});
      scene.triangles.push_back({i + 1, below + 1, below});
    }
  }
  for (vec3& p : scene.positions) p = (p * (2.0f / float(side))) - vec3(1, 0, 1);
  return scene;
}

/// Axis-aligned boxes, many of which touch: equal distances, and rays within faces.
Scene boxes(Random& random, int count) {
  Scene scene;
  for (int i = 0; i < count; ++i) {
    const vec3 low = glm::floor(random.point(8)) / 8.0f, high = low + vec3(0.125f);
    vec3 c[8];
    for (int k = 0; k < 8; ++k)
      c[k] = {k & 1 ? high.x : low.x, k & 2 ? high.y : low.y, k & 4 ? high.z : low.z};
    for (const auto& f :
         {std::array{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}}) {
      addTriangle(scene, c[f[0]], c[f[1]], c[f[2]]);
      addTriangle(scene, c[f[0]], c[f[2]], c[f[3]]);
    }
  }
  return scene;
}

vec3 pointOf(Random& random, const Scene& scene, uint32_t kind) {
  const glm::uvec3 t = scene.triangles[random.pick(uint32_t(scene.triangles.size()))];
  const vec3 a = scene.positions[t.x], b = scene.positions[t.y], c = scene.positions[t.z];
  if (kind == 0) return a;
  const vec3 edge = glm::mix(a, b, random.unit());
  return kind == 1 ? edge : glm::mix(edge, c, random.unit());
}

std::vector<Ray> raysFor(Random& random, const Scene& scene, vec3 center, float scale, int count) {
  std::vector<Ray> rays;
  vec3 origin{0}, target{0};
  for (int i = 0; i < count; ++i) {
    const bool coherent = i % 64 < 32 && i % 8 != 0;  // packets of eight that differ little
    if (!coherent) {
      origin = center + random.point(scale * (random.pick(2) ? 0.5f : 3.0f));
      if (random.pick(16) == 0) origin = pointOf(random, scene, random.pick(3));
      target = pointOf(random, scene, random.pick(4));
    } else {
      target += random.point(scale * 0.01f);
    }
    vec3 direction = target - origin;
    if (!coherent && random.pick(8) == 0) {
      const int axis = int(random.pick(3));
      direction = vec3(0);
      direction[axis] = random.pick(2) ? scale : -scale;
      const float along = origin[axis];
      origin = target;
      origin[axis] = along;
    }
    if (random.pick(50) == 0) direction = vec3(0);
    if (random.pick(10) == 0) direction *= std::exp2(float(random.pick(40)) - 20);
    rays.push_back({vec4(origin, 0), vec4(direction, 0)});
  }
  return rays;
}

std::vector<TraceCase> makeCases() {
  Random random(11);
  std::vector<TraceCase> cases;
  auto add = [&](std::string name, Scene scene, vec3 offset, float scale) {
    for (vec3& p : scene.positions) p = p * scale + offset;
    std::vector<Ray> rays = raysFor(random, scene, offset, scale, 1500);
    cases.push_back({std::move(name), std::move(scene), std::move(rays)});
  };
  add("soup", soup(random, 2000, 0.2f, 1), vec3(0), 1);
  add("small soup", soup(random, 3000, 0.01f, 1), vec3(0), 100);
  add("slivers", soup(random, 1500, 1.5f, 1e-4f), vec3(0), 10);
  add("needles", soup(random, 1500, 1.5f, 1e-7f), vec3(3, -2, 1), 1);
  add("terrain", terrain(random, 30, false), vec3(0), 50);
  add("plane", terrain(random, 30, true), vec3(0), 50);
  add("boxes", boxes(random, 150), vec3(0), 8);
  add("far away soup", soup(random, 2000, 0.2f, 1), vec3(1e7f, -1e7f, 1e7f), 1000);
  add("far away boxes", boxes(random, 150), vec3(1e7f, 3e6f, -1e7f), 64);
  add("tiny terrain", terrain(random, 20, false), vec3(0), 1e-12f);
  add("huge soup", soup(random, 1000, 0.3f, 1), vec3(0), 1e9f);
  add("one triangle", soup(random, 1, 1, 1), vec3(0), 1);
  Scene copies = soup(random, 50, 0.5f, 1);
  const std::vector<glm::uvec3> once = copies.triangles;
  for (int i = 0; i < 20; ++i) copies.triangles.insert(copies.triangles.begin(), once.begin(), once.end());
  add("copies", copies, vec3(0), 1);
  return cases;
}

}  // namespace

const std::vector<TraceCase>& traceCases() {
  static const std::vector<TraceCase> cases = makeCases();
  return cases;
}

std::vector<BvhConfig> traceConfigs() {
  std::vector<BvhConfig> configs(4);
  configs[1].max_leaf_size = 1;
  configs[2].max_leaf_size = 8;
  configs[3].spatial_splits = true;
  return configs;
}

std::vector<Hit> bruteForce(const Scene& scene, const std::vector<Ray>& rays) {
  std::vector<Hit> hits;
  for (const Ray& ray : rays) {
    Hit best{INFINITY, kNoTriangle};
    if (vec3(ray.direction) != vec3(0)) {
      const ShearedRay sheared = shearRay(ray);
      for (uint32_t id = 0; id < scene.triangles.size(); ++id) {
        const glm::uvec3 v = scene.triangles[id];
        const float t =
            intersectTriangle(sheared, scene.positions[v.x], scene.positions[v.y], scene.positions[v.z]);
        if (t > 0 && t < best.t) best = {t, id};
      }
    }
    hits.push_back(best);
  }
  return hits;
}

testing::AssertionResult sameHit(const char*, const char*, const Hit& actual, const Hit& expected) {
  const bool same = actual.triangle == expected.triangle &&
                    (expected.triangle == kNoTriangle ||
                     std::bit_cast<uint32_t>(actual.t) == std::bit_cast<uint32_t>(expected.t));
  if (same) return testing::AssertionSuccess();
  return testing::AssertionFailure() << fmt::format("triangle {} at {:a}, expected {} at {:a}",
                                                    actual.triangle, actual.t, expected.triangle, expected.t);
}

}  // namespace sightline
