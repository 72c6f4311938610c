#pragma once
#include <CLI/CLI.hpp>
#include <optional>

#include "core/cli/number_checks.h"
#include "core/voxel/lattice.h"

namespace sightline {

/// --voxel and --along of commands that voxelise a scene: how large voxels are.
class VoxelSize {
 public:
  /// This must live as long as `command`.
  void declare(CLI::App& command) {
    CLI::Option* size = command
                            .add_option_function<double>(
                                "--voxel", [this](const double& value) { lattice_ = latticeOf(value); },
                                "Side of a voxel in the scene's units: a power of two such as 0.25")
                            ->type_name("SIZE");
    command.add_option("--along", along_, "Or: voxels along the scene's longest side, at most")
        ->excludes(size)
        ->transform(wholeNumber(1, uint64_t(kMostVoxelsAlong)))
        ->type_name("N")
        ->capture_default_str();
  }

  /// Throws Error if that is too small for the scene.
  Lattice of(const Scene& scene) const {
    const Bounds bounds = sceneBounds(scene);
    const Lattice lattice = lattice_ ? *lattice_ : latticeFor(bounds, along_);
    requireFits(lattice, bounds);
    return lattice;
  }

 private:
  std::optional<Lattice> lattice_;
  uint64_t along_ = 512;
};

}  // namespace sightline
