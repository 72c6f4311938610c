#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <tuple>
#include <utility>

#include "core/shared/camera.h"

namespace sightline {

/// A corner on its way into the image: homogeneous, and its shares of the triangle's second and third corner.
struct RasterCorner {
  double x, y, w, share_b, share_c;
};

/// A pixel that a triangle covers.
struct RasterPixel {
  uint32_t x, y;
  float depth;
  float share_b, share_c;  ///< of the triangle's second and third corner, in space
  bool front;              ///< counter-clockwise as it is seen
};

namespace raster {

/// Where there is enough room beyond the image that what is cut off there has no pixel in it.
constexpr double kGuardBand = 4;
constexpr int64_t kSubpixels = 256;

/// At most a triangle cut by five planes.
struct Polygon {
  std::array<RasterCorner, 8> corners;
  int count = 0;
};

/// Keeps what has a value of at least 0. Cuts an edge at the same place whichever way it runs.
template <typename Value>
void cutOff(Polygon& polygon, Value&& value) {
  Polygon kept;
  for (int i = 0; i < polygon.count; ++i) {
    const RasterCorner &a = polygon.corners[i], &b = polygon.corners[(i + 1) % polygon.count];
    const double at_a = value(a), at_b = value(b);
    if (at_a >= 0) kept.corners[kept.count++] = a;
    if ((at_a >= 0) == (at_b >= 0)) continue;
    const auto& [in, out, at_in, at_out] =
        at_a >= 0 ? std::tuple(a, b, at_a, at_b) : std::tuple(b, a, at_b, at_a);
    const double t = at_in / (at_in - at_out);
    kept.corners[kept.count++] = {in.x + (out.x - in.x) * t, in.y + (out.y - in.y) * t,
                                  in.w + (out.w - in.w) * t, in.share_b + (out.share_b - in.share_b) * t,
                                  in.share_c + (out.share_c - in.share_c) * t};
  }
  polygon = kept;
}

struct Snapped {
  int64_t x, y;
  double depth, share_b, share_c;  ///< shares times depth: linear in the image
};

/// Twice the area, positive where a, b, c run clockwise in the image (y down).
inline int64_t area(const Snapped& a, const Snapped& b, int64_t x, int64_t y) {
  return (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
}

/// With y down and a clockwise triangle: its top and its left edges hold what lies on them.
inline bool holdsEdge(const Snapped& a, const Snapped& b) {
  return b.y < a.y || (b.y == a.y && b.x > a.x);
}

template <typename Visit>
bool fill(const Camera& camera, Snapped a, Snapped b, Snapped c, Visit&& visit) {
  int64_t whole = area(a, b, c.x, c.y);
  if (whole == 0) return true;
  const bool front = whole < 0;
  if (whole < 0) {
    std::swap(b, c);
    whole = -whole;
  }
  const auto firstPixel = [](int64_t low) { return (low + kSubpixels / 2 - 1) >> 8; };  // middle at or beyond
  const auto lastPixel = [](int64_t high) { return (high - kSubpixels / 2) >> 8; };
  const int64_t x0 = std::max<int64_t>(0, firstPixel(std::min({a.x, b.x, c.x})));
  const int64_t x1 = std::min<int64_t>(int64_t{camera.size.x} - 1, lastPixel(std::max({a.x, b.x, c.x})));
  const int64_t y0 = std::max<int64_t>(0, firstPixel(std::min({a.y, b.y, c.y})));
  const int64_t y1 = std::min<int64_t>(int64_t{camera.size.y} - 1, lastPixel(std::max({a.y, b.y, c.y})));
  const int64_t least_a = holdsEdge(b, c) ? 0 : 1, least_b = holdsEdge(c, a) ? 0 : 1,
                least_c = holdsEdge(a, b) ? 0 : 1;
  for (int64_t y = y0; y <= y1; ++y) {
    for (int64_t x = x0; x <= x1; ++x) {
      const int64_t px = x * kSubpixels + kSubpixels / 2, py = y * kSubpixels + kSubpixels / 2;
      const int64_t at_a = area(b, c, px, py), at_b = area(c, a, px, py), at_c = area(a, b, px, py);
      if (at_a < least_a || at_b < least_b || at_c < least_c) continue;
      const double of_a = double(at_a) / double(whole), of_b = double(at_b) / double(whole),
                   of_c = double(at_c) / double(whole);
      const double depth = (of_a * a.depth + of_b * b.depth) + of_c * c.depth;
      const double share_b = ((of_a * a.share_b + of_b * b.share_b) + of_c * c.share_b) / depth;
      const double share_c = ((of_a * a.share_c + of_b * b.share_c) + of_c * c.share_c) / depth;
      if (!visit(
              RasterPixel{uint32_t(x), uint32_t(y), float(depth), float(share_b), float(share_c), front})) {
        return false;
      }
    }
  }
  return true;
}

}  // namespace raster

/// Calls visit(RasterPixel) for the pixels that a triangle covers until it returns false. Pixels of a
/// triangle that is cut at the near plane may come twice, on the lines that divide what is left.
template <typename Visit>
void rasterTriangle(const Camera& camera, const std::array<glm::vec3, 3>& corners, Visit&& visit) {
  raster::Polygon polygon;
  for (int i = 0; i < 3; ++i) {
    const vec4 p = clipPosition(camera, corners[i]);
    polygon.corners[polygon.count++] = {p.x, p.y, p.w, i == 1 ? 1.0 : 0.0, i == 2 ? 1.0 : 0.0};
  }
  const double near = camera.eye.w;
  raster::cutOff(polygon, [&](const RasterCorner& c) { return c.w - near; });
  raster::cutOff(polygon, [&](const RasterCorner& c) { return raster::kGuardBand * c.w - c.x; });
  raster::cutOff(polygon, [&](const RasterCorner& c) { return raster::kGuardBand * c.w + c.x; });
  raster::cutOff(polygon, [&](const RasterCorner& c) { return raster::kGuardBand * c.w - c.y; });
  raster::cutOff(polygon, [&](const RasterCorner& c) { return raster::kGuardBand * c.w + c.y; });
  std::array<raster::Snapped, 8> snapped;
  for (int i = 0; i < polygon.count; ++i) {
    const RasterCorner& c = polygon.corners[i];
    const auto snap = [&](double at, uint32_t size) {
      return int64_t(std::floor((at / c.w + 1) * (0.5 * raster::kSubpixels) * size + 0.5));
    };
    const double depth = near / c.w;
    snapped[i] = {snap(c.x, camera.size.x), snap(c.y, camera.size.y), depth, c.share_b * depth,
                  c.share_c * depth};
  }
  for (int i = 2; i < polygon.count; ++i) {
    if (!raster::fill(camera, snapped[0], snapped[i - 1], snapped[i], visit)) return;
  }
}

}  // namespace sightline
