#include "core/verify/cell_sight.h"

#include <algorithm>
#include <cmath>

namespace sightline {
namespace {

/// Rounding of an origin corner + u * edge_u + v * edge_v, a component, as a share of the largest such
/// coordinate L of the cell. In 2^-24 L: 1 for the corner, 2 for the two edges, which together reach no
/// farther than 2 L, 2 for their products, 2 for the sums; as many again where a ray's origin is found as a
/// point on the face (gvs_reverse.h).
constexpr double kOriginRounding = 0x1p-20;
/// Rounding of a direction and of a face's axes, a share of the direction: components err by some 4 * 2^-24
/// of what they are the sum of.
constexpr double kDirectionRounding = 0x1p-20;
/// Rounding of a hit, a share of the distance: the 16 float steps of RoundingLimit. What a ray meets behind
/// the plane by less than that is left to its witness, which cannot meet it exactly.
constexpr double kHitRounding = 0x1p-20;

double sum(const glm::dvec3& v) {
  return v.x + v.y + v.z;
}

}  // namespace

std::string faultName(Fault fault) {
  constexpr const char* kNames[] = {"none", "behind", "no_ray", "off_cell", "backwards", "not_met", "apart"};
  return kNames[size_t(fault)];
}

std::string faultText(Fault fault) {
  constexpr const char* kTexts[] = {"nothing is wrong",
                                    "it lies behind the flat cell's plane",
                                    "it has no ray",
                                    "its ray begins off the cell",
                                    "its ray leaves the flat cell backwards",
                                    "its ray does not meet it first",
                                    "it does not meet the cell"};
  return kTexts[size_t(fault)];
}

CellSight::CellSight(const ViewCell& cell) : frame_(cellFrame(cell)), flat_(cell.flat()) {
  glm::dvec3 largest(0.0);
  for (const glm::vec3& corner : cellCorners(cell)) largest = glm::max(largest, glm::abs(glm::dvec3(corner)));
  for (int i = 0; i < 3; ++i) slack_[i] = kOriginRounding * glm::dot(glm::abs(frame_.axes[i]), largest);
  // Along an axis of the world nothing is summed, so nothing is tilted. Elsewhere the other axes' components
  // there, whose roundings count, are no larger than the normal's other components together.
  const glm::dvec3 normal = glm::abs(frame_.axes[2]);
  tilt_ = kDirectionRounding * (sum(normal) - maxAbs(normal));
}

bool CellSight::beginsOnCell(const glm::dvec3& origin) const {
  return glm::all(glm::lessThanEqual(glm::abs(frame_.toLocal(origin)), frame_.half_size + slack_));
}

bool CellSight::looksAlong(const glm::dvec3& direction) const {
  if (!flat_) return true;
  return glm::dot(frame_.axes[2], direction) > -tilt_ * maxAbs(direction);
}

bool CellSight::isBehind(const JudgeTriangle& triangle) const {
  if (!flat_) return false;
  const auto behind = [&](const glm::dvec3& corner) {
    const double farthest = maxAbs(corner - frame_.center) + glm::length(frame_.half_size);
    return frame_.toLocal(corner).z < -(slack_.z + (tilt_ + kHitRounding) * farthest);
  };
  return behind(triangle.a) && behind(triangle.b) && behind(triangle.c);
}

Fault CellSight::faultOf(const JudgeTriangle& triangle, const Witness& witness) const {
  if (isBehind(triangle)) return Fault::kBehind;
  if (witness.stage == kStageContained) return Fault::kNone;
  const glm::dvec3 origin(witness.origin), direction(witness.direction);
  if (direction == glm::dvec3(0.0) || !std::isfinite(sum(origin) + sum(direction))) return Fault::kNoRay;
  if (!beginsOnCell(origin)) return Fault::kOffCell;
  return looksAlong(direction) ? Fault::kNone : Fault::kBackwards;
}

}  // namespace sightline
