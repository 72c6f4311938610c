#pragma once
#include "core/draw/vulkan/command_ring.h"
#include "core/draw/vulkan/draw_mesh.h"
#include "core/draw/vulkan/draw_programs.h"

namespace sightline {

struct DrawingOptions {
  uint64_t memory_budget = 0;  ///< bytes on the device; 0: what it has
  DrawClock clock = {};        ///< for times of the processor only: nothing else depends on it
  SubmitChain chain = SubmitChain::barriers;
};

/// A device that draws a scene's drawables into images in memory: what all methods share. One thread at a
/// time.
///
/// A frame is beginFrame, submits, endFrame. The GPU runs submits one after another, whoever waits.
class VulkanDrawing {
 public:
  /// selector: "vulkan", "vulkan:INDEX" or "vulkan:PART-OF-NAME". Scene, drawables and lists must live as
  /// long. Throws Error that names what the device lacks, or what does not fit.
  VulkanDrawing(const std::string& selector, const Scene& scene, const Drawables& drawables,
                const TriangleLists& lists = {}, const DrawingOptions& options = {});
  VulkanDrawing(const VulkanDrawing&) = delete;
  VulkanDrawing& operator=(const VulkanDrawing&) = delete;

  const VulkanContext& context() const { return context_; }
  const DrawMesh& mesh() const { return mesh_; }
  const Camera& camera() const { return launch_.camera; }
  const DrawPasses& passes() const { return passes_; }
  const DrawTarget& target() const { return target_; }
  DrawPrograms& programs() { return programs_; }
  CommandRing& ring() { return ring_; }

  /// Starts a frame, with images of the camera's size. Throws Error where they are too large.
  void beginFrame(const Camera& camera);
  /// Number of the frame, for CommandRing::gpuTimes: 1 for the first.
  uint64_t frame() const { return frame_; }
  /// Starts a submit of the frame.
  CommandRing::Entry& open(uint32_t queries = 0, uint64_t box_bytes = 0, uint64_t result_bytes = 0);
  /// The same for a frame of one submit, whose commands frames have in common: CommandRing::openKept. key: of
  /// another number when the images are others (targets()). data: the frame's own, which goes to `to`.
  CommandRing::Entry& openKept(uint64_t key, std::span<const uint32_t> data, const VulkanBuffer& to,
                               uint64_t result_bytes);
  /// Changes when the images do.
  uint64_t targets() const { return targets_; }
  /// A pass into the images: the frame's first starts anew.
  void beginPass(CommandRing::Entry& entry);
  void endPass(CommandRing::Entry& entry);
  void submit(CommandRing::Entry& entry);
  /// Draws nothing where nothing was drawn: the images are those of this frame in any case.
  void endFrame();

  DrawPush push(VkDeviceAddress other = 0, const uvec4& numbers = {}) const;
  /// Records the draw of a run, in a pass; binds what it takes unless `bound` already is.
  void draw(VkCommandBuffer commands, const SlotRun& run, uint32_t drawable, std::optional<AlphaKind>& bound);
  /// Records a barrier of memory.
  void barrier(VkCommandBuffer commands, VkPipelineStageFlags from, VkAccessFlags written,
               VkPipelineStageFlags to, VkAccessFlags used) const;

  /// The last frame's images, row after row from the top: drawables (kNoDrawable: none), reversed depth,
  /// glass (R in the lowest byte; A: how much of what is behind shows; empty without glass). Wait until all
  /// has run.
  std::vector<uint32_t> readIds() const { return read(target_, DrawTarget::Image::ids); }
  std::vector<float> readDepth() const { return readDepth(target_); }
  std::vector<uint32_t> readGlass() const;
  std::vector<uint32_t> read(const DrawTarget& target, DrawTarget::Image image) const;
  std::vector<float> readDepth(const DrawTarget& target) const;

 private:
  VulkanContext context_;
  DrawMesh mesh_;
  DrawPasses passes_;
  DrawPrograms programs_;
  DrawTarget target_;
  DrawLaunch launch_{};
  VulkanBuffer launch_buffer_;
  uint64_t frame_ = 0, targets_ = 0;
  bool described_ = false, drawn_ = false;  ///< in this frame
  CommandRing ring_;                        // goes, and waits, first
};

}  // namespace sightline
