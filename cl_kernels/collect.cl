// From bits to lists, in ascending order whatever the scheduling: count the bits of each block of words, sum
// up over the blocks, write. Used for the triangles that are new in a batch and for the discontinuities.
#include "cl_kernels/sampling_state.cl"

/// Words of 32 bits that one work item counts and writes.
#define SL_BLOCK_WORDS 64
/// Work items of the one group that sums up the blocks.
#define SL_SUM_ITEMS 64

__kernel void countBits(__global const uint* words, uint word_count, uint block_count,
                        __global uint* block_counts) {
  const uint block = (uint)get_global_id(0);
  if (block >= block_count) return;
  const uint begin = block * SL_BLOCK_WORDS;
  uint count = 0;
  for (uint i = begin; i < min(begin + SL_BLOCK_WORDS, word_count); ++i) count += popcount(words[i]);
  block_counts[block] = count;
}

/// Exclusive sums of the block counts in place, by one work group; the total goes to
/// block_counts[block_count] and, unless place is 0, to a word of the counters.
__kernel __attribute__((reqd_work_group_size(SL_SUM_ITEMS, 1, 1))) void sumBlocks(__global uint* block_counts,
                                                                                  uint block_count,
                                                                                  __global uint* counters,
                                                                                  uint place) {
  __local uint partial[SL_SUM_ITEMS];
  const uint item = (uint)get_local_id(0), items = SL_SUM_ITEMS;
  const uint share = (block_count + items - 1) / items;
  const uint begin = min(item * share, block_count), end = min(begin + share, block_count);
  uint sum = 0;
  for (uint i = begin; i < end; ++i) sum += block_counts[i];
  partial[item] = sum;
  barrier(CLK_LOCAL_MEM_FENCE);
  uint running = 0;
  for (uint i = 0; i < item; ++i) running += partial[i];
  for (uint i = begin; i < end; ++i) {
    const uint count = block_counts[i];
    block_counts[i] = running;
    running += count;
  }
  if (item != items - 1) return;
  block_counts[block_count] = running;
  if (place != 0) counters[place] = running;
}

/// Writes the indices of the set bits and clears them.
__kernel void writeIndices(__global uint* words, uint word_count, uint block_count,
                           __global const uint* block_starts, __global uint* indices) {
  const uint block = (uint)get_global_id(0);
  if (block >= block_count) return;
  uint place = block_starts[block];
  for (uint i = block * SL_BLOCK_WORDS; i < min((block + 1) * SL_BLOCK_WORDS, word_count); ++i) {
    for (uint bits = words[i]; bits != 0; bits &= bits - 1)
      indices[place++] = i * 32 + (31 - clz(bits & -bits));
    words[i] = 0;
  }
}

/// The ray with this index (1 ..) among a batch's random segments.
static inline Ray segmentRayAt(__global const RandomSegment* segments, uint segment_count,
                               __global const Face* faces, StageParams params, uint index) {
  for (uint s = 0; s < segment_count; ++s) {
    const RandomSegment segment = segments[s];
    const uint offset = index - segment.batch.x;
    if (offset < segment.range.w) {
      return randomRay(segmentFirst(segment), offset, faces[segment.range.x], params.shifts);
    }
  }
  return noRay();
}

/// Appends the new triangles of a batch, whose ids are in `triangles`, to the list from entry `end` on, each
/// with the ray that won it, and marks their slots as old.
__kernel void appendEntries(SL_SET_ARGS, __global const Face* faces, StageParams params,
                            __global PvsEntry* list, uint end, __global const uint* triangles, uint count,
                            uint stage, __global const RandomSegment* segments, uint segment_count,
                            SL_BORDER_ARGS, __global const ReverseItem* items) {
  const SetRef set = SL_SET_PACK;
  const uint i = (uint)get_global_id(0);
  if (i >= count) return;
  const uint triangle = triangles[i];
  const uint slot = findSlot(set, triangle);
  const uint index = winner[slot];
  winner[slot] = kSlotOld;
  Ray ray;
  if (stage == kStageRandom) {
    ray = segmentRayAt(segments, segment_count, faces, params, index);
  } else if (stage == kStageBorder) {
    const BorderBatch batch = SL_BORDER_PACK;
    const uint place = borderEntryOf(batch, index - 1);
    ray = borderRayAt(batch, params, place, index - 1 - starts[place]);
  } else {
    ray = reverseRayAt(items, faces, params, index - 1);
  }
  PvsEntry entry;
  entry.origin_triangle = (uint4)(as_uint3(ray.origin.xyz), triangle);
  entry.direction_stage = (uint4)(as_uint3(ray.direction.xyz), stage);
  list[end + i] = entry;
}

/// Puts triangles into the set and the list without a ray.
__kernel void insertContained(SL_SET_ARGS, __global PvsEntry* entries, uint end,
                              __global const uint* triangles, uint count) {
  const SetRef set = SL_SET_PACK;
  const uint i = (uint)get_global_id(0);
  if (i >= count) return;
  const uint slot = claimSlot(set, triangles[i]);
  if (slot == kSlotEmpty) {
    atomic_add(overflow, 1u);
    return;
  }
  winner[slot] = kSlotOld;
  PvsEntry entry;
  entry.origin_triangle = (uint4)(0, 0, 0, triangles[i]);
  entry.direction_stage = (uint4)(0, 0, 0, kStageContained);
  entries[end + i] = entry;
}

/// Moves the contents of a hash set into a larger one.
__kernel void rehash(__global const uint* old_keys, __global const uint* old_winner, uint old_capacity,
                     SL_SET_ARGS) {
  const SetRef set = SL_SET_PACK;
  const uint i = (uint)get_global_id(0);
  if (i >= old_capacity || old_keys[i] == kNoTriangle) return;
  const uint slot = claimSlot(set, old_keys[i]);
  if (slot == kSlotEmpty) {
    atomic_add(overflow, 1u);
    return;
  }
  winner[slot] = old_winner[i];
}
