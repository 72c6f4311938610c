#include "core/strip/aimed_rays.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>

#include "core/base/splitmix.h"
#include "core/sampling/face_rays.h"
#include "core/sampling/ray_random.h"
#include "core/trace/sights.h"

namespace sightline {
namespace {

/// Numbers of rays that are traced at once: bounds the memory.
constexpr uint64_t kAimedChunk = 1u << 21;
/// A random point of a ball of radius 1 nearer to its centre than this gives no direction.
constexpr double kLeastRadius = 1.0 / 1024;

/// A face of the cell in double.
struct AimFace {
  glm::dvec3 corner, edge_u, edge_v, normal;
  double area;
};

double unitOf(RayRandom& random) {
  return double(random.bits() >> 11) * 0x1p-53;
}

glm::dvec3 pointOf(RayRandom& random, const std::array<glm::vec3, 3>& corners) {
  double u = unitOf(random), v = unitOf(random);
  if (u + v > 1) u = 1 - u, v = 1 - v;
  const glm::dvec3 a(corners[0]), b(corners[1]), c(corners[2]);
  return a + (b - a) * u + (c - a) * v;
}

/// A direction of a sphere, uniform. From a ball, so that it needs no trigonometry.
glm::dvec3 directionOf(RayRandom& random) {
  for (;;) {
    const double x = unitOf(random), y = unitOf(random), z = unitOf(random);
    const glm::dvec3 point = glm::dvec3(x, y, z) * 2.0 - 1.0;
    const double length = std::sqrt(glm::dot(point, point));
    if (length <= 1 && length > kLeastRadius) return point / length;
  }
}

/// Makes the rays of a cell that are aimed at triangles.
class Aim {
 public:
  Aim(const ViewCell& cell, const AimedRays& aimed)
      : key_(splitmix(aimed.seed) ^ splitmix((uint64_t(aimed.round) << 32 | aimed.cell_index) + 1)),
        rays_each_(aimed.each) {
    for (const Face& face : cellFaces(cell)) {
      const glm::dvec3 u(face.edge_u), v(face.edge_v);
      faces_.push_back(
          {glm::dvec3(face.corner), u, v, glm::dvec3(face.normal), glm::length(glm::cross(u, v))});
      area_ += faces_.back().area;
    }
  }

  /// Ray `number` (0 .. rays_each - 1) of those at the triangle; without direction if there is none.
  Ray at(const std::array<glm::vec3, 3>& corners, uint32_t id, uint32_t number) const {
    RayRandom random(key_, uint64_t(id) * rays_each_ + number);
    const glm::dvec3 target = pointOf(random, corners);
    const std::optional<glm::dvec3> origin = number % kAimedAtCell == kAimedAtCell - 1
                                                 ? anyPlace(random, target)
                                                 : placeAlong(random, corners, target);
    if (!origin) return {};
    const glm::vec3 from(*origin);
    return {vec4(from, 0), vec4(glm::vec3(target - glm::dvec3(from)), 0)};
  }

 private:
  std::optional<glm::dvec3> anyPlace(RayRandom& random, const glm::dvec3& target) const {
    double rest = unitOf(random) * area_;
    size_t f = 0;
    while (f + 1 < faces_.size() && rest >= faces_[f].area) rest -= faces_[f++].area;
    const double u = unitOf(random), v = unitOf(random);
    const glm::dvec3 place = faces_[f].corner + faces_[f].edge_u * u + faces_[f].edge_v * v;
    if (glm::dot(target - place, faces_[f].normal) <= 0) return std::nullopt;
    return place;
  }

  /// Where the line out of the triangle, more often the straighter, meets a face that its rays leave towards
  /// it.
  std::optional<glm::dvec3> placeAlong(RayRandom& random, const std::array<glm::vec3, 3>& corners,
                                       const glm::dvec3& target) const {
    const glm::dvec3 a(corners[0]), b(corners[1]), c(corners[2]);
    const glm::dvec3 normal = glm::cross(b - a, c - a);
    const double length = std::sqrt(glm::dot(normal, normal));
    if (!(length > 0)) return std::nullopt;
    const double side = (random.bits() & 1) != 0 ? 1 : -1;
    const glm::dvec3 way = normal * (side / length) + directionOf(random);
    for (const AimFace& face : faces_) {
      const double along = glm::dot(way, face.normal);
      if (!(along < 0)) continue;
      const double distance = glm::dot(face.corner - target, face.normal) / along;
      if (!(distance > 0)) continue;
      const glm::dvec3 place = target + way * distance, inside = place - face.corner;
      const double u = glm::dot(inside, face.edge_u) / glm::dot(face.edge_u, face.edge_u),
                   v = glm::dot(inside, face.edge_v) / glm::dot(face.edge_v, face.edge_v);
      if (u >= 0 && u <= 1 && v >= 0 && v <= 1) return place;
    }
    return std::nullopt;
  }

  uint64_t key_;
  uint32_t rays_each_;
  std::vector<AimFace> faces_;
  double area_ = 0;
};

/// A number for an edge by where its ends are, the same from both sides; two edges that share one only keep
/// more.
uint64_t edgeNumber(const glm::vec3& a, const glm::vec3& b) {
  const auto number = [](const glm::vec3& p) {
    uint64_t bits = 0;
    for (int axis = 0; axis < 3; ++axis) {
      bits = splitmix(bits ^ std::bit_cast<uint32_t>(p[axis] + 0.0f));  // -0 is 0
    }
    return bits;
  };
  return splitmix(number(a)) + splitmix(number(b));
}

std::array<uint64_t, 3> edgesOf(const std::array<glm::vec3, 3>& corners) {
  return {edgeNumber(corners[0], corners[1]), edgeNumber(corners[1], corners[2]),
          edgeNumber(corners[2], corners[0])};
}

}  // namespace

uint64_t markAimed(const TracedScene& scene, const ViewCell& cell, const AimedRays& aimed,
                   const std::vector<bool>& kept, std::vector<bool>& seen, const RayProgress& progress) {
  std::vector<uint32_t> targets;
  for (uint32_t id = 0; id < kept.size(); ++id) {
    if (!kept[id]) targets.push_back(id);
  }
  const Aim aim(cell, aimed);
  const uint64_t rays = targets.size() * uint64_t(aimed.each);
  std::vector<Ray> batch(std::min(rays, kAimedChunk));
  Sights sights;
  uint64_t marked = 0;
  for (uint64_t first = 0; first < rays; first += kAimedChunk) {
    const auto count = uint32_t(std::min(rays - first, kAimedChunk));
    tbb::parallel_for(0u, count, [&](uint32_t i) {
      const uint32_t id = targets[(first + i) / aimed.each];
      batch[i] = aim.at(scene.scene.corners(id), id, uint32_t((first + i) % aimed.each));
    });
    sights.trace(scene.tracer, std::span(batch).first(count));
    for (uint32_t i = 0; i < count; ++i) {
      sights.visit(i, [&](uint32_t id) {
        marked += seen[id] || kept[id] ? 0 : 1;
        seen[id] = true;
      });
    }
    if (progress && !progress(first + count)) break;
  }
  return marked;
}

std::vector<bool> withNeighbours(const Scene& scene, const std::vector<bool>& seen) {
  std::vector<uint64_t> edges;
  scene.visitTriangles(0, scene.triangleCount(), [&](uint32_t id, const std::array<glm::vec3, 3>& corners) {
    if (!seen[id]) return;
    const auto its = edgesOf(corners);
    edges.insert(edges.end(), its.begin(), its.end());
  });
  tbb::parallel_sort(edges);
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  std::vector<bool> kept = seen;
  scene.visitTriangles(0, scene.triangleCount(), [&](uint32_t id, const std::array<glm::vec3, 3>& corners) {
    if (seen[id]) return;
    const auto its = edgesOf(corners);
    kept[id] = std::any_of(its.begin(), its.end(), [&](uint64_t edge) {
      return std::binary_search(edges.begin(), edges.end(), edge);
    });
  });
  return kept;
}

}  // namespace sightline
