// Which voxels of blocks of 64 x 64 x 64 meet triangles: a work group a block. Rows that rounding leaves open are
// listed for the host. One program of its own: bakes need not compile it.
#include "core/shared/voxel_planes.h"

// Rows of a triangle's box in a block: with more, the whole group works on it.
#define ROWS_ALONE 24
#define MOST_GROUP 256
#define ALL_ROWS 0xffffffffu

// Words of `counters`: how many were needed, also beyond capacity.
#define COUNT_BRICKS 0
#define COUNT_OPEN 1

typedef struct Target {
  volatile __local uint* bits;  // two words a row, row y + 64 z
  volatile __global uint* counters;
  __global uint2* open;
  uint open_capacity;
} Target;

static inline void listOpen(const Target* target, uint pair, uint row) {
  const uint place = atomic_inc(&target->counters[COUNT_OPEN]);
  if (place < target->open_capacity) target->open[place] = (uint2)(pair, row);
}

static inline void setRow(const Target* target, int y, int z, int low, int high) {
  if (low > high) return;
  const ulong bits = (~0ul << low) & (~0ul >> (63 - high));
  const int word = 2 * (y + 64 * z);
  if ((uint)bits != 0) atomic_or(&target->bits[word], (uint)bits);
  if ((uint)(bits >> 32) != 0) atomic_or(&target->bits[word + 1], (uint)(bits >> 32));
}

static inline uint rowsOf(VoxelTriangle t) {
  if (t.low.x > t.high.x || t.low.y > t.high.y || t.low.z > t.high.z) return 0;
  return (uint)((t.high.y - t.low.y + 1) * (t.high.z - t.low.z + 1));
}

// Every `lanes`-th row from `lane` on.
static inline void setRows(const Target* target, const VoxelTriangle* t, const VoxelPlanes* planes, uint pair, uint lane,
                           uint lanes) {
  if (planes->empty) return;
  if (planes->open) {
    if (lane == 0) listOpen(target, pair, ALL_ROWS);
    return;
  }
  const uint rows = rowsOf(*t);
  const uint width = (uint)(t->high.y - t->low.y + 1);
  for (uint row = lane; row < rows; row += lanes) {
    const int y = t->low.y + (int)(row % width);
    const int z = t->low.z + (int)(row / width);
    const VoxelRun run = rowOf(*planes, *t, y, z);
    if (run.open) {
      listOpen(target, pair, (uint)(y + 64 * z));
    } else {
      setRow(target, y, z, run.low, run.high);
    }
  }
}

static inline void setTriangle(const Target* target, const VoxelTriangle* t, uint pair, uint lane, uint lanes) {
  VoxelPlanes planes;
#if SL_SEPARATION == 0
  planes.count = 0;
  planes.empty = false;
  planes.open = false;
  if (!t->straight) planes = meetingPlanes(*t);
  setRows(target, t, &planes, pair, lane, lanes);
#else
  for (int family = 0; family < (SL_SEPARATION == 6 ? 3 : 4); ++family) {
    AxisSigns along = axisAlong(family);
#if SL_SEPARATION == 26
    along.x = (family & 1) != 0 ? -1 : 1;
    along.y = (family & 2) != 0 ? -1 : 1;
    along.z = 1;
#endif
    planes = targetPlanes(*t, along);
    setRows(target, t, &planes, pair, lane, lanes);
  }
#endif
}

static inline RealPoint cornerAt(__global const float* positions, uint vertex, float voxels_a_unit) {
  const SL_REAL scale = slReal(voxels_a_unit);
  return realPoint(slReal(positions[3 * (ulong)vertex]) * scale, slReal(positions[3 * (ulong)vertex + 1]) * scale,
                   slReal(positions[3 * (ulong)vertex + 2]) * scale);
}

static inline VoxelTriangle triangleAt(__global const float* positions, __global const uint* triangles, uint id,
                                       float voxels_a_unit, VoxelPlace base) {
  const RealPoint a = cornerAt(positions, triangles[3 * (ulong)id], voxels_a_unit);
  const RealPoint b = cornerAt(positions, triangles[3 * (ulong)id + 1], voxels_a_unit);
  const RealPoint c = cornerAt(positions, triangles[3 * (ulong)id + 2], voxels_a_unit);
  return voxelTriangle(a, b, c, base);
}

// Eight rows' bytes: word z of brick `brick` (core/voxel/voxel_grid.h).
static inline ulong brickWord(const Target* target, uint brick, uint z) {
  const uint x = brick & 7u;
  const uint row = 8u * ((brick >> 3) & 7u) + 64u * (8u * (brick >> 6) + z);
  ulong word = 0;
  for (uint y = 0; y < 8; ++y) {
    const uint byte = (target->bits[2u * (row + y) + (x >> 2)] >> (8u * (x & 3u))) & 0xffu;
    word |= (ulong)byte << (8u * y);
  }
  return word;
}

__kernel void voxelizeBlocks(__global const float* positions, __global const uint* triangles, float voxels_a_unit,
                             __global const int4* places, __global const uint* first_pair, __global const uint* pairs,
                             uint brick_capacity, uint open_capacity, __global ulong* bricks,
                             __global uint* first_brick, __global uint* brick_masks, __global uint2* open,
                             volatile __global uint* counters) {
  __local uint bits[2 * 64 * 64];
  __local uint large[MOST_GROUP];
  __local uint large_count;
  __local uint mask[16];
  __local uint brick_base;
  const uint lane = (uint)get_local_id(0);
  const uint lanes = (uint)get_local_size(0);
  const uint block = (uint)get_group_id(0);
  const Target target = {bits, counters, open, open_capacity};
  for (uint i = lane; i < 2 * 64 * 64; i += lanes) bits[i] = 0;
  for (uint i = lane; i < 16; i += lanes) mask[i] = 0;
  const VoxelPlace base = {64 * places[block].x, 64 * places[block].y, 64 * places[block].z};
  const uint end = first_pair[block + 1];
  for (uint begin = first_pair[block]; begin < end; begin += lanes) {
    if (lane == 0) large_count = 0;
    barrier(CLK_LOCAL_MEM_FENCE);
    const uint pair = begin + lane;
    if (pair < end) {
      const VoxelTriangle t = triangleAt(positions, triangles, pairs[pair], voxels_a_unit, base);
      // An open normal matters only where the triangle's box alone does not tell.
      if (t.open && (SL_SEPARATION != 0 || !t.straight)) {
        listOpen(&target, pair, ALL_ROWS);
      } else if (rowsOf(t) > ROWS_ALONE) {
        large[atomic_inc(&large_count)] = pair;
      } else {
        setTriangle(&target, &t, pair, 0, 1);
      }
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    const uint count = large_count;
    for (uint i = 0; i < count; ++i) {
      const VoxelTriangle t = triangleAt(positions, triangles, pairs[large[i]], voxels_a_unit, base);
      setTriangle(&target, &t, large[i], lane, lanes);
    }
    barrier(CLK_LOCAL_MEM_FENCE);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  for (uint brick = lane; brick < 512; brick += lanes) {
    ulong any = 0;
    for (uint z = 0; z < 8; ++z) any |= brickWord(&target, brick, z);
    if (any != 0) atomic_or(&mask[brick >> 5], 1u << (brick & 31u));
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  if (lane == 0) {
    uint count = 0;
    for (uint i = 0; i < 16; ++i) count += popcount(mask[i]);
    brick_base = atomic_add(&counters[COUNT_BRICKS], count);
    first_brick[block] = brick_base;
  }
  for (uint i = lane; i < 16; i += lanes) brick_masks[16 * block + i] = mask[i];
  barrier(CLK_LOCAL_MEM_FENCE);
  for (uint brick = lane; brick < 512; brick += lanes) {
    const uint word = brick >> 5;
    if ((mask[word] >> (brick & 31u) & 1u) == 0) continue;
    uint place = brick_base + popcount(mask[word] & ((1u << (brick & 31u)) - 1u));
    for (uint i = 0; i < word; ++i) place += popcount(mask[i]);
    if (place >= brick_capacity) continue;
    for (uint z = 0; z < 8; ++z) bricks[8 * (ulong)place + z] = brickWord(&target, brick, z);
  }
}
