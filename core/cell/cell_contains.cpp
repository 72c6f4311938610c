#include "core/cell/cell_contains.h"

#include "core/cell/cell_frame.h"

namespace sightline {
namespace {

/// More than a corner strays by rounding to float, as a share of the coordinates and extents around it.
constexpr double kMostRounding = 0x1p-20;

/// Whether the position is farther from the centre than any corner: cheap, so that most of many cells need no
/// sines.
bool isFar(const ViewCell& cell, const glm::dvec3& position) {
  const double radius = 0.5 * glm::length(cell.size);
  const double slack = (glm::length(cell.center) + radius) * kMostRounding;
  return !(glm::length(position - cell.center) <= radius + slack);
}

}  // namespace

glm::dvec3 roundingOfFaces(const ViewCell& cell, const CellFrame& frame) {
  glm::dvec3 margin(0.0);
  for (const Face& face : cellFaces(cell)) {
    for (const glm::vec4& corner : {face.corner, face.corner + face.edge_u, face.corner + face.edge_v,
                                    face.corner + face.edge_u + face.edge_v}) {
      const glm::dvec3 local = frame.toLocal(glm::dvec3(corner));
      margin = glm::max(margin, glm::abs(glm::abs(local) - frame.half_size));
    }
  }
  return margin;
}

bool cellContains(const ViewCell& cell, const glm::dvec3& position) {
  if (isFar(cell, position)) return false;
  const CellFrame frame = cellFrame(cell);
  const glm::dvec3 reach = frame.half_size + roundingOfFaces(cell, frame);
  return glm::all(glm::lessThanEqual(glm::abs(frame.toLocal(position)), reach));
}

}  // namespace sightline
