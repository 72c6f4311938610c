#pragma once
#include "core/cell/view_cell.h"

namespace sightline::testing_support {

inline ViewCell makeCell(const glm::dvec3& center, const glm::dvec3& size,
                         const glm::dvec3& rotation = glm::dvec3(0.0)) {
  return {"cell", center, size, rotation};
}

}  // namespace sightline::testing_support
