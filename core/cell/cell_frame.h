#pragma once
#include <glm/glm.hpp>

#include "core/cell/view_cell.h"

namespace sightline {

/// A view cell's local frame in double: world = center + sum of axes[i] * local[i], |local[i]| <=
/// half_size[i].
struct CellFrame {
  glm::dvec3 center{0.0};
  glm::dvec3 half_size{0.0};
  glm::dvec3 axes[3];  ///< columns of Rz * Ry * Rx; exact for multiples of 90 degrees

  glm::dvec3 toWorld(const glm::dvec3& local) const {
    return center + (axes[0] * local.x + axes[1] * local.y + axes[2] * local.z);
  }
  glm::dvec3 toLocal(const glm::dvec3& world) const {
    const glm::dvec3 offset = world - center;
    return {glm::dot(axes[0], offset), glm::dot(axes[1], offset), glm::dot(axes[2], offset)};
  }
};

CellFrame cellFrame(const ViewCell& cell);

}  // namespace sightline
