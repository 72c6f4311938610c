#pragma once
#include <vector>

#include "core/bound/blocked_space.h"
#include "core/bound/cell_hull.h"

namespace sightline {

/// Looks for layers of voxels that hide boxes from a cell. For one thread.
class LayerSearch {
 public:
  /// All must outlive it. region: holds all segments. cuts: the cell may be cut into 2^cuts parts.
  LayerSearch(const CellHull& hull, int cuts, const VoxelBox& region, BlockedView& view);

  /// Whether all segments from the cell to the box were found to cross blocked voxels.
  bool hides(const RealBox& box) { return hidesFrom(0, box); }

 private:
  struct Layer {
    int axis = -1, at = 0;
  };
  struct Part {
    CellHull hull;
    Layer last;  ///< that hid the box before from it: often hides the next one, too
  };

  bool hidesFrom(size_t part, const RealBox& box);
  bool isCovered(Part& part, const RealBox& box, int axis, int at);
  bool tryRun(Part& part, const RealBox& box, const VoxelBox& between, const glm::dvec3& from,
              const glm::dvec3& way, double near, double far);

  std::vector<Part> parts_;  ///< those of parts_[i] are 2 i + 1 and 2 i + 2
  VoxelBox region_;
  BlockedView& view_;
};

}  // namespace sightline
