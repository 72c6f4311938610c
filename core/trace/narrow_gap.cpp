#include "core/trace/narrow_gap.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace sightline {
namespace {

/// cos and sin of k * 22.5 degrees: half a circle of directions.
constexpr double kCos[] = {1, 0.92387953251128674,  0.70710678118654752,  0.38268343236508977,
                           0, -0.38268343236508977, -0.70710678118654752, -0.92387953251128674};
constexpr double kSin[] = {0, 0.38268343236508977, 0.70710678118654752, 0.92387953251128674,
                           1, 0.92387953251128674, 0.70710678118654752, 0.38268343236508977};
constexpr size_t kDirections = std::size(kCos);
constexpr double kReach = 1.0195911582083184;  ///< 1 / cos 11.25 degrees
constexpr double kDepth = 4;
constexpr double kRounded = 1 - 0x1p-20;  ///< of a distance: what is nearer is so not by rounding alone
constexpr double kAcross = 2.01;          ///< of the reach: twice it, and room for rounding

/// A ray and two vectors of length 1 that span the plane in which its neighbours are looked for.
struct Look {
  uint32_t ray;
  glm::dvec3 u, v;
};

/// Two vectors across a direction of any length.
Look lookAcross(uint32_t ray, const glm::dvec3& d) {
  const glm::dvec3 size = glm::abs(d);
  const glm::dvec3 least = size.x <= size.y && size.x <= size.z ? glm::dvec3(1, 0, 0)
                           : size.y <= size.z                   ? glm::dvec3(0, 1, 0)
                                                                : glm::dvec3(0, 0, 1);
  const glm::dvec3 u = glm::normalize(glm::cross(d, least));
  return {ray, u, glm::normalize(glm::cross(d, u))};
}

/// What stops the neighbours on both sides.
struct Flanks {
  Hit hits[2];
  glm::dvec3 places[2];

  const Hit& nearer() const { return hits[0].t <= hits[1].t ? hits[0] : hits[1]; }
};

/// Distance of a point from a triangle.
// Based on: C. Ericson, Real-Time Collision Detection, 2005, section 5.1.5.
double distanceTo(const std::array<glm::vec3, 3>& corners, const glm::dvec3& p) {
  const glm::dvec3 a(corners[0]), ab = glm::dvec3(corners[1]) - a, ac = glm::dvec3(corners[2]) - a;
  const glm::dvec3 n = glm::cross(ab, ac), ap = p - a;
  const double area = glm::dot(n, n);
  if (area > 0) {
    const double w = glm::dot(glm::cross(ab, ap), n), v = glm::dot(glm::cross(ap, ac), n);
    if (v >= 0 && w >= 0 && v + w <= area) return std::abs(glm::dot(ap, n)) / std::sqrt(area);
  }
  double nearest = HUGE_VAL;
  for (int i = 0; i < 3; ++i) {
    const glm::dvec3 from(corners[i]), edge = glm::dvec3(corners[(i + 1) % 3]) - from;
    const double length = glm::dot(edge, edge);
    const double t = length > 0 ? std::clamp(glm::dot(p - from, edge) / length, 0.0, 1.0) : 0;
    nearest = std::min(nearest, glm::length(p - from - edge * t));
  }
  return nearest;
}

class PinchSearch {
 public:
  PinchSearch(Tracer& tracer, const Scene& scene, float width, std::span<const Ray> rays,
              std::span<const Hit> hits, std::vector<Pinch>& pinches)
      : tracer_(tracer), scene_(scene), width_(width), rays_(rays), hits_(hits), pinches_(pinches) {}

  uint64_t run() {
    pinches_.assign(rays_.size(), {});
    std::vector<Look> left;
    for (uint32_t i = 0; i < rays_.size(); ++i) {
      if (hits_[i].triangle != kNoTriangle) left.push_back(lookAcross(i, direction(i)));
    }
    for (size_t k = 0; k < kDirections && !left.empty(); ++k) {
      const auto flanks = flanksAlong(k, left);
      std::vector<Look> in_walls;
      for (size_t n = 0; n < left.size(); ++n) {
        if (flanks[n]) in_walls.push_back(lookAcross(left[n].ray, normal(flanks[n]->nearer().triangle)));
      }
      pinchIn(std::move(in_walls));
      std::erase_if(left, [&](const Look& look) { return pinches_[look.ray].pinched; });
    }
    return traced_;
  }

 private:
  glm::dvec3 direction(uint32_t ray) const { return glm::dvec3(vec3(rays_[ray].direction)); }

  glm::dvec3 normal(uint32_t triangle) const {
    const auto c = scene_.corners(triangle);
    return glm::cross(glm::dvec3(c[1]) - glm::dvec3(c[0]), glm::dvec3(c[2]) - glm::dvec3(c[0]));
  }

  bool stops(uint32_t ray, const Hit& hit) const {
    const double depth = kDepth * width_ / glm::length(direction(ray));
    return hit.triangle != kNoTriangle && double(hit.t) < double(hits_[ray].t) * kRounded - depth;
  }

  Ray neighbour(const Look& look, size_t k, double side) const {
    const glm::dvec3 move = (look.u * kCos[k] + look.v * kSin[k]) * (side * kReach * width_);
    Ray moved = rays_[look.ray];
    for (int axis = 0; axis < 3; ++axis) {
      moved.origin[axis] = float(double(moved.origin[axis]) + move[axis]);
    }
    return moved;
  }

  void trace() {
    side_hits_.resize(side_rays_.size());
    tracer_.traceRays(side_rays_, side_hits_);
    traced_ += side_rays_.size();
  }

  glm::dvec3 place(size_t i) const {
    return glm::dvec3(vec3(side_rays_[i].origin)) +
           glm::dvec3(vec3(side_rays_[i].direction)) * double(side_hits_[i].t);
  }

  /// Of each look, what stops both of its neighbours along its k-th direction, if they are.
  std::vector<std::optional<Flanks>> flanksAlong(size_t k, const std::vector<Look>& looks) {
    std::vector<std::optional<Flanks>> flanks(looks.size());
    side_rays_.clear();
    for (const Look& look : looks) side_rays_.push_back(neighbour(look, k, 1));
    trace();
    std::vector<size_t> stopped;
    for (size_t n = 0; n < looks.size(); ++n) {
      if (!stops(looks[n].ray, side_hits_[n])) continue;
      stopped.push_back(n);
      flanks[n] = Flanks{{side_hits_[n], {}}, {place(n), {}}};
    }
    side_rays_.clear();
    for (const size_t n : stopped) side_rays_.push_back(neighbour(looks[n], k, -1));
    trace();
    for (size_t s = 0; s < stopped.size(); ++s) {
      std::optional<Flanks>& both = flanks[stopped[s]];
      if (stops(looks[stopped[s]].ray, side_hits_[s])) {
        both->hits[1] = side_hits_[s];
        both->places[1] = place(s);
      } else {
        both.reset();
      }
    }
    return flanks;
  }

  /// Looks in the planes of walls beside the rays.
  void pinchIn(std::vector<Look> left) {
    for (size_t k = 0; k < kDirections && !left.empty(); ++k) {
      const auto flanks = flanksAlong(k, left);
      for (size_t n = 0; n < left.size(); ++n) {
        if (!flanks[n] || !facesAcross(*flanks[n])) continue;
        pinches_[left[n].ray] = {true, flanks[n]->nearer(),
                                 vec3((flanks[n]->places[0] + flanks[n]->places[1]) * 0.5)};
      }
      std::erase_if(left, [&](const Look& look) { return pinches_[look.ray].pinched; });
    }
  }

  /// Whether what stops the neighbours is so near to each other that they are the rims of a gap.
  bool facesAcross(const Flanks& flanks) const {
    const double most = kAcross * kReach * width_;
    return distanceTo(scene_.corners(flanks.hits[0].triangle), flanks.places[1]) <= most ||
           distanceTo(scene_.corners(flanks.hits[1].triangle), flanks.places[0]) <= most;
  }

  Tracer& tracer_;
  const Scene& scene_;
  double width_;
  std::span<const Ray> rays_;
  std::span<const Hit> hits_;
  std::vector<Pinch>& pinches_;
  uint64_t traced_ = 0;
  std::vector<Ray> side_rays_;
  std::vector<Hit> side_hits_;
};

}  // namespace

uint64_t findPinched(Tracer& tracer, const Scene& scene, float width, std::span<const Ray> rays,
                     std::span<const Hit> hits, std::vector<Pinch>& pinches) {
  return PinchSearch(tracer, scene, width, rays, hits, pinches).run();
}

}  // namespace sightline
