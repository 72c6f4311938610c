// The kernels over lists, a work item each (core/shared/list_stages.inl).
#include "cl_kernels/stage.cl"

#define SL_LIST_KERNEL(name, of_item)                   \
  __kernel void name(SL_STAGE_ARGS) {                   \
    SL_STAGE_PACK                                       \
    const uint item = (uint)get_global_id(0);           \
    if (item < launch.item_count) of_item(&stage, item); \
  }

SL_LIST_KERNEL(countBits, countBitsOf)
SL_LIST_KERNEL(writeIndices, writeIndicesOf)
SL_LIST_KERNEL(countBorderRays, countBorderRaysOf)
SL_LIST_KERNEL(sumBorderRays, sumBorderRaysOf)
SL_LIST_KERNEL(borderEdges, makeBorderEdge)
SL_LIST_KERNEL(thinDiscontinuities, thinDiscontinuitiesOf)
SL_LIST_KERNEL(appendDiscontinuities, appendDiscontinuityOf)
SL_LIST_KERNEL(reverseItems, makeReverseItem)
SL_LIST_KERNEL(insertContained, insertContainedOf)
SL_LIST_KERNEL(rehash, rehashOf)

static inline void appendWinner(const StageRef* stage, uint item) {
  appendEntryOf(stage, item, batchRayAt(stage, takeWinner(stage, item)));
}
SL_LIST_KERNEL(appendEntries, appendWinner)

/// By one work group.
__kernel __attribute__((reqd_work_group_size(SL_SUM_ITEMS, 1, 1))) void sumBlocks(SL_STAGE_ARGS) {
  SL_STAGE_PACK
  __local uint partial[SL_SUM_ITEMS];
  const uint item = (uint)get_local_id(0);
  partial[item] = sumOfShare(&stage, item);
  barrier(CLK_LOCAL_MEM_FENCE);
  uint before = 0;
  for (uint i = 0; i < item; ++i) before += partial[i];
  writeShare(&stage, item, before);
}
