#pragma once
#include "core/draw/drawables.h"
#include "core/draw/triangle_lists.h"
#include "core/vulkan/vulkan_commands.h"
#include "vk_shaders/draw_launch.h"

namespace sightline {

/// What is drawn by one call: slots, places in the order in which triangles are drawn.
struct SlotRun {
  uint32_t first = 0, count = 0;
  AlphaKind kind = AlphaKind::opaque;
};

/// A scene's triangles on a device, in the drawables' order; behind them those of the lists. 12 bytes a
/// vertex and a slot, and 4 more where anything has holes.
class DrawMesh {
 public:
  /// The scene and the drawables must live as long. Throws Error where it does not fit.
  DrawMesh(const VulkanContext& context, const Scene& scene, const Drawables& drawables,
           const TriangleLists& lists);

  const Scene& scene() const { return scene_; }
  const Drawables& drawables() const { return drawables_; }
  bool hasGlass() const { return has_glass_; }
  /// Whether opaque drawables too are drawn vertex by vertex, for the sake of triangles that only their front
  /// shows.
  bool hasSides() const { return has_sides_; }
  SlotRun run(uint32_t drawable) const;
  /// Of a list: at most one run of each kind, in the order of kinds.
  const std::vector<SlotRun>& listRuns(uint32_t list) const { return lists_.at(list); }
  const VulkanBuffer& indices() const { return indices_; }
  /// Puts the addresses there.
  void describe(DrawLaunch& launch) const;

 private:
  const Scene& scene_;
  const Drawables& drawables_;
  bool has_glass_ = false, has_sides_ = false;
  std::vector<std::vector<SlotRun>> lists_;
  VulkanBuffer positions_, indices_, surfaces_;
};

}  // namespace sightline
