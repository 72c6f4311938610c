// What the Vulkan shaders of a launch read: the one struct that the host fills in for every launch. C++ and
// GLSL (scalar layout); addresses are device addresses of buffers.
#ifndef SL_LAUNCH_H
#define SL_LAUNCH_H
#include "core/shared/stage_params.h"
SL_NAMESPACE_BEGIN

/// Words of 32 bits that one work item of the list shaders counts and writes, and the work items of the one
/// group that sums up the counts.
SL_CONST uint kBlockWords = 64u;
SL_CONST uint kSumItems = 64u;

/// Words of the counters' buffer. Rays are counted in many words, so that work items do not fight for one.
SL_CONST uint kRayCounters = 256u;      ///< 0 .. 255: rays
SL_CONST uint kMissingCounter = 256u;   ///< rays that hit something outside the set
SL_CONST uint kOverflowCounter = 257u;  ///< not 0: the hash set was full
SL_CONST uint kListCounter = 258u;      ///< bits or border rays that were summed up last for a list
SL_CONST uint kFreshCounter = 259u;     ///< bits of new triangles
SL_CONST uint kCounterWords = 260u;

/// Neighbouring leaves that are drawn or left out together. Smaller ones fit a view's edge better, but a draw
/// costs even where it is empty.
SL_CONST uint kChunkTriangles = 2048u;

SL_STRUCT(VulkanLaunch) {
  StageParams params;
  RandomSegment segment;
  uvec4 shifts;  ///< of the random rays
  // The scene. A leaf is a place in the order in which the driver got the triangles.
  uint64 tlas;         ///< acceleration structure
  uint64 part_starts;  ///< uint[]: first leaf of each bottom-level structure
  uint64 leaf_ids;     ///< uint[]: leaf -> triangle id
  uint64 leaf_of;      ///< uint[]: triangle id -> its leaf
  uint64 corners;      ///< float[9] a leaf
  uint64 faces;        ///< Face[]
  // Set, list and counters.
  uint64 keys;
  uint64 winner;
  uint64 fresh;
  uint64 counters;
  uint64 entries;  ///< PvsEntry[]
  // Stages.
  uint64 segments;         ///< RandomSegment[] of the batch
  uint64 border_starts;    ///< uint[] an entry of the border batch: border rays before its own; then all
  uint64 border_edges;     ///< BorderEdge[], three an entry of the border batch
  uint64 reverse_items;    ///< ReverseItem[] of the reverse launch
  uint64 border_hits;      ///< uint[] a border ray: leaf that it hit, kNoTriangle or kNotTraced
  uint64 bits;             ///< a bit a border ray: it met a discontinuity
  uint64 kept_bits;        ///< of `bits`, those that get reverse rays
  uint64 discontinuities;  ///< Discontinuity[]: those that wait for their reverse rays
  uint64 rays;             ///< Ray[] that trace_rays reads, stage_rays writes; ViewFrame[] of trace_views
  uint64 hits;             ///< Hit[] that trace_rays and trace_slots write; uint[] of trace_views: triangles
  // Lists from bits.
  uint64 words;         ///< uint[]: bits to list
  uint64 block_counts;  ///< uint[]: bits in each block of kBlockWords words, then where its indices start
  uint64 indices;       ///< uint[]: triangles, or indices of set bits
  uint64 old_keys;      ///< the hash set before it grew
  uint64 old_winner;
  uint64 items_before;   ///< discontinuities of the cell before those that wait
  uint64 hemicube;       ///< ViewFrame[5] of the hemicube that is drawn
  uint64 hemicubes;      ///< ViewFrame[5] a hemicube of the batch that is collected; 0: it was traced
  uint64 chunk_bounds;   ///< float[6] a chunk: the box around it
  uint64 draws;          ///< VkDrawIndirectCommand[] a view of a chunk each
  uint64 raster_leaves;  ///< uint[] a pixel of the hemicube's images: leaf or kNoTriangle
  uint capacity;         ///< of the hash set; 0: array
  uint old_capacity;
  uint border_first;   ///< first entry of the border batch
  uint border_count;   ///< its entries
  uint waiting;        ///< in the list of discontinuities
  uint reverse_first;  ///< first discontinuity of the reverse rays
  uint stage;          ///< kStage... of the batch that is collected
  uint segment_count;
  uint list_end;  ///< entries in the list
  uint word_count;
  uint block_count;
  uint sum_place;          ///< counter that sum_blocks writes: kListCounter or kFreshCounter
  uint resolution;         ///< of the images of trace_views
  uint level;              ///< of trace_gvs_border
  uint raster_resolution;  ///< of a hemicube's images
  uint raster_first;       ///< index in the batch of the hemicube's first sample
  uint chunk_count;
  uint triangle_count;  ///< of the scene
  float raster_near;    ///< distance of the near plane
  uint unused;          ///< makes the size a multiple of 8, as C++ does
};

SL_NAMESPACE_END
#endif
