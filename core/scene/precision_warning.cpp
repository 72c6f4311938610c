#include "core/scene/precision_warning.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/scene/largest.h"
#include "core/scene/triangle_area.h"

namespace sightline {
namespace {

/// Triangles that the median edge is taken from, evenly spread over the scene.
constexpr size_t kMedianTriangles = 1 << 18;

/// Coarser steps, in edges, bend what one sees of a triangle.
constexpr double kCoarse = 1e-3;

/// A scene counts as far off if it could have steps so many times finer around the origin. (Less is gained by
/// moving those that merely start there.)
constexpr double kFar = 4.0;

/// Triangles lower than this share of their longest edge, or of the median edge, are no loss: files of six
/// digits have such slivers wherever three vertices should lie in a row.
constexpr double kSliver = 0x1p-16;

/// From one float to the next larger.
double stepAt(double coordinate) {
  const float at = float(coordinate);
  return double(std::nextafter(at, std::numeric_limits<float>::infinity())) - double(at);
}

/// Triangles that are no more what the file has.
struct Loss {
  uint64_t collapsed = 0;  ///< without area
  uint64_t turned = 0;     ///< by more than 30 degrees
};

class Positions {
 public:
  Positions(const Scene& scene, std::span<const glm::vec3> remainders)
      : scene_(scene), remainders_(remainders) {}

  /// A corner as the file has it.
  glm::dvec3 corner(size_t triangle, int corner) const {
    const uint32_t vertex = scene_.vertexNumbers(uint32_t(triangle))[corner];
    const glm::dvec3 position(scene_.corners(uint32_t(triangle))[size_t(corner)]);
    return vertex < remainders_.size() ? position + glm::dvec3(remainders_[vertex]) : position;
  }

  double edge(size_t triangle, int from) const {
    return glm::length(corner(triangle, (from + 1) % 3) - corner(triangle, from));
  }

  /// Of all edges longer than 0; 0 if there is none.
  double medianEdge() const {
    std::vector<double> edges;
    const size_t step = 1 + scene_.triangleCount() / kMedianTriangles;
    for (size_t i = 0; i < scene_.triangleCount(); i += step) {
      for (int from = 0; from < 3; ++from) edges.push_back(edge(i, from));
    }
    std::erase(edges, 0.0);
    if (edges.empty()) return 0.0;
    const auto middle = edges.begin() + std::ptrdiff_t(edges.size() / 2);
    std::nth_element(edges.begin(), middle, edges.end());
    return *middle;
  }

  /// Of triangles that have a shape in the file. Without `all`, looks no further than at those without area.
  Loss loss(double median_edge, bool all) const {
    Loss loss;
    if (remainders_.empty() || (!all && scene_.degenerate_triangles == 0)) return loss;
    for (size_t i = 0; i < scene_.triangleCount(); ++i) {
      const auto t = scene_.corners(uint32_t(i));
      const bool flat = hasZeroArea(t[0], t[1], t[2]);
      if ((!flat && !all) || !hasShape(i, median_edge)) continue;
      loss.collapsed += flat ? 1 : 0;
      loss.turned += !flat && isTurned(i) ? 1 : 0;
    }
    return loss;
  }

 private:
  static glm::dvec3 normal(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    return glm::cross(b - a, c - a);
  }

  glm::dvec3 normal(size_t triangle) const {
    return normal(corner(triangle, 0), corner(triangle, 1), corner(triangle, 2));
  }

  bool hasShape(size_t triangle, double median_edge) const {
    const double longest = largest({edge(triangle, 0), edge(triangle, 1), edge(triangle, 2)});
    return glm::length(normal(triangle)) > kSliver * longest * std::max(longest, median_edge);
  }

  bool isTurned(size_t triangle) const {
    constexpr double kCosine = 0.8660254037844386;  // of 30 degrees
    const auto t = scene_.corners(uint32_t(triangle));
    const glm::dvec3 now = normal(t[0], t[1], t[2]);
    const glm::dvec3 was = normal(triangle);
    return glm::dot(now, was) < kCosine * glm::length(now) * glm::length(was);
  }

  const Scene& scene_;
  std::span<const glm::vec3> remainders_;
};

/// The middle of the scene in a round number: at most a tenth of its size off, whole if the scene is not
/// tiny.
std::string roundMiddle(const glm::dvec3& middle, double size) {
  double unit = 1.0;
  while (unit > size) unit /= 10.0;
  while (unit * 100.0 < size) unit *= 10.0;
  const glm::dvec3 offset = glm::round(middle / unit) * unit + 0.0;
  return fmt::format("({:.10g}, {:.10g}, {:.10g})", offset.x, offset.y, offset.z);
}

}  // namespace

std::string precisionWarning(const Scene& scene, std::span<const glm::vec3> remainders) {
  const Bounds bounds = sceneBounds(scene);
  const glm::dvec3 low(bounds.low), high(bounds.high);
  const double reach = largest(glm::max(glm::abs(low), glm::abs(high)));
  const double size = largest(high - low);
  const double step = stepAt(reach);
  const Positions positions(scene, remainders);
  const double median_edge = positions.medianEdge();
  if (median_edge == 0.0) return {};
  const bool is_far = step >= kFar * stepAt(size / 2);
  const bool bends = is_far && step > kCoarse * median_edge;
  const Loss loss = positions.loss(median_edge, bends);
  if (!bends && loss.collapsed == 0) return {};
  const std::string cure =
      is_far ? fmt::format("move the scene to the origin before: subtract {}",
                           roundMiddle((low + high) / 2.0, std::max(size, step)))
             : "the scene is too wide for its detail: cut it into parts, and move each to the origin";
  return fmt::format(
      "single precision steps by {:.3g} at coordinates of {:.10g}, and the median edge is {:.3g}; of {} "
      "triangles "
      "{} lose their area by that and {} turn by more than 30 degrees; {}",
      step, reach, median_edge, scene.triangleCount(), loss.collapsed, loss.turned, cure);
}

}  // namespace sightline
