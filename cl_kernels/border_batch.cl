// What border and reverse rays share is made before they are traced: polygons, where each entry's rays begin,
// and lists of discontinuities.
#include "cl_kernels/sampling_state.cl"

/// Counts the border rays of each of `count` entries from `first` on, and of each block of kBorderBlock.
__kernel void countBorderRays(SL_SCENE_ARGS, SL_CORNER_ARGS, StageParams params,
                              __global const PvsEntry* entries, uint first, uint count, uint block_count,
                              __global uint* starts, __global uint* block_counts) {
  const SceneRef scene = SL_SCENE_PACK;
  const uint block = (uint)get_global_id(0);
  if (block >= block_count) return;
  uint rays = 0;
  for (uint i = block * kBorderBlock; i < min((block + 1) * kBorderBlock, count); ++i) {
    const uint4 entry = entries[first + i].origin_triangle;
    const Corners t = triangleCorners(scene, record_of, entry.w);
    starts[i] = borderRayCount(borderSamples(t.a, t.b, t.c, as_float4(entry).xyz, params), params);
    rays += starts[i];
  }
  block_counts[block] = rays;
}

/// Makes of the counts of rays, and the sums before each block, the sums before each of `count` entries and
/// the sum of all.
__kernel void sumBorderRays(uint count, uint block_count, __global const uint* block_starts,
                            __global uint* starts) {
  const uint block = (uint)get_global_id(0);
  if (block >= block_count) return;
  uint before = block_starts[block];
  for (uint i = block * kBorderBlock; i < min((block + 1) * kBorderBlock, count); ++i) {
    const uint rays = starts[i];
    starts[i] = before;
    before += rays;
  }
  if (block == block_count - 1) starts[count] = before;
}

/// The sides of the border polygons of the entries from `first` on, three an entry.
__kernel void borderEdges(SL_SCENE_ARGS, SL_CORNER_ARGS, StageParams params, __global const PvsEntry* entries,
                          uint first, uint side_count, __global BorderEdge* edges) {
  const SceneRef scene = SL_SCENE_PACK;
  const uint i = (uint)get_global_id(0);
  if (i >= side_count) return;
  const uint4 entry = entries[first + i / 3].origin_triangle;
  const Corners t = triangleCorners(scene, record_of, entry.w);
  edges[i] = borderEdge(t.a, t.b, t.c, i % 3, as_float4(entry).xyz, params);
}

/// Of the batch's rays that met a discontinuity, a bit each, those that keepsDiscontinuity names.
__kernel void thinDiscontinuities(StageParams params, SL_BORDER_ARGS, __global const uint* border_hits,
                                  __global const uint* bits, uint word_count, __global uint* kept) {
  const BorderBatch batch = SL_BORDER_PACK;
  const uint word = (uint)get_global_id(0);
  if (word >= word_count) return;
  uint result = 0;
  if (bits[word] != 0) {
    uint entry = borderEntryOf(batch, word * 32);
    bool before = word > 0 && bits[word - 1] >> 31 != 0;
    for (uint bit = 0; bit < 32; ++bit) {
      const bool here = (bits[word] >> bit & 1) != 0;
      const uint index = word * 32 + bit;
      if (here) {
        entry = nextBorderEntry(batch, entry, index);
        const uint place = borderPlace(index - starts[entry], slUint(edges[entry * 3].bisector.w));
        const bool follows = place > 0 && before && border_hits[index - 1] == border_hits[index];
        result |= (keepsDiscontinuity(place, follows, params) ? 1u : 0u) << bit;
      }
      before = here;
    }
  }
  kept[word] = result;
}

/// Appends the discontinuities of `count` border rays of the batch to the list from `end` on.
__kernel void appendDiscontinuities(SL_BORDER_ARGS, __global const uint* border_hits,
                                    __global const uint* indices, uint count,
                                    __global Discontinuity* discontinuities, uint end) {
  const BorderBatch batch = SL_BORDER_PACK;
  const uint i = (uint)get_global_id(0);
  if (i >= count) return;
  const uint index = indices[i];
  const uint entry = borderEntryOf(batch, index);
  Discontinuity discontinuity;
  discontinuity.ray = (uint4)(border_first + entry, index - starts[entry], border_hits[index],
                              slUint(edges[entry * 3].bisector.w));
  discontinuities[end + i] = discontinuity;
}

/// The items of the discontinuities from `first` on, for their reverse rays. items_before: discontinuities of
/// the cell before the list.
__kernel void reverseItems(SL_SCENE_ARGS, SL_CORNER_ARGS, __global const Face* faces, StageParams params,
                           __global const PvsEntry* entries, __global const Discontinuity* discontinuities,
                           uint first, uint count, ulong items_before, __global ReverseItem* items) {
  const SceneRef scene = SL_SCENE_PACK;
  const uint i = (uint)get_global_id(0);
  if (i >= count) return;
  items[i] = reverseItemOf(scene, record_of, entries, faces, params, discontinuities[first + i],
                           items_before + first + i);
}
