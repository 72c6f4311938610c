#pragma once
#include <cstring>
#include <string>
#include <vector>

#include "core/device/vulkan/tracing_needs.h"
#include "core/device/vulkan/vulkan_runner.h"
#include "core/device/vulkan/vulkan_scene.h"
#include "core/sampling/random_segment.h"

namespace sightline {

/// Traces on a Vulkan device with rays and hits in its memory: for benchmarks.
class VulkanTracer {
 public:
  VulkanTracer(const std::string& device, const Scene& scene, const Bvh& bvh, uvec4 shifts)
      : context_(device, tracingNeeds(false)),
        runner_(context_),
        scene_(uploadVulkanScene(context_, scene, bvh, 0)),
        slots_stage_(tracingStage(context_, "trace_slots", 64)),
        rays_stage_(tracingStage(context_, "trace_rays", 64)) {
    scene_.describe(runner_);
    runner_.launch.numbers.shifts = shifts;
  }

  /// Random rays that traceSegments generates and traces.
  void addSegment(RandomSegment segment, const Face& face) {
    segment.range.x = 0;
    VulkanBuffer face_buffer = context_.buffer(sizeof face, "face");
    runner_.commands.update(face_buffer, &face, sizeof face);
    runner_.commands.finish();
    VulkanBuffer hits = context_.buffer(slotCount(segment) * sizeof(Hit), "hits");
    segments_.push_back({segment, std::move(face_buffer), std::move(hits)});
  }

  /// Rays that traceRays traces.
  void setRays(const std::vector<Ray>& rays) {
    ray_count_ = static_cast<uint32_t>(rays.size());
    rays_ = context_.buffer(rays.size() * sizeof(Ray), "rays");
    ray_hits_ = context_.buffer(rays.size() * sizeof(Hit), "hits");
    VulkanUpload upload(context_);
    upload.write(rays_, rays.data(), rays.size() * sizeof(Ray));
    upload.finish();
  }

  void traceSegments() {
    for (const Segment& segment : segments_) {
      runner_.launch.numbers.segment = segment.segment;
      runner_.bind(StageBuffer::faces, segment.face);
      runner_.bind(StageBuffer::hits, segment.hits);
      runner_.run(slots_stage_, static_cast<uint32_t>(slotCount(segment.segment)));
    }
    runner_.commands.finish();
  }

  void traceRays() {
    runner_.bind(StageBuffer::rays, rays_);
    runner_.bind(StageBuffer::hits, ray_hits_);
    runner_.run(rays_stage_, ray_count_);
    runner_.commands.finish();
  }

  /// One a slot; slots without a ray hold anything.
  std::vector<Hit> segmentHits(size_t i) { return read(segments_[i].hits, slotCount(segments_[i].segment)); }
  std::vector<Hit> rayHits() { return read(ray_hits_, ray_count_); }

 private:
  struct Segment {
    RandomSegment segment;
    VulkanBuffer face, hits;
  };

  std::vector<Hit> read(const VulkanBuffer& buffer, uint64_t count) {
    const VulkanBuffer staging = context_.buffer(count * sizeof(Hit), "hits", VulkanMemory::kReadback);
    runner_.commands.copy(buffer, staging, count * sizeof(Hit));
    runner_.commands.finish();
    std::vector<Hit> hits(count);
    std::memcpy(hits.data(), staging.mapped(), count * sizeof(Hit));
    return hits;
  }

  VulkanContext context_;
  VulkanRunner runner_;
  VulkanScene scene_;
  VulkanStage slots_stage_, rays_stage_;
  std::vector<Segment> segments_;
  VulkanBuffer rays_, ray_hits_;
  uint32_t ray_count_ = 0;
};

}  // namespace sightline
