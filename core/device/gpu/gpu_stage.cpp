#include "core/device/gpu/gpu_stage.h"

namespace sightline {
namespace {

struct Names {
  const char *kernel, *shader;
};

/// In the order of GpuStage.
constexpr Names kNames[] = {
    {"traceRandom", "trace_random"},
    {"countMissing", "count_missing"},
    {"traceBorder", "trace_border"},
    {"traceGvsBorder", "trace_gvs_border"},
    {"traceReverse", "trace_reverse"},
    {"traceRaysKernel", "trace_rays"},
    {"traceViewsKernel", "trace_views"},
    {"traceGlass", "trace_glass"},
    {"countBits", "count_bits"},
    {"sumBlocks", "sum_blocks"},
    {"writeIndices", "write_indices"},
    {"countBorderRays", "count_border_rays"},
    {"sumBorderRays", "sum_border_rays"},
    {"borderEdges", "border_edges"},
    {"thinDiscontinuities", "thin_discontinuities"},
    {"appendDiscontinuities", "append_discontinuities"},
    {"reverseItems", "reverse_items"},
    {"appendEntries", "append_entries"},
    {"insertContained", "insert_contained"},
    {"rehash", "rehash"},
};
static_assert(sizeof kNames / sizeof *kNames == kGpuStages);

}  // namespace

const char* kernelName(GpuStage stage) {
  return kNames[uint32_t(stage)].kernel;
}

const char* shaderName(GpuStage stage) {
  return kNames[uint32_t(stage)].shader;
}

}  // namespace sightline
