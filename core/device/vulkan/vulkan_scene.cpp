#include "core/device/vulkan/vulkan_scene.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "core/trace/trace_layout.h"

namespace sightline {
namespace {

void packCorners(const Scene& scene, const uint32_t* ids, float* corners, size_t count) {
  tbb::parallel_for(size_t{0}, count, [&](size_t i) {
    const auto triangle = scene.corners(ids[i]);
    for (size_t corner = 0; corner < 3; ++corner) {
      for (int axis = 0; axis < 3; ++axis)
        corners[9 * i + 3 * corner + size_t(axis)] = triangle[corner][axis];
    }
  });
}

}  // namespace

void VulkanScene::describe(VulkanRunner& runner) const {
  VulkanLaunch& launch = runner.launch;
  launch.tlas = tree.top.address;
  launch.part_starts = part_starts.address();
  launch.leaf_ids = leaf_ids.address();
  runner.bind(StageBuffer::place_of, leaf_of);
  launch.corners = corners.address();
  if (surfaces.bytes() > 0) launch.surfaces = surfaces.address();
}

VulkanScene uploadVulkanScene(const VulkanContext& context, const Scene& scene, const Bvh& bvh,
                              uint32_t part_limit) {
  checkTraceable(bvh);
  const auto count = scene.triangleCount();
  const uint32_t possible = largestPart(context, count);
  const LeafParts leaves = splitBySurface(
      splitIntoParts(bvh, count, part_limit > 0 ? std::min(part_limit, possible) : possible), scene.surfaces);

  VulkanScene result;
  VulkanUpload upload(context);
  result.corners = context.buffer(uint64_t(count) * kCornerBytes, "triangles of the scene");
  upload.write(result.corners, uint64_t(count) * kCornerBytes, kCornerBytes,
               [&](void* piece, uint64_t first, uint64_t bytes) {
                 packCorners(scene, &leaves.ids[first / kCornerBytes], static_cast<float*>(piece),
                             bytes / kCornerBytes);
               });
  result.leaf_ids = context.buffer(uint64_t(count) * 4, "ids of the triangles");
  upload.write(result.leaf_ids, leaves.ids.data(), uint64_t(count) * 4);
  std::vector<uint32_t> table(count);
  for (uint32_t leaf = 0; leaf < count; ++leaf) table[leaves.ids[leaf]] = leaf;
  result.leaf_of = context.buffer(uint64_t(count) * 4, "index of triangles");
  upload.write(result.leaf_of, table.data(), uint64_t(count) * 4);
  table.clear();
  for (const LeafPart& part : leaves.parts) table.push_back(part.first);
  result.part_starts = context.buffer(table.size() * 4, "parts of the scene");
  upload.write(result.part_starts, table.data(), table.size() * 4);
  if (featuresOf(scene.surfaces).any()) {
    const std::vector<uint32_t> surfaces = packSurfaces(scene.surfaces, leaves.ids);
    result.surfaces = context.buffer(surfaces.size() * 4, "surfaces of the scene");
    upload.write(result.surfaces, surfaces.data(), surfaces.size() * 4);
  }
  upload.finish();
  result.tree = buildVulkanTree(context, result.corners, leaves.parts);
  return result;
}

}  // namespace sightline
