#include "core/picture/outside_camera.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/picture/shading.h"

namespace sightline {
namespace {

constexpr double kTanHalfHeight = 0.27;  ///< a long lens (30 degrees) keeps walls upright
constexpr double kOutlierShare =
    0.02;                         ///< of the PVS's corners on each side, that need not be in the picture
constexpr double kMargin = 1.06;  ///< room around what must be in the picture
constexpr uint32_t kTrialWidth = 96, kTrialHeight = 72;  ///< samples that compare the sides
constexpr uint32_t kCeilingGrid = 5;                     ///< rays up, along each side of the cell
constexpr float kBelowCeiling = 0.9f;  ///< where to cut, share of the way from the cell's top to the ceiling

struct Box {
  glm::dvec3 low{0}, high{0};
};

Box cellBox(const ViewCell& cell) {
  const std::vector<glm::vec3> corners = cellCorners(cell);
  Box box{corners.front(), corners.front()};
  for (const glm::vec3& corner : corners) {
    box.low = glm::min(box.low, glm::dvec3(corner));
    box.high = glm::max(box.high, glm::dvec3(corner));
  }
  return box;
}

/// The cell and the PVS without its outliers: one triangle at the horizon must not make all else tiny.
Box focusBox(const Scene& scene, const CellPvs& pvs) {
  Box box = cellBox(pvs.cell);
  if (pvs.triangles.empty()) {
    const Bounds all = sceneBounds(scene);
    return {glm::min(box.low, glm::dvec3(all.low)), glm::max(box.high, glm::dvec3(all.high))};
  }
  std::vector<float> places(3 * pvs.triangles.size());
  const auto skip = std::ptrdiff_t(double(places.size()) * kOutlierShare);
  for (int axis = 0; axis < 3; ++axis) {
    for (size_t i = 0; i < places.size(); ++i) {
      places[i] = scene.corners(pvs.triangles[i / 3])[i % 3][axis];
    }
    const auto low = places.begin() + skip, high = places.end() - 1 - skip;
    std::nth_element(places.begin(), low, places.end());
    box.low[axis] = std::min(box.low[axis], double(*low));
    std::nth_element(places.begin(), high, places.end());
    box.high[axis] = std::max(box.high[axis], double(*high));
  }
  return box;
}

/// Just below the ceiling, if more than half of the rays upwards from the cell's top meet one.
std::optional<float> ceilingCut(const TraceRays& trace, const Box& cell) {
  std::vector<Ray> rays;
  for (uint32_t i = 0; i < kCeilingGrid * kCeilingGrid; ++i) {
    const double u = (i % kCeilingGrid + 0.5) / kCeilingGrid,
                 v = (double(i / kCeilingGrid) + 0.5) / kCeilingGrid;
    const glm::dvec3 from(glm::mix(cell.low.x, cell.high.x, u), cell.high.y,
                          glm::mix(cell.low.z, cell.high.z, v));
    rays.push_back(makeRay(from, {0, 1, 0}));
  }
  std::vector<Hit> hits(rays.size());
  trace(rays, hits);
  std::vector<float> ceilings;
  for (const Hit& hit : hits) {
    if (hit.triangle != kNoTriangle) ceilings.push_back(hit.t);
  }
  if (ceilings.size() * 2 <= rays.size()) return std::nullopt;
  std::sort(ceilings.begin(), ceilings.end());
  return float(cell.high.y) + kBelowCeiling * ceilings[ceilings.size() / 4];
}

PictureCamera lookAt(const Box& box, double azimuth, double elevation, double aspect) {
  PictureCamera camera;
  camera.tan_y = kTanHalfHeight;
  camera.tan_x = kTanHalfHeight * aspect;
  camera.forward = -glm::dvec3(std::cos(elevation) * std::sin(azimuth), std::sin(elevation),
                               std::cos(elevation) * std::cos(azimuth));
  camera.right = glm::normalize(glm::cross(camera.forward, glm::dvec3(0, 1, 0)));
  camera.up = glm::cross(camera.right, camera.forward);
  const glm::dvec3 center = (box.low + box.high) * 0.5;
  double distance = 0;
  for (int i = 0; i < 8; ++i) {
    const glm::dvec3 corner((i & 1) != 0 ? box.high.x : box.low.x, (i & 2) != 0 ? box.high.y : box.low.y,
                            (i & 4) != 0 ? box.high.z : box.low.z);
    const glm::dvec3 offset = corner - center;
    const double needed = std::max(std::abs(glm::dot(offset, camera.right)) / camera.tan_x,
                                   std::abs(glm::dot(offset, camera.up)) / camera.tan_y);
    distance = std::max(distance, needed * kMargin - glm::dot(offset, camera.forward));
  }
  camera.position = center - camera.forward * distance;
  return camera;
}

/// Green samples of a coarse picture; a camera that sees the cell's centre counts half as much again.
double scoreCamera(const TraceRays& trace, const PictureCamera& camera,
                   const std::optional<float>& cut_height, const glm::dvec3& cell_center,
                   std::span<const uint8_t> member) {
  std::vector<Ray> rays;
  for (uint32_t i = 0; i < kTrialWidth * kTrialHeight; ++i) {
    const double x = (i % kTrialWidth + 0.5) / kTrialWidth,
                 y = (double(i / kTrialWidth) + 0.5) / kTrialHeight;
    rays.push_back(cutRay(camera.position, camera.direction(x, y), cut_height));
  }
  Ray to_cell = cutRay(camera.position, cell_center - camera.position, cut_height);
  to_cell.direction = glm::vec4(glm::vec3(cell_center) - glm::vec3(to_cell.origin), 0);
  rays.push_back(to_cell);
  std::vector<Hit> hits(rays.size());
  trace(rays, hits);
  const bool cell_hidden = hits.back().triangle != kNoTriangle && hits.back().t < 0.98f;
  hits.pop_back();
  double green = 0;
  for (const Hit& hit : hits) green += hit.triangle != kNoTriangle && member[hit.triangle] != 0 ? 1 : 0;
  return cell_hidden ? green : 1.5 * green;
}

}  // namespace

glm::dvec3 PictureCamera::direction(double x, double y) const {
  return forward + right * ((2 * x - 1) * tan_x) + up * ((1 - 2 * y) * tan_y);
}

glm::dvec3 PictureCamera::project(const glm::dvec3& point) const {
  const glm::dvec3 offset = point - position;
  const double depth = glm::dot(offset, forward);
  return {0.5 + 0.5 * glm::dot(offset, right) / (depth * tan_x),
          0.5 - 0.5 * glm::dot(offset, up) / (depth * tan_y), depth};
}

Ray cutRay(const glm::dvec3& origin, const glm::dvec3& direction, const std::optional<float>& cut_height) {
  if (!cut_height || origin.y <= *cut_height) return makeRay(origin, direction);
  if (direction.y >= 0) return makeRay(origin, {});
  return makeRay(origin + direction * ((*cut_height - origin.y) / direction.y), direction);
}

OutsideView placeWholeView(const Bounds& bounds, const PictureOptions& options) {
  constexpr double kAzimuth = 0.6 * std::numbers::pi / 4, kElevation = 38 * std::numbers::pi / 180;
  const Box box{glm::dvec3(bounds.low), glm::dvec3(bounds.high)};
  return {lookAt(box, kAzimuth, kElevation, double(options.width) / options.height), std::nullopt};
}

OutsideView placeOutsideView(const TraceRays& trace, const Scene& scene, const CellPvs& pvs,
                             std::span<const uint8_t> member, const PictureOptions& options) {
  OutsideView view;
  if (options.cut == CutMode::kHeight) view.cut_height = options.cut_height;
  if (options.cut == CutMode::kAuto) view.cut_height = ceilingCut(trace, cellBox(pvs.cell));
  Box box = focusBox(scene, pvs);
  if (view.cut_height) {
    box.high.y = std::min(box.high.y, double(*view.cut_height));
    box.low.y = std::min(box.low.y, box.high.y);
  }
  // A cut level is a floor plan: look at it more steeply. In the open, facades count.
  const std::array<double, 2> elevations = view.cut_height ? std::array{58.0, 70.0} : std::array{38.0, 55.0};
  const double aspect = double(options.width) / options.height;
  double best = -1;
  for (const double elevation : elevations) {
    for (int side = 0; side < 8; ++side) {
      const double azimuth = (side + 0.6) * std::numbers::pi / 4;  // not along the axes of a city
      const PictureCamera camera = lookAt(box, azimuth, elevation * std::numbers::pi / 180, aspect);
      const double score = scoreCamera(trace, camera, view.cut_height, pvs.cell.center, member);
      if (score > best * 1.15) {  // the first of similar ones: the lower elevation
        best = score;
        view.camera = camera;
      }
    }
  }
  return view;
}

}  // namespace sightline
