#pragma once
#include "core/draw/vulkan/gpu_culling.h"

namespace sightline {

/// Where a frame shows what lies behind what it should show.
struct DepthDifference {
  struct Missing {
    uint32_t drawable = 0;
    uint32_t pixels = 0;  ///< that show it in the reference and are false
    bool operator==(const Missing&) const = default;
  };
  uint64_t false_pixels = 0;     ///< farther than in the reference, by however little
  uint64_t too_near_pixels = 0;  ///< nearer: never, unless the device draws the same triangles in two ways
  std::vector<Missing> missing;  ///< by drawable
  uint32_t largest = 0;          ///< most false pixels of one drawable
  std::vector<uint32_t>
      shown;  ///< drawables with a pixel in the reference: the fewest that a frame can do with
};

/// Compares frames with a picture of all opaque and masked drawables, drawn by the same pipelines without any
/// culling, bit by bit: depth does not depend on the order of drawing. What blends writes none.
class DepthCheck {
 public:
  /// The drawing must live as long.
  explicit DepthCheck(VulkanDrawing& drawing) : drawing_(drawing) {}

  /// The drawing's last frame, drawn by `method`, or by queries and lists; waits until it has run.
  DepthDifference compare(GpuCulling* method = nullptr);

  /// The reference of the last comparison, row after row from the top.
  std::vector<uint32_t> referenceIds() const { return drawing_.read(target_, DrawTarget::Image::ids); }
  std::vector<float> referenceDepth() const { return drawing_.readDepth(target_); }

 private:
  void fit();
  void drawReference(VkCommandBuffer commands, GpuCulling* method);

  VulkanDrawing& drawing_;
  DrawTarget target_;
  VulkanBuffer reference_, tested_, ids_, counts_, launch_, results_;
};

}  // namespace sightline
