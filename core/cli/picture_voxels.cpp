#include "core/cli/picture_voxels.h"

#include <fmt/core.h>

#include <array>
#include <cmath>

#include "core/api/session.h"
#include "core/base/text.h"
#include "core/cli/voxel_level.h"
#include "core/voxel/voxel_faces.h"
#include "core/voxel/voxels_below.h"

namespace sightline {
namespace {

/// A level's colour, linear light; from level 8 on they repeat.
constexpr std::array<glm::vec3, 8> kLevelColors = {{{0.50f, 0.51f, 0.53f},
                                                    {0.13f, 0.36f, 0.66f},
                                                    {0.05f, 0.52f, 0.44f},
                                                    {0.25f, 0.55f, 0.10f},
                                                    {0.72f, 0.56f, 0.06f},
                                                    {0.78f, 0.27f, 0.04f},
                                                    {0.62f, 0.09f, 0.14f},
                                                    {0.42f, 0.12f, 0.48f}}};

VoxelGrid cutOpen(const VoxelGrid& grid, double height, const std::filesystem::path& file) {
  // Whole voxels: the one that the plane cuts goes, too. Far heights are as good as all or none.
  const double end = std::floor(height / grid.lattice.voxelSize());
  VoxelGrid below = voxelsBelow(grid, int64_t(std::fmax(-0x1p40, std::fmin(end, 0x1p40))));
  if (!below.blocks.empty()) return below;
  throw Error(fmt::format("{}: no voxel lies below --cut", file.string()));
}

}  // namespace

void drawVoxels(const VoxelPicture& options) {
  const VoxelFile voxels = loadVoxels(options.voxels);
  const VoxelGrid& whole = levelOf(voxels, options.level, options.voxels);
  const VoxelGrid cut = options.cut_height
                            ? cutOpen(whole, *options.cut_height - voxels.head.offset.y, options.voxels)
                            : VoxelGrid{};
  const VoxelGrid& grid = options.cut_height ? cut : whole;
  Session session(voxelScene(grid, FaceMerging::kBlocks), {.device = options.device});
  session.open();
  const TraceRays trace = [&](std::span<const Ray> rays, std::span<Hit> hits) {
    session.traceRays(rays, hits);
  };
  const glm::vec3 color = kLevelColors[options.level % kLevelColors.size()];
  const Picture picture = renderWhole(
      trace, session.scene(), [&](uint32_t) { return color; }, options.size);
  savePng(picture.image, options.output);
  fmt::print("{}: {} of {:g} (level {})\n", options.output.string(), counted(grid.count(), "voxel"),
             grid.lattice.voxelSize(), options.level);
}

}  // namespace sightline
