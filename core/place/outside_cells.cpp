#include "core/place/outside_cells.h"

#include <algorithm>
#include <cmath>

#include "core/scene/largest.h"

namespace sightline {

std::vector<ViewCell> outsideCells(const Bounds& bounds) {
  const glm::dvec3 low(bounds.low), high(bounds.high);
  const double farthest = std::max(largest(glm::abs(low)), largest(glm::abs(high)));
  const double margin = std::max(glm::length(high - low) / 100, 64 * farthest * 0x1p-23);
  const glm::dvec3 center = (low + high) / 2.0;
  const glm::dvec3 size = high - low + 2 * margin;
  // Turned so that local +z looks along the axis, to either side.
  const struct {
    const char* name;
    int axis;
    double side;
    glm::dvec2 size;
    glm::dvec3 rotation;
  } kSides[] = {{"outside-x", 0, -1, {size.z, size.y}, {0, 90, 0}},
                {"outside+x", 0, 1, {size.z, size.y}, {0, -90, 0}},
                {"outside-y", 1, -1, {size.x, size.z}, {-90, 0, 0}},
                {"outside+y", 1, 1, {size.x, size.z}, {90, 0, 0}},
                {"outside-z", 2, -1, {size.x, size.y}, {0, 0, 0}},
                {"outside+z", 2, 1, {size.x, size.y}, {0, 180, 0}}};
  std::vector<ViewCell> cells;
  for (const auto& side : kSides) {
    ViewCell cell{side.name, center, {side.size, 0.0}, side.rotation};
    cell.center[side.axis] += side.side * size[side.axis] / 2;
    cells.push_back(cell);
  }
  return cells;
}

}  // namespace sightline
