#include "core/sampling/views.h"

#include <algorithm>
#include <cmath>

#include "core/base/splitmix.h"
#include "core/cell/rotation.h"
#include "core/shared/halton.h"

namespace sightline {
namespace {

/// Keeps the shifts apart from those of a bake with the same seed.
constexpr uint64_t kViewsKey = 0x7669657773;  // "views"

vec4 rounded(const glm::dvec3& v) {
  return {glm::vec3(v + 0.0), 0.0f};
}

/// From the axis of the sphere (y, so that the poles are straight up and down) and around it.
glm::dvec3 onSphere(double height, double turn) {
  const double y = 1 - 2 * height, radius = std::sqrt(std::max(0.0, 1 - y * y));
  const CosSin around = cosSinDegrees(360 * turn);
  return {radius * around.cosine, y, radius * around.sine};
}

}  // namespace

CellViews::CellViews(const ViewCell& cell, double fov)
    : faces_(cellFaces(cell)), flat_(cell.flat()), tangent_(tanDegrees(fov / 2)) {
  double sum = 0;
  for (const Face& face : faces_) {
    sum += glm::length(glm::dvec3(face.edge_u)) * glm::length(glm::dvec3(face.edge_v));
    areas_.push_back(sum);
  }
}

ViewFrame CellViews::at(const std::array<double, 4>& place) const {
  // The faces side by side: place[0] chooses the face and the place along one of its edges.
  const double along = place[0] * areas_.back();
  const auto upper = std::upper_bound(areas_.begin(), areas_.end(), along);
  const size_t f = std::min(size_t(upper - areas_.begin()), faces_.size() - 1);
  const double before = f == 0 ? 0 : areas_[f - 1];
  const double u = std::clamp((along - before) / (areas_[f] - before), 0.0, 1.0);
  const Face& face = faces_[f];
  const glm::dvec3 origin =
      glm::dvec3(face.corner) + u * glm::dvec3(face.edge_u) + place[1] * glm::dvec3(face.edge_v);
  if (flat_) {
    return {rounded(origin), face.normal, rounded(-tangent_ * glm::dvec3(face.axis_u)),
            rounded(tangent_ * glm::dvec3(face.axis_v))};
  }
  const glm::dvec3 forward = onSphere(place[2], place[3]);
  const bool steep = std::abs(forward.y) > 0.999;
  const glm::dvec3 right =
      glm::normalize(glm::cross(forward, steep ? glm::dvec3(0, 0, 1) : glm::dvec3(0, 1, 0)));
  return {rounded(origin), rounded(forward), rounded(tangent_ * right),
          rounded(tangent_ * glm::cross(right, forward))};
}

std::vector<ViewFrame> measureViews(const ViewCell& cell, uint32_t cell_index, uint32_t count, uint64_t seed,
                                    double fov) {
  const CellViews views(cell, fov);
  const uint64_t key = splitmix(splitmix(splitmix(seed) ^ cell_index) ^ kViewsKey);
  const auto shift = [&](uint32_t base, uint64_t period) { return uint32_t(splitmix(key ^ base) % period); };
  const uint32_t shift2 = shift(2, uint64_t(1) << 32), shift3 = shift(3, kHaltonPeriod3),
                 shift5 = shift(5, kHaltonPeriod5), shift7 = shift(7, kHaltonPeriod7);
  std::vector<ViewFrame> frames;
  frames.reserve(count);
  for (uint64_t i = 0; i < count; ++i) {
    // The middles of the steps that 24 bits make.
    frames.push_back(views.at({(halton2(i, shift2) + 0.5) * 0x1p-24, (halton3(i, shift3) + 0.5) * 0x1p-24,
                               (halton5(i, shift5) + 0.5) * 0x1p-24, (halton7(i, shift7) + 0.5) * 0x1p-24}));
  }
  return frames;
}

}  // namespace sightline
