#include "core/bound/cell_hull.h"

#include <algorithm>
#include <cmath>

#include "core/cell/cell_contains.h"
#include "core/cell/cell_frame.h"

namespace sightline {
namespace {

/// What a handful of products and sums of doubles is off by, as a share of the largest operand: 2^-53 each.
constexpr double kRounding = 0x1p-46;

double largest(const glm::dvec3& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

bool isAlongAxes(const std::array<glm::dvec3, 3>& axes) {
  for (const glm::dvec3& axis : axes) {
    if ((axis.x != 0) + (axis.y != 0) + (axis.z != 0) != 1) return false;
  }
  return true;
}

}  // namespace

CellHull::CellHull(const ViewCell& cell, const Lattice& lattice) : flat_(cell.flat()) {
  const CellFrame frame = cellFrame(cell);
  const double scale = std::ldexp(1.0, -lattice.exponent);
  middle_ = frame.center * scale;
  half_size_ = (frame.half_size + roundingOfFaces(cell, frame)) * scale;
  slack_ = (largest(middle_) + largest(half_size_)) * kRounding;
  half_size_ += slack_;
  for (int i = 0; i < 3; ++i) axes_[size_t(i)] = frame.axes[i];
  setCorners();
}

std::array<CellHull, 2> CellHull::halves() const {
  int longest = 0;
  for (int i = 1; i < 3; ++i) {
    if (half_size_[i] > half_size_[longest]) longest = i;
  }
  std::array<CellHull, 2> parts{*this, *this};
  for (const int i : {0, 1}) {
    CellHull& part = parts[size_t(i)];
    part.half_size_[longest] = 0.5 * half_size_[longest] + slack_;
    part.middle_ += axes_[size_t(longest)] * ((i == 0 ? -0.5 : 0.5) * half_size_[longest]);
    part.setCorners();
  }
  return parts;
}

void CellHull::setCorners() {
  std::array<glm::dvec3, 8> corners;
  for (int i = 0; i < 8; ++i) {
    const glm::dvec3 sign((i & 1) != 0 ? 1.0 : -1.0, (i & 2) != 0 ? 1.0 : -1.0, (i & 4) != 0 ? 1.0 : -1.0);
    const glm::dvec3 local = sign * half_size_;
    corners[size_t(i)] = middle_ + (axes_[0] * local.x + axes_[1] * local.y + axes_[2] * local.z);
  }
  box_ = {corners[0], corners[0]};
  for (const glm::dvec3& corner : corners) {
    box_.low = glm::min(box_.low, corner);
    box_.high = glm::max(box_.high, corner);
  }
  const bool along = isAlongAxes(axes_);
  end_count_ = along ? 2 : 8;
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (int i = 0; i < end_count_; ++i) {
      const glm::dvec3& c = corners[size_t(i)];
      End& end = ends_[size_t(axis)][size_t(i)];
      end = along ? End{i == 0 ? box_.low[axis] : box_.high[axis],
                        {box_.low[u], box_.high[u], box_.low[v], box_.high[v]}}
                  : End{c[axis], {c[u], c[u], c[v], c[v]}};
    }
  }
}

PlaneRect CellHull::crossing(const RealBox& to, int axis, double at) const {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  PlaneRect rect{HUGE_VAL, -HUGE_VAL, HUGE_VAL, -HUGE_VAL};
  for (int i = 0; i < end_count_; ++i) {
    const End& end = ends_[size_t(axis)][size_t(i)];
    for (const double far : {to.low[axis], to.high[axis]}) {
      const double t = (at - end.at) / (far - end.at);
      rect.low_u = std::min(rect.low_u, end.rect.low_u + t * (to.low[u] - end.rect.low_u));
      rect.high_u = std::max(rect.high_u, end.rect.high_u + t * (to.high[u] - end.rect.high_u));
      rect.low_v = std::min(rect.low_v, end.rect.low_v + t * (to.low[v] - end.rect.low_v));
      rect.high_v = std::max(rect.high_v, end.rect.high_v + t * (to.high[v] - end.rect.high_v));
    }
  }
  const double slack = slack_ + std::max(largest(to.low), largest(to.high)) * kRounding;
  return {rect.low_u - slack, rect.high_u + slack, rect.low_v - slack, rect.high_v + slack};
}

bool CellHull::isBehind(const RealBox& box) const {
  if (!flat_) return false;
  // The corner that is farthest along the cell's z.
  const glm::dvec3& normal = axes_[2];
  glm::dvec3 corner;
  for (int i = 0; i < 3; ++i) corner[i] = normal[i] > 0 ? box.high[i] : box.low[i];
  const double slack = 4 * slack_ + std::max(largest(box.low), largest(box.high)) * kRounding;
  return glm::dot(corner - middle_, normal) < -(half_size_.z + slack);
}

bool CellHull::mayMeet(const RealBox& box) const {
  if (glm::any(glm::greaterThan(box.low, box_.high)) || glm::any(glm::lessThan(box.high, box_.low)))
    return false;
  const glm::dvec3 middle = 0.5 * (box.low + box.high), half = 0.5 * (box.high - box.low);
  const double slack = 4 * slack_ + std::max(largest(box.low), largest(box.high)) * kRounding;
  for (int i = 0; i < 3; ++i) {
    const glm::dvec3& axis = axes_[size_t(i)];
    const double distance = std::abs(glm::dot(middle - middle_, axis));
    if (distance > half_size_[i] + glm::dot(half, glm::abs(axis)) + slack) return false;
  }
  return true;
}

}  // namespace sightline
