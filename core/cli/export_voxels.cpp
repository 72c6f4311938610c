#include "core/cli/export_voxels.h"

#include <fmt/core.h>

#include "core/base/text.h"
#include "core/cli/voxel_level.h"
#include "core/export/voxel_export.h"
#include "core/formats/save_scene.h"

namespace sightline {

void exportVoxels(const VoxelExport& options) {
  const VoxelFile voxels = loadVoxels(options.voxels);
  const VoxelGrid& grid = levelOf(voxels, options.level, options.voxels);
  const FaceMerging merging = options.merge ? FaceMerging::kBlocks : FaceMerging::kNone;
  std::string what;
  if (options.format == "vdb") {
    saveVdb(grid, voxels.head.offset, options.out);
  } else if (options.format == "ply") {
    const VoxelMesh mesh = voxelMesh(grid, merging);
    savePly(mesh, voxels.head.offset, options.out);
    what = counted(mesh.faces.size(), "face") + " of ";
  } else {
    Scene scene = voxelScene(grid, merging);
    scene.offset = voxels.head.offset;
    saveScene(scene, options.out);
    what = counted(scene.triangleCount(), "triangle") + " around ";
  }
  fmt::print("{}: {}{} of {:g} (level {})\n", options.out.string(), what, counted(grid.count(), "voxel"),
             grid.lattice.voxelSize(), options.level);
}

}  // namespace sightline
