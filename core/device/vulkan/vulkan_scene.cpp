#include "core/device/vulkan/vulkan_scene.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "core/base/error.h"
#include "core/trace/trace_layout.h"

namespace sightline {
namespace {

void packCorners(const Scene& scene, const uint32_t* ids, float* corners, size_t count) {
  tbb::parallel_for(size_t{0}, count, [&](size_t i) {
    const auto triangle = scene.cornersOf({ids[i], kNoTriangle});
    for (size_t corner = 0; corner < 3; ++corner) {
      for (int axis = 0; axis < 3; ++axis)
        corners[9 * i + 3 * corner + size_t(axis)] = triangle[corner][axis];
    }
  });
}

VkTransformMatrixKHR transformOf(const Placement& place) {
  VkTransformMatrixKHR transform;
  for (int row = 0; row < 3; ++row) {
    transform.matrix[row][0] = place.x[row];
    transform.matrix[row][1] = place.y[row];
    transform.matrix[row][2] = place.z[row];
    transform.matrix[row][3] = place.origin[row];
  }
  return transform;
}

/// What the top level holds: each part in each place, the first leaf of each, what is added to its ids, and
/// which instance places it.
struct Placed {
  std::vector<PlacedPart> parts;
  std::vector<uint32_t> starts, ids, instances;
};

Placed placeParts(const Bvh& bvh, const std::vector<LeafPart>& parts) {
  Placed placed;
  const auto add = [&](uint32_t part, uint32_t first_id, uint32_t instance, const PlacedPart& place) {
    placed.parts.push_back(place);
    placed.parts.back().part = part;
    placed.starts.push_back(parts[part].first);
    placed.ids.push_back(first_id);
    placed.instances.push_back(instance);
  };
  if (!bvh.hasInstances()) {
    for (uint32_t part = 0; part < parts.size(); ++part) add(part, 0, kNoTriangle, {});
    return placed;
  }
  for (uint32_t number = 0; number < bvh.instances.size(); ++number) {
    const InstanceRecord& instance = bvh.instances[number];
    const bool in_place = (instance.roots.z & kInstanceInPlace) != 0;
    PlacedPart place;
    if (!in_place) place.place = transformOf(instance.place);
    const auto first = std::ranges::lower_bound(parts, instance.roots.x, {}, &LeafPart::root);
    for (auto part = first; part != parts.end() && part->root == instance.roots.x; ++part) {
      add(static_cast<uint32_t>(part - parts.begin()), in_place ? 0 : instance.ids.x,
          in_place ? kNoTriangle : number, place);
    }
  }
  return placed;
}

}  // namespace

void VulkanScene::describe(VulkanRunner& runner) const {
  VulkanLaunch& launch = runner.launch;
  launch.tlas = tree.top.address;
  launch.part_starts = part_starts.address();
  launch.part_ids = part_ids.address();
  launch.part_places = instance_count > 0 ? part_places.address() : 0;
  launch.instances = instance_count > 0 ? instances.address() : 0;
  launch.instance_count = instance_count;
  launch.leaf_ids = leaf_ids.address();
  runner.bind(StageBuffer::place_of, leaf_of);
  launch.corners = corners.address();
  if (surfaces.bytes() > 0) launch.surfaces = surfaces.address();
}

VulkanScene uploadVulkanScene(const VulkanContext& context, const Scene& scene, const Bvh& bvh,
                              uint32_t part_limit) {
  checkTraceable(bvh);
  const auto count = static_cast<uint32_t>(scene.triangles.size());
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
  std::vector<uint32_t> table(count);
  for (uint32_t leaf = 0; leaf < count; ++leaf) table[leaf] = recordId(scene, bvh, leaves.ids[leaf]);
  upload.write(result.leaf_ids, table.data(), uint64_t(count) * 4);
  for (uint32_t leaf = 0; leaf < count; ++leaf) table[leaves.ids[leaf]] = leaf;
  result.leaf_of = context.buffer(uint64_t(count) * 4, "index of triangles");
  upload.write(result.leaf_of, table.data(), uint64_t(count) * 4);
  const Placed placed = placeParts(bvh, leaves.parts);
  if (placed.parts.size() > kMostPlacedParts) {
    throw Error(fmt::format("{} instances, Vulkan takes {} at most: --device opencl, or --flatten",
                            placed.parts.size(), kMostPlacedParts));
  }
  result.part_starts = context.buffer(placed.starts.size() * 4, "parts of the scene");
  upload.write(result.part_starts, placed.starts.data(), placed.starts.size() * 4);
  result.part_ids = context.buffer(placed.ids.size() * 4, "first ids of parts");
  upload.write(result.part_ids, placed.ids.data(), placed.ids.size() * 4);
  if (bvh.hasInstances()) {
    result.instance_count = static_cast<uint32_t>(scene.instances.size());
    const uint64_t bytes = bvh.instances.size() * sizeof(InstanceRecord);
    result.instances = context.buffer(bytes, "instances of the scene");
    upload.write(result.instances, bvh.instances.data(), bytes);
    result.part_places = context.buffer(placed.instances.size() * 4, "instances of parts");
    upload.write(result.part_places, placed.instances.data(), placed.instances.size() * 4);
  }
  if (featuresOf(scene.surfaces).any()) {
    const std::vector<uint32_t> surfaces = packSurfaces(scene.surfaces, leaves.ids);
    result.surfaces = context.buffer(surfaces.size() * 4, "surfaces of the scene");
    upload.write(result.surfaces, surfaces.data(), surfaces.size() * 4);
  }
  upload.finish();
  result.tree = buildVulkanTree(context, result.corners, leaves.parts, placed.parts);
  return result;
}

}  // namespace sightline
