#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/cell/view_cell.h"
#include "core/pvs/cell_stats.h"
#include "core/shared/types.h"

namespace sightline {

/// A ray that hits its triangle first.
struct Witness {
  glm::vec3 origin{0}, direction{0};
  uint32_t stage = kStageRandom;  ///< kStage...; of a contained triangle origin and direction are 0
};

/// What a cell sees besides its set when the bake's doors are open.
struct OpenSet {
  CellStats stats;                  ///< of the bake with the doors as glass, by the same seed
  std::vector<uint32_t> triangles;  ///< ids that the set has not, ascending, unique
  std::vector<Witness> witnesses;   ///< one a triangle, or empty: hits it first but for doors
};

/// The potentially visible set of one cell.
struct CellPvs {
  ViewCell cell;
  CellStats stats;
  std::string device;               ///< DeviceInfo::id and name of the device that baked it
  std::vector<uint32_t> triangles;  ///< ids, ascending, unique
  std::vector<Witness> witnesses;   ///< one a triangle, or empty
  std::optional<OpenSet> open;      ///< of a bake with doors, which are closed in the set itself
};

}  // namespace sightline
