#pragma once
// Small scenes and rays on which rounding would decide, for the judge's tests.
#include <cmath>
#include <string>
#include <vector>

#include "core/scene/scene.h"
#include "core/shared/types.h"
#include "tests/support/random_triangles.h"

namespace sightline::judge_test {

using testing_support::addTriangle;
using testing_support::describeRay;
using testing_support::Random;
using testing_support::soup;

struct JudgeCase {
  std::string name;
  Scene scene;
  std::vector<Ray> rays;
};

/// A corner, an edge's middle, a point of an edge or of the inside.
inline vec3 targetOf(Random& random, const Scene& scene) {
  const glm::uvec3 t = scene.triangles[random.pick(uint32_t(scene.triangles.size()))];
  const vec3 a = scene.positions[t.x], b = scene.positions[t.y], c = scene.positions[t.z];
  const uint32_t kind = random.pick(4);
  if (kind == 0) return a;
  if (kind == 1) return (a + b) * 0.5f;
  const vec3 edge = glm::mix(a, b, random.unit());
  return kind == 2 ? edge : glm::mix(edge, c, random.unit());
}

/// Rays from anywhere, from triangles, along axes, at corners; whole numbers where `lattice` is not 0.
inline std::vector<Ray> judgeRays(Random& random, const Scene& scene, int count, vec3 center, float scale,
                                  uint32_t lattice) {
  std::vector<Ray> rays;
  while (int(rays.size()) < count) {
    vec3 origin = center + (lattice > 0 ? random.lattice(lattice) : random.point(2)) * scale;
    const vec3 target = targetOf(random, scene);
    if (random.pick(8) == 0) origin = targetOf(random, scene);
    if (random.pick(6) == 0) {
      const int axis = int(random.pick(3));
      const float along = origin[axis];
      origin = target;
      origin[axis] = along;
    }
    const vec3 direction = target - origin;
    if (direction == vec3(0)) continue;
    rays.push_back({vec4(origin, 0), vec4(direction, 0)});
  }
  return rays;
}

inline Scene latticeSoup(Random& random, int count, uint32_t n) {
  Scene scene;
  for (int i = 0; i < count; ++i) {
    const vec3 a = random.lattice(n), b = random.lattice(n), c = random.lattice(n);
    addTriangle(scene, a, b, c);
  }
  return scene;
}

inline std::vector<JudgeCase> judgeCases(int triangles, int rays) {
  Random random(5);
  std::vector<JudgeCase> cases;
  const auto add = [&](std::string name, Scene scene, vec3 offset, float scale, uint32_t lattice) {
    for (vec3& p : scene.positions) p = p * scale + offset;
    auto its_rays = judgeRays(random, scene, rays, offset, scale, lattice);
    cases.push_back({std::move(name), std::move(scene), std::move(its_rays)});
  };
  add("lattice", latticeSoup(random, triangles, 3), vec3(0), 1, 4);
  add("dense lattice, ties everywhere", latticeSoup(random, triangles, 1), vec3(0), 1, 2);
  add("lattice far away", latticeSoup(random, triangles, 3), vec3(1e7f, -1e7f, 3e6f), 4, 4);
  add("soup", soup(random, triangles, 1, 1), vec3(0), 1, 0);
  add("slivers of aspect 1e7", soup(random, triangles, 2, 1e-7f), vec3(0), 1, 0);
  add("tiny", soup(random, triangles, 1, 1), vec3(0), 1e-30f, 0);
  add("below the smallest normal float", soup(random, triangles, 1, 1), vec3(0), 1e-41f, 0);
  add("huge", soup(random, triangles, 1, 1), vec3(0), 1e36f, 0);
  add("far away soup", soup(random, triangles, 1, 1), vec3(-1e7f, 1e7f, 5), 100, 0);
  Scene copies = soup(random, triangles / 4, 1, 1);
  const std::vector<glm::uvec3> once = copies.triangles;
  for (int i = 0; i < 3; ++i) copies.triangles.insert(copies.triangles.begin(), once.begin(), once.end());
  add("copies", copies, vec3(0), 1, 0);
  return cases;
}

}  // namespace sightline::judge_test
