#pragma once
// Triangle against view cell in double, for tests: separating axes (Akenine-Möller, Fast 3D Triangle-Box
// Overlap Testing, 2001), in the cell's own axes.
#include <glm/glm.hpp>

#include "core/cell/view_cell.h"
#include "core/scene/scene.h"

namespace sightline::test {

/// The cell's local axes (columns), as cellFaces defines them: rotations about x, then y, then z.
inline glm::dmat3 cellAxes(const ViewCell& cell) {
  const auto rotation = [](double degrees, int axis) {
    const double a = degrees * 3.14159265358979323846 / 180, c = std::cos(a), s = std::sin(a);
    glm::dmat3 m(1.0);
    const int i = (axis + 1) % 3, j = (axis + 2) % 3;
    m[i][i] = c, m[i][j] = s, m[j][i] = -s, m[j][j] = c;
    return m;
  };
  return rotation(cell.rotation.z, 2) * rotation(cell.rotation.y, 1) * rotation(cell.rotation.x, 0);
}

/// Whether triangle a, b, c meets the box |p| <= half.
inline bool boxMeetsTriangle(glm::dvec3 half, glm::dvec3 a, glm::dvec3 b, glm::dvec3 c) {
  const glm::dvec3 edges[3] = {b - a, c - b, a - c};
  const auto separates = [&](glm::dvec3 axis) {
    const double pa = glm::dot(axis, a), pb = glm::dot(axis, b), pc = glm::dot(axis, c);
    const double reach = glm::dot(glm::abs(axis), half);
    return std::min({pa, pb, pc}) > reach || std::max({pa, pb, pc}) < -reach;
  };
  for (int i = 0; i < 3; ++i) {
    glm::dvec3 unit(0.0);
    unit[i] = 1;
    if (separates(unit)) return false;
    for (const glm::dvec3& edge : edges) {
      if (separates(glm::cross(unit, edge))) return false;
    }
  }
  return !separates(glm::cross(edges[0], edges[1]));
}

/// The first triangle that meets the cell, or kNoTriangle.
inline uint32_t firstTriangleInCell(const Scene& scene, const ViewCell& cell) {
  const glm::dmat3 to_local = glm::transpose(cellAxes(cell));
  for (uint32_t i = 0; i < scene.triangles.size(); ++i) {
    glm::dvec3 p[3];
    for (int k = 0; k < 3; ++k) {
      p[k] = to_local * (glm::dvec3(scene.positions[scene.triangles[i][k]]) - cell.center);
    }
    if (boxMeetsTriangle(cell.size / 2.0, p[0], p[1], p[2])) return i;
  }
  return kNoTriangle;
}

}  // namespace sightline::test
