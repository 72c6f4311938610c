#pragma once
#include <vector>

#include "core/bound/blocked_space.h"
#include "core/bound/cell_hull.h"

namespace sightline {

/// Looks for layers of voxels that hide boxes from a cell. For one thread.
class LayerSearch {
 public:
  /// view must outlive it. region: holds all segments. Where the cell as a whole does not do, it is cut into
  /// parts, each of which may have a layer of its own, until they are no longer than part_size in voxels (but
  /// 2^kMostCuts parts at most).
  LayerSearch(const CellHull& hull, double part_size, const VoxelBox& region, BlockedView& view);

  static constexpr int kMostCuts = 8;

  /// Whether all segments from the cell to the box were found to cross blocked voxels.
  bool hides(const RealBox& box) { return lookFrom(0, box) == Result::kHidden; }

 private:
  /// kFree: a segment crosses none, or hardly any.
  enum class Result { kHidden, kOpen, kFree };
  struct Layer {
    int axis = -1, at = 0;
  };
  struct Part {
    CellHull hull;
    Layer last;  ///< that hid the box before from it: often hides the next one, too
  };

  Result lookFrom(size_t part, const RealBox& box);
  bool isCovered(Part& part, const RealBox& box, int axis, int at);
  bool tryRun(Part& part, const RealBox& box, const VoxelBox& between, const glm::dvec3& from,
              const glm::dvec3& way, double near, double far);

  std::vector<Part> parts_;  ///< those of parts_[i] are 2 i + 1 and 2 i + 2
  VoxelBox region_;
  BlockedView& view_;
};

}  // namespace sightline
