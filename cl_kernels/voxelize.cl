// Which triangles meet which blocks of 64 x 64 x 64 voxels, and which of their voxels: there a work group a half of a block, the lower or the upper one,
// whose bits are in local memory. Rows that rounding leaves open are listed for the host. One program of its own:
// bakes need not compile it.
#include "core/shared/voxel_planes.h"

// Of voxels in a half of a block, and what that makes.
#define LAYERS 32
#define BRICKS (64 * LAYERS / 8)
#define MASK_WORDS (BRICKS / 32)
// Rows of a triangle's box in a half: with more, the whole group works on it.
#define ROWS_ALONE 24
#define MOST_GROUP 256
#define PLANES_A_TIME 8
#define ALL_ROWS 0xffffffffu

// Words of `counters`: how many were needed, also beyond capacity.
#define COUNT_BRICKS 0
#define COUNT_OPEN 1

typedef struct Target {
  volatile __local uint* bits;  // two words a row, row y + 64 z
  volatile __global uint* counters;
  __global uint2* open;
  uint open_capacity;
  uint first_row;  // of the half in its block
  __global const float* positions;
  __global const uint* triangles;
  __global const uint* pairs;
  float voxels_a_unit;
  VoxelPlace base;
} Target;

static inline void listOpen(const Target* target, uint pair, uint row) {
  const uint place = atomic_inc(&target->counters[COUNT_OPEN]);
  if (place < target->open_capacity)
    target->open[place] = (uint2)(pair, row == ALL_ROWS ? ALL_ROWS : target->first_row + row);
}

static inline void setRow(const Target* target, int y, int z, int low, int high) {
  if (low > high) return;
  const ulong bits = (~0ul << low) & (~0ul >> (63 - high));
  const int word = 2 * (y + 64 * z);
  if ((uint)bits != 0) atomic_or(&target->bits[word], (uint)bits);
  if ((uint)(bits >> 32) != 0) atomic_or(&target->bits[word + 1], (uint)(bits >> 32));
}

static inline RealPoint cornerAt(__global const float* positions, __global const uint* triangles, ulong corner,
                                 float a_unit) {
  const SL_REAL scale = slReal(a_unit);
  __global const float* p = positions + 3 * (ulong)triangles[corner];
  return realPoint(slReal(p[0]) * scale, slReal(p[1]) * scale, slReal(p[2]) * scale);
}

static inline VoxelTriangle triangleAt(const Target* target, uint pair) {
  const ulong corner = 3 * (ulong)target->pairs[pair];
  const VoxelPlace size = {64, 64, LAYERS};
  return voxelTriangle(cornerAt(target->positions, target->triangles, corner, target->voxels_a_unit),
                       cornerAt(target->positions, target->triangles, corner + 1, target->voxels_a_unit),
                       cornerAt(target->positions, target->triangles, corner + 2, target->voxels_a_unit), target->base,
                       size);
}

// A triangle's half spaces in a block, or those of one direction of its targets, and where its rows are.
typedef struct Planes {
  VoxelPlanes planes;
  SL_REAL inverse[SL_MOST_VOXEL_PLANES];
  uint pair;
  uint family;
} Planes;

static inline uint rowsOf(PlaceBox box) {
  if (box.low.x > box.high.x || box.low.y > box.high.y || box.low.z > box.high.z) return 0;
  return (uint)((box.high.y - box.low.y + 1) * (box.high.z - box.low.z + 1));
}

#if SL_SEPARATION == 0
#define FAMILIES 1
#elif SL_SEPARATION == 6
#define FAMILIES 3
#else
#define FAMILIES 4
#endif

static inline AxisSigns alongOf(uint family) {
  AxisSigns along = axisAlong((int)family);
#if SL_SEPARATION == 26
  along.x = (family & 1u) != 0 ? -1 : 1;
  along.y = (family & 2u) != 0 ? -1 : 1;
  along.z = 1;
#endif
  return along;
}

static inline Planes planesOf(const VoxelTriangle* t, uint pair, uint family) {
  Planes p;
#if SL_SEPARATION == 0
  p.planes.count = 0;
  p.planes.empty = false;
  p.planes.open = false;
  p.planes.box = t->box;
  if (!t->straight) p.planes = meetingPlanes(*t);
#else
  p.planes = targetPlanes(*t, alongOf(family));
#endif
  for (int i = 0; i < p.planes.count; ++i)
    p.inverse[i] = inverseOf(p.planes.at[i].factor.x, p.planes.at[i].rises.x);
  p.pair = pair;
  p.family = family;
  return p;
}

// A row that bounds on rounding leave open, by numbers that need none where they are such. Slow, and rare but where
// corners are on the lattice.
static inline VoxelRun openRow(const Target* target, uint pair, uint family, int y, int z) {
  const VoxelTriangle t = triangleAt(target, pair);
  const Planes p = planesOf(&t, pair, family);
  VoxelRun run = {p.planes.box.low.x, p.planes.box.high.x, false};
  bool open = false;
  for (int i = 0; i < p.planes.count && run.low <= run.high; ++i) {
    run.open = false;
    run = narrowRow(run, p.planes.at[i], p.inverse[i], y, z);
    if (run.open) {
      run = decideRow(run, t, p.planes.at[i], p.planes.source[i], SL_SEPARATION == 0, alongOf(family), p.inverse[i], y,
                      z);
    }
    open = open || run.open;
  }
  run.open = open;
  return run;
}

// Every `lanes`-th row from `lane` on. OpenCL 1.2 has no pointers to memory of any kind: a function a kind.
#define SET_ROWS(NAME, MEMORY)                                                                        \
  static inline void NAME(const Target* target, MEMORY const Planes* p, uint lane, uint lanes) {      \
    if (p->planes.empty) return;                                                                      \
    if (p->planes.open) {                                                                             \
      if (lane == 0) listOpen(target, p->pair, ALL_ROWS);                                             \
      return;                                                                                         \
    }                                                                                                 \
    const uint rows = rowsOf(p->planes.box);                                                        \
    const uint width = (uint)(p->planes.box.high.y - p->planes.box.low.y + 1);                                              \
    for (uint row = lane; row < rows; row += lanes) {                                                 \
      const int y = p->planes.box.low.y + (int)(row % width);                                                    \
      const int z = p->planes.box.low.z + (int)(row / width);                                                    \
      VoxelRun run = {p->planes.box.low.x, p->planes.box.high.x, false};                                                    \
      for (int i = 0; i < p->planes.count && run.low <= run.high; ++i)                                \
        run = narrowRow(run, p->planes.at[i], p->inverse[i], y, z);                                   \
      if (run.open && run.low <= run.high) run = openRow(target, p->pair, p->family, y, z);           \
      if (run.open && run.low <= run.high) {                                                          \
        listOpen(target, p->pair, (uint)(y + 64 * z));                                                \
      } else {                                                                                        \
        setRow(target, y, z, run.low, run.high);                                                      \
      }                                                                                               \
    }                                                                                                 \
  }
SET_ROWS(setRowsAlone, __private)
SET_ROWS(setRowsTogether, __local)

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
  __local uint bits[2 * 64 * LAYERS];
  __local uint large[MOST_GROUP];
  __local uint large_count;
  __local Planes together[PLANES_A_TIME];
  __local uint mask[MASK_WORDS];
  __local uint brick_base;
  const uint lane = (uint)get_local_id(0);
  const uint lanes = (uint)get_local_size(0);
  const uint half_block = (uint)get_group_id(0);
  const uint block = half_block / 2;
  const VoxelPlace base = {64 * places[block].x, 64 * places[block].y,
                           64 * places[block].z + LAYERS * (int)(half_block % 2)};
  const Target target = {bits,      counters,  open,  open_capacity, 64 * LAYERS * (half_block % 2),
                         positions, triangles, pairs, voxels_a_unit, base};
  for (uint i = lane; i < 2 * 64 * LAYERS; i += lanes) bits[i] = 0;
  for (uint i = lane; i < MASK_WORDS; i += lanes) mask[i] = 0;
  const uint end = first_pair[block + 1];
  for (uint begin = first_pair[block]; begin < end; begin += lanes) {
    if (lane == 0) large_count = 0;
    barrier(CLK_LOCAL_MEM_FENCE);
    const uint pair = begin + lane;
    if (pair < end) {
      const VoxelTriangle t = triangleAt(&target, pair);
      const uint rows = rowsOf(t.box);
      // An open normal matters only where the triangle's box alone does not tell.
      if (t.open && (SL_SEPARATION != 0 || !t.straight)) {
        listOpen(&target, pair, ALL_ROWS);
      } else if (rows > ROWS_ALONE) {
        large[atomic_inc(&large_count)] = pair;
      } else if (rows > 0) {
        for (uint family = 0; family < FAMILIES; ++family) {
          const Planes p = planesOf(&t, pair, family);
          setRowsAlone(&target, &p, 0, 1);
        }
      }
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    const uint count = FAMILIES * large_count;
    barrier(CLK_LOCAL_MEM_FENCE);  // before the next of them begins
    for (uint first = 0; first < count; first += PLANES_A_TIME) {
      const uint now = min(count - first, (uint)PLANES_A_TIME);
      for (uint i = lane; i < now; i += lanes) {
        const uint large_pair = large[(first + i) / FAMILIES];
        const VoxelTriangle t = triangleAt(&target, large_pair);
        together[i] = planesOf(&t, large_pair, (first + i) % FAMILIES);
      }
      barrier(CLK_LOCAL_MEM_FENCE);
      for (uint i = 0; i < now; ++i) setRowsTogether(&target, &together[i], lane, lanes);
      barrier(CLK_LOCAL_MEM_FENCE);
    }
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  for (uint brick = lane; brick < BRICKS; brick += lanes) {
    ulong any = 0;
    for (uint z = 0; z < 8; ++z) any |= brickWord(&target, brick, z);
    if (any != 0) atomic_or(&mask[brick >> 5], 1u << (brick & 31u));
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  if (lane == 0) {
    uint count = 0;
    for (uint i = 0; i < MASK_WORDS; ++i) count += popcount(mask[i]);
    brick_base = atomic_add(&counters[COUNT_BRICKS], count);
    first_brick[half_block] = brick_base;
  }
  for (uint i = lane; i < MASK_WORDS; i += lanes) brick_masks[MASK_WORDS * half_block + i] = mask[i];
  barrier(CLK_LOCAL_MEM_FENCE);
  for (uint brick = lane; brick < BRICKS; brick += lanes) {
    const uint word = brick >> 5;
    if ((mask[word] >> (brick & 31u) & 1u) == 0) continue;
    uint place = brick_base + popcount(mask[word] & ((1u << (brick & 31u)) - 1u));
    for (uint i = 0; i < word; ++i) place += popcount(mask[i]);
    if (place >= brick_capacity) continue;
    for (uint z = 0; z < 8; ++z) bricks[8 * (ulong)place + z] = brickWord(&target, brick, z);
  }
}

// A row of blocks that the triangle meets.
static inline VoxelRun rowOfBlocks(const VoxelTriangle* t, const VoxelPlanes* planes, int y, int z) {
  VoxelRun run = {t->box.low.x, t->box.high.x, false};
  bool open = false;
  for (int i = 0; i < planes->count && run.low <= run.high; ++i) {
    const VoxelHalf h = planes->at[i];
    const SL_REAL inverse = inverseOf(h.factor.x, h.rises.x);
    run.open = false;
    run = narrowRow(run, h, inverse, y, z);
    if (run.open) run = decideRow(run, *t, h, planes->source[i], true, axisAlong(0), inverse, y, z);
    open = open || run.open;
  }
  run.open = open && run.low <= run.high;
  return run;
}

// Whether rounding leaves open which blocks it meets.
static inline bool blocksAreOpen(const VoxelTriangle* t, const VoxelPlanes* planes) {
  if (planes->open) return true;
  for (int z = t->box.low.z; z <= t->box.high.z; ++z) {
    for (int y = t->box.low.y; y <= t->box.high.y; ++y) {
      if (rowOfBlocks(t, planes, y, z).open) return true;
    }
  }
  return false;
}

// Counts, and then lists, the triangles that meet each block of a box of blocks; a work item a triangle. Those that
// are left open go to a list of their own and nowhere else. Work items list a block's triangles in any order.
__kernel void binIntoBlocks(__global const float* positions, __global const uint* triangles, uint triangle_count,
                            float blocks_a_unit, int4 low, int4 size, uint fills, uint open_capacity,
                            volatile __global uint* counts, __global const uint* first, __global uint* ids,
                            __global uint* open, volatile __global uint* counters) {
  const uint id = (uint)get_global_id(0);
  if (id >= triangle_count) return;
  const VoxelPlace base = {low.x, low.y, low.z};
  const VoxelPlace limit = {size.x, size.y, size.z};
  const ulong corner = 3 * (ulong)id;
  const VoxelTriangle t = voxelTriangle(cornerAt(positions, triangles, corner, blocks_a_unit),
                                        cornerAt(positions, triangles, corner + 1, blocks_a_unit),
                                        cornerAt(positions, triangles, corner + 2, blocks_a_unit), base, limit);
  VoxelPlanes planes;
  planes.count = 0;
  planes.open = false;
  if (!t.straight) {
    // Of one that reaches none of the blocks an open normal does not matter, unless its box is not told either.
    if (!t.open && rowsOf(t.box) == 0) return;
    planes = meetingPlanes(t);
    if (blocksAreOpen(&t, &planes)) {
      if (fills == 0) {
        const uint place = atomic_inc(&counters[COUNT_OPEN]);
        if (place < open_capacity) open[place] = id;
      }
      return;
    }
  }
  for (int z = t.box.low.z; z <= t.box.high.z; ++z) {
    for (int y = t.box.low.y; y <= t.box.high.y; ++y) {
      const VoxelRun run = rowOfBlocks(&t, &planes, y, z);
      for (int x = run.low; x <= run.high; ++x) {
        const uint block = (uint)(x + size.x * (y + size.y * z));
        const uint place = atomic_inc(&counts[block]);
        if (fills != 0) ids[first[block] + place] = id;
      }
    }
  }
}
