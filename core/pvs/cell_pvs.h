#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "core/pvs/cell_stats.h"
#include "core/cell/view_cell.h"
#include "core/shared/types.h"

namespace sightline {

/// A ray that hits its triangle first.
struct Witness {
  glm::vec3 origin{0}, direction{0};
  uint32_t stage = kStageRandom;  ///< kStage...; of a contained triangle origin and direction are 0
};

/// The potentially visible set of one cell.
struct CellPvs {
  ViewCell cell;
  CellStats stats;
  std::string device;               ///< DeviceInfo::id and name of the device that baked it
  std::vector<uint32_t> triangles;  ///< ids, ascending, unique
  std::vector<Witness> witnesses;   ///< one a triangle, or empty
};

}  // namespace sightline
