#pragma once
#include <glm/glm.hpp>

namespace sightline {

/// An axis-aligned box, its faces included: low <= high on every axis.
struct AxisBox {
  glm::vec3 low{0}, high{0};
  bool operator==(const AxisBox&) const = default;
};

}  // namespace sightline
