#include "core/scene/precision_warning.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/scene/largest.h"
#include "core/scene/median_edge.h"
#include "core/scene/triangle_area.h"

namespace sightline {
namespace {

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

/// A power of ten: about a hundredth to a tenth of the size, but at least 1.
double roundUnit(double size) {
  double unit = 1.0;
  while (unit * 100.0 < size) unit *= 10.0;
  return unit;
}

/// Where the scene lies, and how fine floats are there and could be.
struct Extent {
  explicit Extent(const Bounds& bounds)
      : low(bounds.low),
        high(bounds.high),
        reach(glm::max(glm::abs(low), glm::abs(high))),
        size(largest(high - low)),
        step(stepAt(largest(reach))),
        finest_step(stepAt(size / 2)) {}

  bool isFar() const { return step >= kFar * finest_step; }
  bool isFarAlong(int axis) const { return stepAt(reach[axis]) >= kFar * finest_step; }

  glm::dvec3 low, high, reach;
  double size, step, finest_step;
};

}  // namespace

glm::dvec3 neededOffset(const Scene& scene, std::span<const glm::vec3> remainders) {
  const Extent extent(sceneBounds(scene));
  glm::dvec3 offset(0.0);
  if (!extent.isFar()) return offset;
  const double median_edge = medianEdge(scene, remainders);
  if (median_edge == 0.0) return offset;
  if (extent.step <= kCoarse * median_edge &&
      Positions(scene, remainders).loss(median_edge, false).collapsed == 0) {
    return offset;
  }
  const double unit = roundUnit(extent.size);
  for (int axis = 0; axis < 3; ++axis) {
    if (!extent.isFarAlong(axis)) continue;
    offset[axis] = std::round((extent.low[axis] + extent.high[axis]) / 2.0 / unit) * unit + 0.0;
  }
  return offset;
}

std::string precisionWarning(const Scene& scene, std::span<const glm::vec3> remainders,
                             bool file_has_floats) {
  const Extent extent(sceneBounds(scene));
  const double median_edge = medianEdge(scene, remainders);
  if (median_edge == 0.0) return {};
  const bool moved = scene.offset != glm::dvec3(0.0);
  const double file_reach =
      largest(glm::max(glm::abs(extent.low + scene.offset), glm::abs(extent.high + scene.offset)));
  if (moved && file_has_floats && stepAt(file_reach) > kCoarse * median_edge) {
    return fmt::format(
        "the file has its coordinates in single precision, which steps by {:.3g} at {:.10g}, and the median "
        "edge "
        "is {:.3g}: its triangles were bent before they came here; export it from nearer to the origin",
        stepAt(file_reach), file_reach, median_edge);
  }
  const bool bends = (extent.isFar() || moved) && extent.step > kCoarse * median_edge;
  const Loss loss = Positions(scene, remainders).loss(median_edge, bends);
  if (!bends && loss.collapsed == 0) return {};
  return fmt::format(
      "single precision steps by {:.3g} at coordinates of {:.10g}{}, and the median edge is {:.3g}; of {} "
      "triangles {} lose their area by that and {} turn by more than 30 degrees; the scene is too {} for its "
      "detail: {}",
      extent.step, largest(extent.reach), moved ? " (less the offset)" : "", median_edge,
      scene.triangleCount(), loss.collapsed, loss.turned, extent.isFar() ? "small" : "wide",
      extent.isFar() ? "scale it up, and move it to the origin" : "cut it into parts");
}

}  // namespace sightline
