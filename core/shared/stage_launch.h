// What the stages of a bake on a GPU work on: buffers, by name, and the numbers of a launch. Every API hands
// them to its kernels or shaders in its own way; stage_glue.inl and list_stages.inl read them by SL_BUFFER
// and SL_LAUNCH (language.h).
#ifndef SL_STAGE_LAUNCH_H
#define SL_STAGE_LAUNCH_H
#include "core/shared/border.h"
#include "core/shared/reverse.h"
#include "core/shared/view_ray.h"
SL_NAMESPACE_BEGIN

/// X(type, name) for each of the buffers, in the order in which kernels and shaders get them.
#define SL_STAGE_BUFFERS(X)                                                                     \
  X(Face, faces)    /* of the view cell */                                                      \
  X(uint, place_of) /* stored triangle (plain: its id) -> its record or leaf */                 \
  X(uint, keys)     /* the set (set.h) ... */                                                   \
  X(uint, winner)                                                                               \
  X(uint, fresh)                                                                                \
  X(uint, old_keys) /* ... and what it was before it grew */                                    \
  X(uint, old_winner)                                                                           \
  X(uint, counters)                 /* counters.h */                                            \
  X(PvsEntry, entries)              /* the list */                                              \
  X(RandomSegment, segments)        /* of the batch */                                          \
  X(uint, border_starts)            /* border rays before each entry of the batch; then all */  \
  X(BorderEdge, border_edges)       /* three an entry of the border batch */                    \
  X(uint, border_hits)              /* a border ray: triangle, kNoTriangle or kNotTraced */     \
  X(uint, bits)                     /* a bit a border ray: it met a discontinuity */            \
  X(uint, kept_bits)                /* of these, those that get reverse rays */                 \
  X(Discontinuity, discontinuities) /* that wait for their reverse rays */                      \
  X(ReverseItem, reverse_items)     /* of the reverse launch */                                 \
  X(uint, words)                    /* bits to list */                                          \
  X(uint, block_counts)             /* bits or rays in each block, then those before it; all */ \
  X(uint, indices)                  /* triangles, or indices of set bits */                     \
  X(Ray, rays)                      /* that traceRays reads */                                  \
  X(Hit, hits)                      /* that it writes */                                        \
  X(ViewFrame, views)               /* that traceViews reads */                                 \
  X(uint, view_triangles)           /* that it writes: a pixel each */

#define SL_COUNT_ONE(type, name) +1u
SL_CONST uint kStageBuffers = 0u SL_STAGE_BUFFERS(SL_COUNT_ONE);

/// The numbers of a launch. As large as OpenCL C rounds it up to: a multiple of 16 bytes.
SL_STRUCT(StageLaunch) {
  StageParams params;
  RandomSegment segment;
  uvec4 shifts;         ///< of the random rays
  uint64 items_before;  ///< discontinuities of the cell before those that wait
  uint capacity;        ///< of the hash set; 0: array
  uint border_first;    ///< first entry of the border batch
  uint border_count;    ///< its entries
  uint waiting;         ///< in the list of discontinuities
  uint reverse_first;   ///< first discontinuity of the reverse rays
  uint stage;           ///< kStage... of the batch that is collected
  uint segment_count;
  uint list_end;  ///< entries in the list
  uint word_count;
  uint block_count;
  uint sum_place;   ///< counter that sum_blocks writes: kListCounter or kFreshCounter
  uint level;       ///< of the border rays of the original method
  uint resolution;  ///< of the images of traceViews
  uint item_count;  ///< rays or work items
};

SL_NAMESPACE_END
#endif
