#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "bvh/bvh.h"
#include "core/judge/candidates.h"
#include "core/judge/judge_ray.h"
#include "core/scene/scene.h"

namespace sightline {

/// What ends a ray, without rounding.
struct ExactHit {
  std::vector<uint32_t> triangles;  ///< all that it meets at the smallest distance, ascending; empty: none
  DoubleRange t;                    ///< holds the distance, in units of the direction

  bool missed() const { return triangles.empty(); }
  bool contains(uint32_t triangle) const;
};

/// Decides what rays meet first, on the float inputs as they are: hits are those of exact_contact.h (edges
/// and corners count, t > 0, a ray in a triangle's plane passes it by). Double arithmetic with error bounds
/// decides nearly all of it, CGAL's exact numbers the rest. Holes of masks and backs of what has only a front
/// are not met, glass is met but ends no ray (surface_contact.h). Thread-safe after construction.
class Judge {
 public:
  /// Both must outlive it.
  Judge(const Scene& scene, const Bvh& bvh);

  ExactHit nearest(const JudgeRay& ray) const;

  /// Whether the ray meets the triangle at all.
  bool meets(const JudgeRay& ray, uint32_t triangle) const;

  /// The glass that the ray meets no farther than where it ends, which is `end` = nearest(ray): ascending.
  std::vector<uint32_t> glassBefore(const JudgeRay& ray, const ExactHit& end) const;

  /// Whether the ray sees the triangle: it ends there, or meets it as glass no farther than where it ends.
  bool sees(const JudgeRay& ray, uint32_t triangle) const;

  bool hasGlass() const { return has_glass_; }
  /// Whether rays go on behind the triangle.
  bool isGlass(uint32_t triangle) const { return (scene_.surfaceOf(triangle) & kSurfaceGlass) != 0; }

  /// Where the ray's line crosses the triangle's plane: a range of less than 2^-40 of it.
  /// Nothing where they are parallel or the triangle has no area.
  std::optional<DoubleRange> planeDistance(const JudgeRay& ray, uint32_t triangle) const;

  /// All triangles that come within `reach` (world units) of the ray before t = limit, and perhaps others;
  /// ascending.
  std::vector<uint32_t> near(const JudgeRay& ray, double reach, double limit) const;

  /// Whether rays may pass inside the triangle's edges: through holes, or from behind.
  bool isPassable(uint32_t triangle) const {
    return (scene_.surfaceOf(triangle) & (kSurfaceMasked | kSurfaceFrontOnly)) != 0;
  }

  /// The corners of a triangle.
  JudgeTriangle corners(uint32_t triangle) const;
  uint32_t triangleCount() const { return scene_.triangleCount(); }

 private:
  /// Whether it meets a triangle, which it meets, farther than where it ends.
  bool isBehind(const JudgeRay& ray, uint32_t triangle, const ExactHit& end) const;

  const Scene& scene_;
  CandidateWalk candidates_;
  bool has_glass_;
};

}  // namespace sightline
