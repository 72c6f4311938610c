#pragma once
#include <CLI/CLI.hpp>
#include <atomic>
#include <string>
#include <vector>

#include "core/scene/scene.h"
#include "core/voxel/voxel_grid.h"

namespace sightline {

/// --solid of commands that voxelise a scene: what is inside, and how that is known.
class SolidOption {
 public:
  /// This must live as long as `command`.
  void declare(CLI::App& command);
  bool isAsked() const { return !rule_.empty(); }

  /// Throws Error if --reach is not places, or is of another rule: before the work.
  void check() const;

  /// Adds the voxels that are inside to the grid's, which must be conservative and, but for --solid reach,
  /// have its blocks' triangles; and says how much that is, in a line. Throws Error, and Interrupted.
  void fill(const Scene& scene, VoxelGrid& grid, const std::atomic<bool>* stop) const;

 private:
  std::string rule_;
  bool must_close_ = false;
  std::vector<std::string> reach_;
};

}  // namespace sightline
