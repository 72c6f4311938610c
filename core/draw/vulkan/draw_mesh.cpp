#include "core/draw/vulkan/draw_mesh.h"

#include <fmt/format.h>

#include <cstring>

#include "core/base/error.h"
#include "core/scene/instances.h"

namespace sightline {
namespace {

/// The list's triangles behind the slots, in their order: a run of each kind that there is.
std::vector<SlotRun> appendList(const TriangleList& list, std::vector<uint32_t>& slots) {
  const auto begin = uint32_t(slots.size());
  slots.insert(slots.end(), list.ids.begin(), list.ids.end());
  const uint32_t ends[] = {0, list.masked_begin, list.blended_begin, uint32_t(list.ids.size())};
  std::vector<SlotRun> runs;
  for (uint32_t kind = 0; kind < 3; ++kind) {
    const SlotRun run{begin + ends[kind], ends[kind + 1] - ends[kind], AlphaKind(kind)};
    if (run.count > 0) runs.push_back(run);
  }
  return runs;
}

}  // namespace

DrawMesh::DrawMesh(const VulkanContext& context, const Scene& scene, const Drawables& drawables,
                   const TriangleLists& lists)
    : scene_(scene), drawables_(drawables) {
  for (const Drawable& drawable : drawables.list)
    has_glass_ = has_glass_ || drawable.alpha == AlphaKind::blended;
  if (has_glass_ && !context.has(VulkanFeature::kIndependentBlend)) {
    throw Error(fmt::format("{} ({}) cannot draw glass: {}", context.info().id, context.info().name,
                            whyLacks(context.abilities(), VulkanFeature::kIndependentBlend)));
  }
  std::vector<uint32_t> slots = drawables.triangles;
  for (const TriangleList& list : lists.lists) lists_.push_back(appendList(list, slots));
  // Vertices are counted in 32 bits.
  if (slots.size() >= (uint64_t(1) << 32) / 3) {
    throw Error(fmt::format(
        "{} triangles of the scene and of lists are too many to draw, {} at most; take fewer cells",
        slots.size(), (uint64_t(1) << 32) / 3));
  }
  if (scene.vertexCount() > uint64_t(context.limits().vertex_number) + 1) {
    throw Error(
        fmt::format("the scene has {} vertices, and {} ({}) draws {} at most (maxDrawIndexedIndexValue); "
                    "take a smaller scene",
                    scene.vertexCount(), context.info().id, context.info().name,
                    uint64_t(context.limits().vertex_number) + 1));
  }
  positions_ = context.buffer(scene.vertexCount() * 12, {"vertices of the scene", "a smaller scene"});
  indices_ = context.buffer(slots.size() * 12, {"triangles of the scene", "a smaller scene"});
  VulkanUpload upload(context);
  if (scene.hasInstances()) {
    std::vector<glm::vec3> positions(scene.vertexCount());
    scene.visitTriangles(0, scene.triangleCount(), [&](uint32_t id, const std::array<glm::vec3, 3>& corners) {
      const glm::uvec3 numbers = scene.vertexNumbers(id);
      for (int i = 0; i < 3; ++i) positions[numbers[i]] = corners[size_t(i)];
    });
    upload.write(positions_, positions.data(), positions.size() * 12);
    upload.finish();
  } else {
    upload.write(positions_, scene.positions.data(), scene.positions.size() * 12);
  }
  upload.write(indices_, slots.size() * 12, 12, [&](void* piece, uint64_t first, uint64_t bytes) {
    auto* out = static_cast<glm::uvec3*>(piece);
    for (uint64_t i = 0; i < bytes / 12; ++i) out[i] = scene.vertexNumbers(slots[first / 12 + i]);
  });
  std::vector<uint32_t> surfaces;
  const SurfaceFeatures features = featuresOf(scene.surfaces);
  has_sides_ = features.sides;
  if (features.masks || features.sides) {
    const Surfaces flat = scene.hasInstances() ? flatSurfaces(scene) : Surfaces();
    surfaces = packSurfaces(scene.hasInstances() ? flat : scene.surfaces, slots);
    surfaces_ = context.buffer(surfaces.size() * 4, {"surfaces of the scene", "a smaller scene"});
    upload.write(surfaces_, surfaces.data(), surfaces.size() * 4);
  }
  upload.finish();
}

SlotRun DrawMesh::run(uint32_t drawable) const {
  const Drawable& its = drawables_.list[drawable];
  return {its.first_triangle, its.triangle_count, its.alpha};
}

void DrawMesh::describe(DrawLaunch& launch) const {
  launch.positions = positions_.address();
  launch.indices = indices_.address();
  launch.surfaces = surfaces_.bytes() > 0 ? surfaces_.address() : 0;
}

}  // namespace sightline
