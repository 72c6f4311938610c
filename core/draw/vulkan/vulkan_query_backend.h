#pragma once
#include "core/draw/query_backend.h"
#include "core/draw/vulkan/vulkan_drawing.h"

namespace sightline {

/// Draws and occlusion queries of a Vulkan device. Each submit is one render pass: its draws, then its
/// queries. Within a pass tests of depth follow the order of drawing, so the queries need no barrier to see
/// the draws; passes wait for each other's images. Whether answers have arrived is asked of the driver
/// without waiting.
class VulkanQueryBackend : public QueryBackend {
 public:
  explicit VulkanQueryBackend(VulkanDrawing& drawing) : drawing_(drawing) {}

  void beginFrame(const Camera& camera) override;
  QueryId submit(std::span<const uint32_t> draws, std::span<const OcclusionQuery> queries) override;
  void submitList(uint32_t list) override;
  bool arrived(QueryId query) override;
  bool visible(QueryId query) override;
  void endFrame() override { drawing_.endFrame(); }

 private:
  struct Submitted {
    QueryId first = 0;
    uint64_t frame = 0, serial = 0;
    CommandRing::Entry* entry = nullptr;
    std::shared_ptr<CommandRing::Answers> answers;
  };
  Submitted& of(QueryId query);

  VulkanDrawing& drawing_;
  std::deque<Submitted> submitted_;  ///< with queries, of this frame and the one before
  QueryId next_ = 0;
};

}  // namespace sightline
