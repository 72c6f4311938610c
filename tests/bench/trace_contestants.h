#pragma once
#include <tbb/parallel_for.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/device/opencl/opencl_scene.h"
#include "tests/bench/trace_workload.h"
#include "tests/bench/vulkan_tracer.h"

// The devices, as bench_trace races them.
namespace sightline {

/// One contestant: traces all rays of a kind; hits lie in the order of Workload's rays.
struct Contestant {
  std::string name;
  std::function<void()> trace_random, trace_border;
  std::function<std::vector<Hit>()> random_hits, border_hits;
};

/// Rays that a thread takes at once.
inline constexpr size_t kTraceChunk = 1024;

inline Contestant cpuContestant(const Workload& work) {
  auto tracer = std::make_shared<CpuTracer>(work.scene, work.bvh);
  auto random = std::make_shared<std::vector<Hit>>(work.random.size());
  auto border = std::make_shared<std::vector<Hit>>(work.border.size());
  const auto trace_run = [&work, tracer, random](const Run& run) {
    const uint64_t slots = slotCount(run.segment);
    tbb::parallel_for(uint64_t{0}, (slots + kTraceChunk - 1) / kTraceChunk, [&](uint64_t chunk) {
      std::vector<Ray> rays;
      std::vector<uint32_t> offsets;
      for (uint64_t s = chunk * kTraceChunk; s < std::min(slots, (chunk + 1) * kTraceChunk); ++s) {
        const uint32_t offset = slotOffset(run.segment, uint32_t(s));
        if (offset == kNoTriangle) continue;
        offsets.push_back(offset);
        rays.push_back(randomRay(segmentFirst(run.segment), offset, run.face, kShifts));
      }
      std::vector<Hit> hits(rays.size());
      tracer->tracePacket(rays.data(), hits.data(), int(rays.size()));
      for (size_t i = 0; i < hits.size(); ++i) (*random)[run.first + offsets[i]] = hits[i];
    });
  };
  return {
      "cpu",
      [&work, trace_run] {
        for (const Run& run : work.runs) trace_run(run);
      },
      [&work, tracer, border] {
        tbb::parallel_for(size_t{0}, (work.border.size() + kTraceChunk - 1) / kTraceChunk, [&](size_t chunk) {
          const size_t first = chunk * kTraceChunk, count = std::min(kTraceChunk, work.border.size() - first);
          tracer->tracePacket(&work.border[first], &(*border)[first], int(count));
        });
      },
      [random] { return *random; }, [border] { return *border; }};
}

/// Everything that the OpenCL contestant keeps on the device.
struct OpenClState {
  explicit OpenClState(const Workload& work, const std::string& device) : context(device) {
    buildKernels(context, raysPerItem(context));
    scene = uploadScene(context, work.scene, work.bvh, raysPerItem(context));
    segment_kernel = context.kernel("traceSegmentKernel");
    rays_kernel = context.kernel("traceRaysKernel");
    for (const Run& run : work.runs) {
      random_hits.push_back(context.buffer(slotCount(run.segment) * sizeof(Hit), "hits"));
    }
    border_rays = context.buffer(work.border.size() * sizeof(Ray), "border rays");
    border_hits = context.buffer(work.border.size() * sizeof(Hit), "hits");
    context.write(border_rays, work.border.data(), work.border.size() * sizeof(Ray));
  }
  uint64_t items(uint64_t rays) const { return (rays + raysPerItem(context) - 1) / raysPerItem(context); }

  OpenClContext context;
  OpenClScene scene;
  ClKernel segment_kernel, rays_kernel;
  std::vector<ClBuffer> random_hits;
  ClBuffer border_rays, border_hits;
};

inline Contestant openClContestant(const Workload& work, const std::string& device) {
  auto state = std::make_shared<OpenClState>(work, device);
  const uint32_t local = state->context.isCpu() ? 8 : 64;
  return {"opencl",
          [&work, state, local] {
            for (size_t i = 0; i < work.runs.size(); ++i) {
              const Run& run = work.runs[i];
              state->context.launch(state->segment_kernel, state->items(slotCount(run.segment)), local,
                                    state->scene.nodes, state->scene.triangles, state->scene.reach,
                                    run.segment, run.face, kShifts, state->random_hits[i]);
            }
            state->context.finish();
          },
          [&work, state, local] {
            const uint32_t count = uint32_t(work.border.size());
            state->context.launch(state->rays_kernel, state->items(count), local, state->scene.nodes,
                                  state->scene.triangles, state->scene.reach, state->border_rays,
                                  state->border_hits, count);
            state->context.finish();
          },
          [&work, state] {
            std::vector<Hit> hits(work.random.size());
            for (size_t i = 0; i < work.runs.size(); ++i) {
              const Run& run = work.runs[i];
              std::vector<Hit> by_slot(slotCount(run.segment));
              state->context.read(state->random_hits[i], by_slot.data(), by_slot.size() * sizeof(Hit));
              for (uint32_t slot = 0; slot < by_slot.size(); ++slot) {
                const uint32_t offset = slotOffset(run.segment, slot);
                if (offset != kNoTriangle) hits[run.first + offset] = by_slot[slot];
              }
            }
            return hits;
          },
          [&work, state] {
            std::vector<Hit> hits(work.border.size());
            state->context.read(state->border_hits, hits.data(), hits.size() * sizeof(Hit));
            return hits;
          }};
}

inline Contestant vulkanContestant(const Workload& work, const std::string& device) {
  auto tracer = std::make_shared<VulkanTracer>(device, work.scene, work.bvh, kShifts);
  for (const Run& run : work.runs) tracer->addSegment(run.segment, run.face);
  tracer->setRays(work.border);
  return {"vulkan", [tracer] { tracer->traceSegments(); }, [tracer] { tracer->traceRays(); },
          [&work, tracer] {
            std::vector<Hit> hits(work.random.size());
            for (size_t i = 0; i < work.runs.size(); ++i) {
              const Run& run = work.runs[i];
              const std::vector<Hit> by_slot = tracer->segmentHits(i);
              for (uint32_t slot = 0; slot < by_slot.size(); ++slot) {
                const uint32_t offset = slotOffset(run.segment, slot);
                if (offset != kNoTriangle) hits[run.first + offset] = by_slot[slot];
              }
            }
            return hits;
          },
          [tracer] { return tracer->rayHits(); }};
}

}  // namespace sightline
