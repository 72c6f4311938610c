// The stages of a bake (core/shared): the rays of a batch by their index, and what is done with lists.
#ifndef SL_SAMPLING_GLSL
#define SL_SAMPLING_GLSL
#include "vk_shaders/state.glsl"
#include "core/shared/gvs_reverse.h"
#include "core/shared/random_ray.h"

#define SL_INSTANCES_PARAM uint instances
#define SL_INSTANCE_IDS(k) Buffer_InstanceRecord(SL_THE_LAUNCH.instances).at[k].ids
#include "core/shared/find_triangle.inl"

Corners cornersOf(uint triangle) {
  StoredTriangle stored = StoredTriangle(triangle, kNoTriangle);
  uint count = SL_THE_LAUNCH.instance_count;
  if (count > 0u) stored = findTriangle(0u, count, triangle);
  uint leaf = SL_BUFFER(place_of, stored.triangle);
  Corners corners = Corners(leafCorner(leaf, 0u), leafCorner(leaf, 1u), leafCorner(leaf, 2u));
  if (stored.instance == kNoTriangle) return corners;
  InstanceRecord instance = Buffer_InstanceRecord(SL_THE_LAUNCH.instances).at[stored.instance];
  return placeCorners(instance.place, instance.roots.z, corners.a, corners.b, corners.c);
}

#include "core/shared/stage_glue.inl"
#include "core/shared/list_stages.inl"

/// Border ray `index` (0 ..) of the border batch. Needs what border_edges wrote.
Ray borderRayByIndex(uint index) {
  uint entry = borderEntryOf(kTheStage, index);
  return borderRayAt(kTheStage, entry, borderRayNumber(kTheStage, index, entry));
}

/// The random ray that a slot of the launch's segment traces, and its offset there. false: the slot has none.
bool slotRayAt(uint slot, out uint offset, out Ray ray) {
  RandomSegment segment = SL_LAUNCH(segment);
  offset = slotOffset(segment, slot);
  ray = noRay();
  if (offset == kNoTriangle) return false;
  ray = offsetRay(segment, SL_BUFFER(faces, segment.range.x), SL_LAUNCH(shifts), offset);
  return true;
}

#endif
