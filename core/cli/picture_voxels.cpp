#include "core/cli/picture_voxels.h"

#include <fmt/core.h>

#include <array>
#include <cmath>

#include "core/api/session.h"
#include "core/base/error.h"
#include "core/base/text.h"
#include "core/cli/voxel_level.h"
#include "core/voxel/inner_voxels.h"
#include "core/voxel/reach.h"
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

constexpr glm::vec3 kInnerColor{0.50f, 0.10f, 0.05f};

VoxelGrid cutOpen(VoxelGrid grid, const std::optional<double>& height) {
  if (!height) return grid;
  // Whole voxels: the one that the plane cuts goes, too. Far heights are as good as all or none.
  const double end = std::floor(*height / grid.lattice.voxelSize());
  return voxelsBelow(grid, int64_t(std::fmax(-0x1p40, std::fmin(end, 0x1p40))));
}

/// The voxels that no triangle meets and that are not reached from the places.
VoxelGrid notReached(const VoxelGrid& grid, std::vector<glm::dvec3> places, const glm::dvec3& offset) {
  for (glm::dvec3& place : places) place -= offset;
  const VoxelSpace space = reach(grid, {.seeds = std::move(places)});
  fmt::print("{}\n", reachedText(space.counts()));
  return innerVoxels(space);
}

/// Adds the triangles of another scene.
void append(Scene& scene, const Scene& other) {
  const auto first = uint32_t(scene.positions.size());
  scene.positions.insert(scene.positions.end(), other.positions.begin(), other.positions.end());
  for (const glm::uvec3& t : other.triangles) scene.triangles.push_back(t + first);
  scene.objects.front().triangle_count = uint32_t(scene.triangles.size());
}

}  // namespace

void drawVoxels(const VoxelPicture& options) {
  const VoxelFile voxels = loadVoxels(options.voxels);
  const VoxelGrid& whole = levelOf(voxels, options.level, options.voxels);
  std::optional<double> cut = options.cut_height;
  if (cut) *cut -= voxels.head.offset.y;
  VoxelGrid inner;
  if (!options.reach.empty()) inner = cutOpen(notReached(whole, options.reach, voxels.head.offset), cut);
  const VoxelGrid grid = cutOpen(whole, cut);
  if (grid.blocks.empty())
    throw Error(fmt::format("{}: no voxel lies below --cut", options.voxels.string()), kExitUsage);
  Scene scene = voxelScene(grid, FaceMerging::kBlocks);
  const uint32_t surface_triangles = scene.triangleCount();
  if (!inner.blocks.empty()) append(scene, voxelScene(inner, FaceMerging::kBlocks));
  Session session(std::move(scene), {.device = options.device});
  session.open();
  const TraceRays trace = [&](std::span<const Ray> rays, std::span<Hit> hits) {
    session.traceRays(rays, hits);
  };
  const auto color = [&](uint32_t triangle) {
    return triangle < surface_triangles ? kLevelColors[options.level % kLevelColors.size()] : kInnerColor;
  };
  const Picture picture = renderWhole(trace, session.scene(), color, options.size);
  savePng(picture.image, options.output);
  fmt::print("{}: {} of {:g} (level {})\n", options.output.string(), counted(grid.count(), "voxel"),
             grid.lattice.voxelSize(), options.level);
}

}  // namespace sightline
