// The sampling stages: generate SL_PACKET rays a work item, trace them together, insert what they hit.
#include "cl_kernels/glass.cl"
#include "cl_kernels/stage.cl"

/// Inserts what a lane's ray sees: its hit, and the glass before that where its bit of `glass` is set.
#if SL_HAS_GLASS
#define SL_INSERT_SIGHT(ray, lane, index)                               \
  insertHit(set, met[lane].triangle, (index));                          \
  if ((glass >> (lane) & 1u) != 0) insertGlass(&stage, (ray), met[lane], (index));
#else
#define SL_INSERT_SIGHT(ray, lane, index) insertHit(set, met[lane].triangle, (index));
#endif
/// A random ray of the launch's segment, by its offset.
#define SL_SEGMENT_RAY(offset) \
  randomRay(segmentFirst(launch.segment), (offset), faces[launch.segment.range.x], launch.shifts)

#define SL_TRACE_RANDOM(X) SL_SET_BUFFERS(X) X(faces)
__kernel void traceRandom(SL_STAGE_ARGS(SL_TRACE_RANDOM)) {
  SL_STAGE_PACK(SL_TRACE_RANDOM)
  const SetRef set = setOf(&stage);
  const uint first = (uint)get_global_id(0) * SL_PACKET;
  Hit met[SL_PACKET];
  uint offsets[SL_PACKET];
  const uint glass =
      traceSlots(stage.scene, launch.segment, faces[launch.segment.range.x], launch.shifts, first, offsets, met);
  uint traced = 0;
  for (uint lane = 0; lane < SL_PACKET; ++lane) {
    SL_INSERT_SIGHT(SL_SEGMENT_RAY(offsets[lane]), lane, launch.segment.batch.x + offsets[lane])
    traced += offsets[lane] != kNoTriangle ? 1 : 0;
  }
  countRays(&stage, traced);
}

#define SL_COUNT_MISSING(X) SL_SET_BUFFERS(X) X(faces)
/// As traceRandom, but only counts the rays that see something outside the set.
__kernel void countMissing(SL_STAGE_ARGS(SL_COUNT_MISSING)) {
  SL_STAGE_PACK(SL_COUNT_MISSING)
  const SetRef set = setOf(&stage);
  const uint first = (uint)get_global_id(0) * SL_PACKET;
  Hit met[SL_PACKET];
  uint offsets[SL_PACKET];
  const uint glass =
      traceSlots(stage.scene, launch.segment, faces[launch.segment.range.x], launch.shifts, first, offsets, met);
  uint traced = 0;
  uint missing = 0;
  for (uint lane = 0; lane < SL_PACKET; ++lane) {
    const uint triangle = met[lane].triangle;
    traced += offsets[lane] != kNoTriangle ? 1 : 0;
    bool lacks = triangle != kNoTriangle && !isInSet(set, triangle);
#if SL_HAS_GLASS
    if (!lacks && (glass >> lane & 1u) != 0) lacks = lacksGlass(&stage, SL_SEGMENT_RAY(offsets[lane]), met[lane]);
#endif
    missing += lacks ? 1 : 0;
  }
  if (missing > 0) atomic_add(&counters[kMissingCounter], missing);
  countRays(&stage, traced);
}

#define SL_TRACE_BORDER(X) SL_SET_BUFFERS(X) X(entries) X(border_starts) X(border_edges) X(border_hits) X(bits)
/// All border rays of the batch; notes what each hit and, a bit a ray, whether it met a discontinuity. Those
/// without direction hit nothing and are not counted.
__kernel void traceBorder(SL_STAGE_ARGS(SL_TRACE_BORDER)) {
  SL_STAGE_PACK(SL_TRACE_BORDER)
  const SetRef set = setOf(&stage);
  const uint first = (uint)get_global_id(0) * SL_PACKET;
  const uint total = border_starts[launch.border_count];
  const uint count = min((uint)SL_PACKET, total - min(first, total));
  if (count == 0) return;
  Ray made[SL_PACKET];
  Hit met[SL_PACKET];
  uint entry = borderEntryOf(&stage, first);
  for (uint lane = 0; lane < SL_PACKET; ++lane) {
    if (lane < count) entry = nextBorderEntry(&stage, entry, first + lane);
    made[lane] = lane < count ? borderRayAt(&stage, entry, first + lane - border_starts[entry]) : noRay();
  }
  const uint glass = traceRays(stage.scene, made, met);
  uint found = 0;
  uint traced = 0;
  for (uint lane = 0; lane < count; ++lane) {
    traced += hasDirection(made[lane]) ? 1 : 0;
    border_hits[first + lane] = met[lane].triangle;
    SL_INSERT_SIGHT(made[lane], lane, first + lane + 1)
    found |= (isDiscontinuity(made[lane], met[lane], launch.params) ? 1u : 0u) << lane;
  }
  if (found != 0) atomic_or(&bits[first >> 5], found << (first & 31));
  countRays(&stage, traced);
}

#define SL_TRACE_GVS_BORDER(X) SL_SET_BUFFERS(X) X(place_of) X(entries) X(border_edges) X(border_hits) X(bits)
/// Border rays of the original method, one level a launch (core/shared/gvs_border.h): the slots of the level
/// over the batch; traces those whose neighbours hit different triangles. Notes as traceBorder does.
__kernel void traceGvsBorder(SL_STAGE_ARGS(SL_TRACE_GVS_BORDER)) {
  SL_STAGE_PACK(SL_TRACE_GVS_BORDER)
  const SetRef set = setOf(&stage);
  const uint first = (uint)get_global_id(0) * SL_PACKET;
  const uint slots = gvsSlots(launch.level);
  Ray made[SL_PACKET];
  Hit met[SL_PACKET];
  uint index[SL_PACKET];
  uint traced = 0;
  for (uint lane = 0; lane < SL_PACKET; ++lane) {
    made[lane] = noRay();
    if (first + lane >= launch.item_count) continue;
    const uint entry = (first + lane) / slots * kGvsPositions;
    const uint position = gvsPosition(launch.level, (first + lane) % slots);
    index[lane] = entry + position;
    if (launch.level > 0 && !gvsDivides(border_hits[entry + gvsBefore(launch.level, position)],
                                        border_hits[entry + gvsAfter(launch.level, position)])) {
      continue;
    }
    made[lane] = borderRayAt(&stage, entry / kGvsPositions, position);
    traced += hasDirection(made[lane]) ? 1 : 0;
  }
  if (traced == 0) return;
  const uint glass = traceRays(stage.scene, made, met);
  for (uint lane = 0; lane < SL_PACKET; ++lane) {
    if (!hasDirection(made[lane])) continue;
    border_hits[index[lane]] = met[lane].triangle;
    SL_INSERT_SIGHT(made[lane], lane, index[lane] + 1)
    const uint entry = launch.border_first + index[lane] / kGvsPositions;
    const Corners t = cornersOf(&stage, entries[entry].origin_triangle.w);
    if (isGvsDiscontinuity(made[lane], met[lane], t.a, t.b, t.c, launch.params)) {
      atomic_or(&bits[index[lane] >> 5], 1u << (index[lane] & 31));
    }
  }
  countRays(&stage, traced);
}

#define SL_TRACE_REVERSE(X) SL_SET_BUFFERS(X) X(faces) X(reverse_items)
/// Reverse rays of the reverse launch: one a lane.
__kernel void traceReverse(SL_STAGE_ARGS(SL_TRACE_REVERSE)) {
  SL_STAGE_PACK(SL_TRACE_REVERSE)
  const SetRef set = setOf(&stage);
  const uint first = (uint)get_global_id(0) * SL_PACKET;
  Ray made[SL_PACKET];
  Hit met[SL_PACKET];
  uint traced = 0;
  for (uint lane = 0; lane < SL_PACKET; ++lane) {
    made[lane] = first + lane < launch.item_count ? reverseRayAt(&stage, first + lane) : noRay();
    traced += hasDirection(made[lane]) ? 1 : 0;
  }
  if (traced == 0) return;
  const uint glass = traceRays(stage.scene, made, met);
  for (uint lane = 0; lane < SL_PACKET; ++lane) {
    SL_INSERT_SIGHT(made[lane], lane, first + lane + 1)
  }
  countRays(&stage, traced);
}
