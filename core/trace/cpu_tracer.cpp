#include "core/trace/cpu_tracer.h"

#include <algorithm>
#include <cmath>

#include "core/shared/box.h"
#include "core/shared/placement.h"
#include "core/shared/ray.h"
#include "core/shared/surface.h"
#include "core/shared/triangle.h"
#include "core/shared/vector.h"

namespace sightline {
namespace {

/// A subtree still to visit.
struct StackEntry {
  uint32_t child;
  uint32_t count;
  float near_t;
};

/// Each node on a path leaves at most seven siblings behind.
constexpr uint32_t kStackSize = 7 * kMaxDepth + 8;

/// The planes of a node's eight boxes that the ray meets first and last, by the sign of its direction.
struct PlaneOffsets {
  int near_x, far_x, near_y, far_y, near_z, far_z;  ///< rows of eight floats from the node's start
};

PlaneOffsets planeOffsets(const BoxRay& ray) {
  const int x = ray.inverse.x < 0, y = ray.inverse.y < 0, z = ray.inverse.z < 0;
  return {x, 1 - x, 2 + y, 3 - y, 4 + z, 5 - z};
}

struct Children {
  float near_t[8];
  float far_t[8];
};

/// Plain loops of eight: the compiler makes vector instructions of them.
inline void intersectChildren(const BvhNode8& node, const BoxRay& ray, const PlaneOffsets& rows, float best,
                              Children& out) {
  const float* planes = node.low_x;
  const float *near_x = planes + 8 * rows.near_x, *far_x = planes + 8 * rows.far_x;
  const float *near_y = planes + 8 * rows.near_y, *far_y = planes + 8 * rows.far_y;
  const float *near_z = planes + 8 * rows.near_z, *far_z = planes + 8 * rows.far_z;
  auto larger = [](float a, float b) { return a > b ? a : b; };
  auto smaller = [](float a, float b) { return a < b ? a : b; };
  for (int i = 0; i < 8; ++i) {
    out.near_t[i] = larger(
        larger(near_x[i] * ray.inverse.x + ray.near_addend.x, near_y[i] * ray.inverse.y + ray.near_addend.y),
        larger(near_z[i] * ray.inverse.z + ray.near_addend.z, 0.0f));
    out.far_t[i] = smaller(
        smaller(far_x[i] * ray.inverse.x + ray.far_addend.x, far_y[i] * ray.inverse.y + ray.far_addend.y),
        smaller(far_z[i] * ray.inverse.z + ray.far_addend.z, best));
  }
}

inline void keepNearer(float t, uint32_t id, Hit& best) {
  if (t > 0 && (t < best.t || (t == best.t && id < best.triangle))) best = {t, id};
}

/// A triangle as a ray meets it: corners in the world, and kInstance... bits of what placed it.
struct MetTriangle {
  Corners corners;
  uint32_t id;
  uint32_t bits;
};

/// A hit on a triangle with a surface of its own. Glass may lie as near as the best hit, whatever the ids.
inline void considerSurface(const uint32_t* surfaces, uint32_t place, const ShearedRay& ray,
                            const MetTriangle& met, float t, Hit& best, std::vector<Hit>* glass) {
  const uint32_t surface = surfaces[kSurfaceHeaderWords + place];
  const bool is_glass = (surface & kSurfaceGlass) != 0;
  if (is_glass && glass == nullptr) return;
  if (!(t > 0 && (t < best.t || (t == best.t && (is_glass || met.id < best.triangle))))) return;
  if (!placedSurfaceHolds(surfaces, surface, ray, met.corners.a, met.corners.b, met.corners.c,
                          (met.bits & kInstanceMirrors) != 0))
    return;
  if (is_glass) {
    glass->push_back({t, met.id});
  } else {
    best = {t, met.id};
  }
}

/// Walks a tree of 8-wide nodes; calls leaf(first, count) for the leaves that may hold a hit nearer than or
/// as near as best, which shrinks with the hits.
template <typename Leaf>
inline void walkTree(const BvhNode8* nodes, uint32_t root, const BoxRay& ray, const Hit& best, Leaf&& leaf) {
  const PlaneOffsets rows = planeOffsets(ray);
  StackEntry stack[kStackSize];
  uint32_t size = 0;
  stack[size++] = {root, 0, 0};
  while (size > 0) {
    const StackEntry entry = stack[--size];
    if (entry.near_t > best.t) continue;
    if (entry.count > 0) {
      leaf(entry.child, entry.count);
      continue;
    }
    const BvhNode8& node = nodes[entry.child];
    Children children;
    intersectChildren(node, ray, rows, best.t, children);
    const uint32_t bottom = size;
    for (int i = 0; i < 8; ++i) {
      // An empty slot is met by rays whose 1 / direction leaves the floats (core/shared/box.h).
      if (!(children.near_t[i] <= children.far_t[i]) || node.child[i] == kNoChild) continue;
      uint32_t place = size++;  // the farthest deepest in the stack
      for (; place > bottom && stack[place - 1].near_t < children.near_t[i]; --place) {
        stack[place] = stack[place - 1];
      }
      stack[place] = {node.child[i], node.count[i], children.near_t[i]};
    }
  }
}

}  // namespace

CpuTracer::CpuTracer(const Scene& scene, const Bvh& bvh) : bvh_(bvh), triangles_(bvh.references.size()) {
  checkTraceable(bvh);
  packTriangles(scene, bvh, 0, std::span<TriangleRecord>(triangles_));
  scene_reach_ = sceneReach(bvh.low, bvh.high);
  if (scene.surfaces.empty()) return;
  surfaces_ = packSurfaces(scene.surfaces, bvh.references);
  features_ = featuresOf(scene.surfaces);
}

CpuTracer::CpuTracer(std::vector<TriangleRecord> triangles, const Bvh& bvh)
    : bvh_(bvh), triangles_(std::move(triangles)), scene_reach_(sceneReach(bvh.low, bvh.high)) {
  checkTraceable(bvh);
}

Hit CpuTracer::trace(const Ray& ray) const {
  return surfaces_.empty() ? walk<false>(ray, nullptr) : walk<true>(ray, nullptr);
}

Hit CpuTracer::traceThrough(const Ray& ray, std::vector<Hit>& glass) const {
  glass.clear();
  if (!features_.glass) return trace(ray);
  const Hit best = walk<true>(ray, &glass);
  std::erase_if(glass, [&](const Hit& hit) { return hit.t > best.t; });
  std::ranges::sort(glass, {}, &Hit::triangle);
  const auto same = [](const Hit& a, const Hit& b) { return a.triangle == b.triangle; };  // spatial splits
  glass.erase(std::unique(glass.begin(), glass.end(), same), glass.end());
  return best;
}

template <bool kSurfaces>
Hit CpuTracer::walk(const Ray& ray, [[maybe_unused]] std::vector<Hit>* glass) const {
  Hit best{INFINITY, kNoTriangle};
  if (!hasDirection(ray)) return best;
  // A ray with a NaN or an infinity in it would sort its boxes into no order; it hits nothing.
  if (!std::isfinite(dot3(xyz3(ray.origin), vec3(1)) + dot3(xyz3(ray.direction), vec3(1)))) return best;
  if (bvh_.hasInstances()) return traceInstances<kSurfaces>(ray, glass);
  const ShearedRay sheared = shearRay(ray);
  walkTree(bvh_.nodes8.data(), 0, boxRay(ray, scene_reach_), best, [&](uint32_t first, uint32_t count) {
    for (uint32_t i = first; i < first + count; ++i) {
      const float* v = triangles_[i].vertices;
      const Corners corners = {{v[0], v[1], v[2]}, {v[3], v[4], v[5]}, {v[6], v[7], v[8]}};
      const float t = intersectTriangle(sheared, corners.a, corners.b, corners.c);
      if constexpr (kSurfaces) {
        considerSurface(surfaces_.data(), i, sheared, {corners, triangles_[i].id, 0}, t, best, glass);
      } else {
        keepNearer(t, triangles_[i].id, best);
      }
    }
  });
  return best;
}

template <bool kSurfaces>
Hit CpuTracer::traceInstances(const Ray& ray, [[maybe_unused]] std::vector<Hit>* glass) const {
  Hit best{INFINITY, kNoTriangle};
  const ShearedRay sheared = shearRay(ray);
  const BoxRay world = boxRay(ray, scene_reach_);
  walkTree(bvh_.nodes8.data(), bvh_.top8, world, best, [&](uint32_t first, uint32_t count) {
    for (uint32_t place = first; place < first + count; ++place) {
      const InstanceRecord& instance = bvh_.instances[bvh_.instance_order[place]];
      const bool in_place = (instance.roots.z & kInstanceInPlace) != 0;
      const Ray local = in_place ? ray : localRay(instance, ray);
      if (!hasDirection(local)) continue;
      const BoxRay boxes = in_place ? world : instanceBoxRay(instance, ray, local, scene_reach_);
      walkTree(bvh_.nodes8.data(), instance.roots.y, boxes, best, [&](uint32_t begin, uint32_t triangles) {
        for (uint32_t i = begin; i < begin + triangles; ++i) {
          const float* v = triangles_[i].vertices;
          Corners t = {{v[0], v[1], v[2]}, {v[3], v[4], v[5]}, {v[6], v[7], v[8]}};
          if (!in_place) t = placeCorners(instance.place, instance.roots.z, t.a, t.b, t.c);
          const uint32_t id = instance.ids.x + triangles_[i].id;
          const float distance = intersectTriangle(sheared, t.a, t.b, t.c);
          if constexpr (kSurfaces) {
            considerSurface(surfaces_.data(), i, sheared, {t, id, instance.roots.z}, distance, best, glass);
          } else {
            keepNearer(distance, id, best);
          }
        }
      });
    }
  });
  return best;
}

void CpuTracer::tracePacket(const Ray* rays, Hit* hits, int count) const {
  for (int i = 0; i < count; ++i) hits[i] = trace(rays[i]);
}

}  // namespace sightline
