#pragma once
#include "core/draw/cull_method.h"
#include "core/draw/vulkan/cull_units.h"
#include "core/draw/vulkan/drawing_needs.h"
#include "core/draw/vulkan/vulkan_drawing.h"

namespace sightline {

/// Faults for tests of tests: each must be found by the comparison of depth.
struct GpuCullingFaults {
  bool no_second_pass = false;
  bool floor_levels = false;   ///< levels of the pyramid drop odd columns and rows
  uint32_t shrink_pixels = 0;  ///< boxes are so much smaller, all around
};

struct GpuCullingOptions {
  bool mesh_shaders = true;  ///< for meshlets, where the device has them; else by lists of draws
  GpuCullingFaults faults = {};
};

/// Why the drawing cannot cull by the method, in one line: what its device lacks, or what its scene has;
/// empty: it can.
std::string whyNotCull(const VulkanDrawing& drawing, GpuMethod method);

/// Culls on the GPU in two passes: what was seen in the frame before is drawn at once; what that hides is
/// found, by a pyramid of its depth or by drawn boxes; what is seen and was not drawn is drawn then. The
/// processor submits once a frame, whatever is seen, and waits for nothing; what it submits is recorded once
/// for all frames, but for those whose candidates are new.
///
/// Based on: the two passes of S. Hill and D. Collin, Practical, Dynamic Visibility for Games, GPU Pro 2,
/// 2011, and of U. Haar and S. Aaltonen, GPU-Driven Rendering Pipelines, SIGGRAPH 2015. Where we differ: the
/// pyramid is exact at all sizes (core/shared/pyramid.h), and boxes are guarded against the device's
/// roundings (core/shared/box_extent.h), so that no pixel differs from the picture of all drawables. Blended
/// ones are drawn last, sorted on the processor by the distance of their boxes' centres along the view, of
/// equally far ones that with the higher number first (FrameRecorder).
class GpuCulling {
 public:
  /// The drawing must live as long. Throws Error that names what the device lacks, or what does not fit.
  GpuCulling(VulkanDrawing& drawing, GpuMethod method, const GpuCullingOptions& options = {});

  GpuCulling(const GpuCulling&) = delete;
  GpuCulling& operator=(const GpuCulling&) = delete;
  ~GpuCulling();

  /// Draws a frame.
  void drawFrame(const Camera& camera);
  /// Draws a frame of some drawables only, in any order; perhaps none. changed: they are other than in the
  /// last such frame (so that a set is copied when its cell is entered, not in each frame).
  void drawFrame(const Camera& camera, std::span<const uint32_t> candidates, bool changed);
  /// As if just made.
  void forget() { forget_ = true; }

  /// Of the last frame: draws, objects (meshlets where they are the units), triangles, submits. Waits until
  /// it has run.
  FrameCounts counts();
  bool usesMeshShaders() const { return meshes_; }
  uint32_t unitCount() const { return uint32_t(units_.units.size()); }
  /// Which units the last frame's test found to be seen, 1 or 0 a unit. Waits until it has run.
  std::vector<uint32_t> readSeen();
  const CullUnits& units() const { return units_; }

  /// With mesh shaders, records the draws of all meshlets in a pass: what the method is compared with.
  void drawAll(VkCommandBuffer commands);

 private:
  struct Range {
    uint32_t first, count;
  };
  Range range(AlphaKind kind) const {
    return {units_.ends[size_t(kind)], units_.ends[size_t(kind) + 1] - units_.ends[size_t(kind)]};
  }
  VkDeviceAddress address() const { return launch_.address(); }
  void createBuffers();
  uint32_t opaqueKind() const;  ///< of write_draws.comp
  void drawAmong(const Camera& camera, const std::span<const uint32_t>* candidates, bool changed);
  /// Buffers for the drawing's images; a new key where what is recorded differs.
  void fit(bool restricted);
  void record(CommandRing::Entry& entry, std::span<const uint32_t> new_candidates);
  /// new_candidates: a bit a drawable; empty: they are as before, or all.
  void prepare(VkCommandBuffer commands, std::span<const uint32_t> new_candidates);
  std::vector<uint32_t> blendedOrder() const;
  void test(VkCommandBuffer commands, Range range, uint32_t list, uint32_t test);
  void writeDraws(VkCommandBuffer commands, Range range, uint32_t list, uint32_t kind);
  void drawOpaque(VkCommandBuffer commands, uint32_t list);
  void buildPyramid(VkCommandBuffer commands);
  void testByBoxes(CommandRing::Entry& entry);
  void testLate(CommandRing::Entry& entry);
  void drawLate(CommandRing::Entry& entry);
  void between(VkCommandBuffer commands) const;

  VulkanDrawing& drawing_;
  GpuMethod method_;
  GpuCullingFaults faults_;
  CullUnits units_;
  bool meshes_ = false, forget_ = true, restricted_ = false;
  CullLaunch numbers_{};
  uint64_t pyramid_texels_ = 0;
  /// What the commands of frames with the same key have in common.
  struct Kept {
    uint64_t targets = 0;
    bool restricted = false;
    VkDeviceAddress pyramid = 0;
    bool operator==(const Kept&) const = default;
  };
  Kept kept_;
  uint64_t key_ = 0;
  CommandRing::Entry* last_ = nullptr;
  uint64_t last_serial_ = 0;
  VulkanBuffer launch_, unit_buffer_, states_, block_counts_, draws_, listed_, heads_, pyramid_, candidates_,
      meshlets_, indices_, order_;
};

}  // namespace sightline
