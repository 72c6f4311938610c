// The kernels over lists, a work item each (core/shared/list_stages.inl).
#include "cl_kernels/stage.cl"

#define SL_COUNT_BITS(X) X(words) X(block_counts)
SL_STAGE_KERNEL(countBits, countBitsOf, SL_COUNT_BITS)

#define SL_WRITE_INDICES(X) X(words) X(block_counts) X(indices)
SL_STAGE_KERNEL(writeIndices, writeIndicesOf, SL_WRITE_INDICES)

#define SL_COUNT_BORDER_RAYS(X) X(place_of) X(entries) X(border_starts) X(block_counts)
SL_STAGE_KERNEL(countBorderRays, countBorderRaysOf, SL_COUNT_BORDER_RAYS)

#define SL_SUM_BORDER_RAYS(X) X(border_starts) X(block_counts)
SL_STAGE_KERNEL(sumBorderRays, sumBorderRaysOf, SL_SUM_BORDER_RAYS)

#define SL_BORDER_EDGES(X) X(place_of) X(entries) X(border_edges)
SL_STAGE_KERNEL(borderEdges, makeBorderEdge, SL_BORDER_EDGES)

#define SL_THIN_DISCONTINUITIES(X) X(border_starts) X(border_edges) X(border_hits) X(bits) X(kept_bits)
SL_STAGE_KERNEL(thinDiscontinuities, thinDiscontinuitiesOf, SL_THIN_DISCONTINUITIES)

#define SL_APPEND_DISCONTINUITIES(X) \
  X(border_starts) X(border_edges) X(border_hits) X(discontinuities) X(indices)
SL_STAGE_KERNEL(appendDiscontinuities, appendDiscontinuityOf, SL_APPEND_DISCONTINUITIES)

#define SL_REVERSE_ITEMS(X) X(faces) X(place_of) X(entries) X(discontinuities) X(reverse_items)
SL_STAGE_KERNEL(reverseItems, makeReverseItem, SL_REVERSE_ITEMS)

#define SL_INSERT_CONTAINED(X) SL_SET_BUFFERS(X) X(entries) X(indices)
SL_STAGE_KERNEL(insertContained, insertContainedOf, SL_INSERT_CONTAINED)

#define SL_REHASH(X) SL_SET_BUFFERS(X) X(old_keys) X(old_winner)
SL_STAGE_KERNEL(rehash, rehashOf, SL_REHASH)

static inline void appendWinner(const StageRef* stage, uint item) {
  appendEntryOf(stage, item, batchRayAt(stage, takeWinner(stage, item)));
}
#define SL_APPEND_ENTRIES(X) \
  SL_SET_BUFFERS(X) X(faces) X(entries) X(segments) X(border_starts) X(border_edges) X(reverse_items) X(indices)
SL_STAGE_KERNEL(appendEntries, appendWinner, SL_APPEND_ENTRIES)

#define SL_SUM_BLOCKS(X) X(counters) X(block_counts)
/// By one work group.
__kernel __attribute__((reqd_work_group_size(SL_SUM_ITEMS, 1, 1))) void sumBlocks(SL_STAGE_ARGS(SL_SUM_BLOCKS)) {
  SL_STAGE_PACK(SL_SUM_BLOCKS)
  __local uint partial[SL_SUM_ITEMS];
  const uint item = (uint)get_local_id(0);
  partial[item] = sumOfShare(&stage, item);
  barrier(CLK_LOCAL_MEM_FENCE);
  uint before = 0;
  for (uint i = 0; i < item; ++i) before += partial[i];
  writeShare(&stage, item, before);
}
