#include "core/cell/view_cell.h"

#include "core/cell/cell_frame.h"
#include "core/cell/rotation.h"

namespace sightline {
namespace {

/// Rounds to float; a negative zero becomes a positive one, so that equal boxes give equal bits.
glm::vec4 rounded(const glm::dvec3& value) {
  return {glm::vec3(value + 0.0), 0.0f};
}

/// The face with the outward normal sign * axis[n]; axis_u x axis_v is that normal.
Face makeFace(const CellFrame& frame, int n, double sign) {
  const int u = sign > 0 ? (n + 1) % 3 : (n + 2) % 3;
  const int v = sign > 0 ? (n + 2) % 3 : (n + 1) % 3;
  const glm::dvec3 edge_u = 2.0 * frame.half_size[u] * frame.axes[u];
  const glm::dvec3 edge_v = 2.0 * frame.half_size[v] * frame.axes[v];
  glm::dvec3 local(0.0);
  local[n] = sign * frame.half_size[n];
  local[u] = -frame.half_size[u];
  local[v] = -frame.half_size[v];
  return {rounded(frame.toWorld(local)), rounded(edge_u),        rounded(edge_v),
          rounded(frame.axes[u]),        rounded(frame.axes[v]), rounded(sign * frame.axes[n])};
}

}  // namespace

CellFrame cellFrame(const ViewCell& cell) {
  const CosSin x = cosSinDegrees(cell.rotation.x);
  const CosSin y = cosSinDegrees(cell.rotation.y);
  const CosSin z = cosSinDegrees(cell.rotation.z);
  // Columns of Rz * Ry * Rx. Adding 0.0 turns -0.0 into 0.0.
  CellFrame frame;
  frame.center = cell.center;
  frame.half_size = cell.size * 0.5;
  frame.axes[0] = glm::dvec3(z.cosine * y.cosine, z.sine * y.cosine, -y.sine) + 0.0;
  frame.axes[1] = glm::dvec3(z.cosine * y.sine * x.sine - z.sine * x.cosine,
                             z.sine * y.sine * x.sine + z.cosine * x.cosine, y.cosine * x.sine) +
                  0.0;
  frame.axes[2] = glm::dvec3(z.cosine * y.sine * x.cosine + z.sine * x.sine,
                             z.sine * y.sine * x.cosine - z.cosine * x.sine, y.cosine * x.cosine) +
                  0.0;
  return frame;
}

ViewCell moved(ViewCell cell, const glm::dvec3& by) {
  cell.center += by;
  return cell;
}

std::vector<ViewCell> moved(std::vector<ViewCell> cells, const glm::dvec3& by) {
  for (ViewCell& cell : cells) cell.center += by;
  return cells;
}

std::vector<Face> cellFaces(const ViewCell& cell) {
  const CellFrame frame = cellFrame(cell);
  if (cell.flat()) return {makeFace(frame, 2, 1.0)};
  std::vector<Face> faces;
  for (int n = 0; n < 3; ++n) {
    if (cell.size[(n + 1) % 3] == 0.0 || cell.size[(n + 2) % 3] == 0.0) continue;
    faces.push_back(makeFace(frame, n, -1.0));
    faces.push_back(makeFace(frame, n, 1.0));
  }
  return faces;
}

std::vector<glm::vec3> cellCorners(const ViewCell& cell) {
  const CellFrame frame = cellFrame(cell);
  std::vector<glm::vec3> corners;
  for (int i = 0; i < 8; ++i) {
    const glm::dvec3 sign((i & 1) != 0 ? 1.0 : -1.0, (i & 2) != 0 ? 1.0 : -1.0, (i & 4) != 0 ? 1.0 : -1.0);
    corners.emplace_back(rounded(frame.toWorld(sign * frame.half_size)));
  }
  return corners;
}

}  // namespace sightline
