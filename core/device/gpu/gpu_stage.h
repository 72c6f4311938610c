#pragma once
#include <cstdint>

#include "core/shared/stage_launch.h"

namespace sightline {

/// The buffers that stages work on, by name: StageBuffer::faces, ...
#define SL_BUFFER_NAME(type, name) name,
enum class StageBuffer : uint32_t { SL_STAGE_BUFFERS(SL_BUFFER_NAME) };
#undef SL_BUFFER_NAME

/// What a GPU runs: a kernel of cl_kernels, a shader of vk_shaders. First those that trace rays, a work item
/// a ray; then those over lists, in groups of SL_LIST_GROUP.
enum class GpuStage : uint32_t {
  kTraceRandom,
  kCountMissing,
  kTraceBorder,
  kTraceGvsBorder,
  kTraceReverse,
  kTraceRays,
  kTraceViews,
  kTraceGlass,  ///< only where the scene has glass
  kCountBits,
  kSumBlocks,
  kWriteIndices,
  kCountBorderRays,
  kSumBorderRays,
  kBorderEdges,
  kThinDiscontinuities,
  kAppendDiscontinuities,
  kReverseItems,
  kAppendEntries,
  kInsertContained,
  kRehash,
};
inline constexpr uint32_t kGpuStages = uint32_t(GpuStage::kRehash) + 1;

inline bool tracesRays(GpuStage stage) {
  return stage < GpuStage::kCountBits;
}

/// The stage's kernel, "countBits", and its shader, "count_bits".
const char* kernelName(GpuStage stage);
const char* shaderName(GpuStage stage);

}  // namespace sightline
