// What the kernels of a bake see: the scene, the launch and the buffers of the stages that each of them names.
#ifndef SL_STAGE_CL
#define SL_STAGE_CL
#include "cl_kernels/trace.cl"
#include "core/shared/counters.h"
#include "core/shared/gvs_reverse.h"
#include "core/shared/random_ray.h"
#include "core/shared/set.h"
#include "core/shared/stage_launch.h"

#define SL_BUFFER_ITEM(type, name) typedef type name##_item;
SL_STAGE_BUFFERS(SL_BUFFER_ITEM)
#define SL_BUFFER_MEMBER(type, name) __global type* name;

typedef struct StageRef {
  SceneRef scene;
  StageLaunch launch;
  SL_STAGE_BUFFERS(SL_BUFFER_MEMBER)
} StageRef;

/// Defines a kernel that calls of_item for each work item below launch.item_count. buffers: X(name) for each buffer
/// that it reads or writes; the others are not to be touched. The host finds them by the names of the parameters
/// (core/device/opencl/opencl_stages.cpp), after nodes, triangles, reach and launch: what a launch costs grows with
/// the number of its buffers.
#define SL_STAGE_KERNEL(name, of_item, buffers)                           \
  __kernel void name(SL_STAGE_ARGS(buffers)) {                            \
    SL_STAGE_PACK(buffers)                                                \
    const uint item = (uint)get_global_id(0);                             \
    if (item < launch.item_count) of_item(&stage, item);                  \
  }
#define SL_STAGE_ARGS(buffers) SL_SCENE_ARGS, StageLaunch launch buffers(SL_BUFFER_ARG)
#define SL_BUFFER_ARG(name) , __global name##_item *name
/// The StageRef `stage` of the arguments.
#define SL_STAGE_PACK(buffers)    \
  StageRef stage;                 \
  stage.scene = SL_SCENE_PACK;    \
  stage.launch = launch;          \
  buffers(SL_BUFFER_PACK)
#define SL_BUFFER_PACK(name) stage.name = name;

/// What insertHit needs.
#define SL_SET_BUFFERS(X) X(keys) X(winner) X(fresh) X(counters)

static inline SetRef setOf(const StageRef* stage) {
  SetRef set;
  set.keys = stage->keys;
  set.winner = stage->winner;
  set.fresh = stage->fresh;
  set.overflow = &stage->counters[kOverflowCounter];
  set.capacity = stage->launch.capacity;
  return set;
}

static inline Corners cornersOf(const StageRef* stage, uint triangle) {
#if SL_INSTANCES
  const StoredTriangle at = findTriangle(stage->scene, stage->scene.instance_count, triangle);
  __global const SceneTriangle* record = &stage->scene.triangles[stage->place_of[at.triangle]];
  if (at.instance != kNoTriangle) return placedCorners(&stage->scene.instances[at.instance], record);
  return recordCorners(record);
#else
  return recordCorners(&stage->scene.triangles[stage->place_of[triangle]]);
#endif
}

/// Rays are counted by work-group.
static inline void countRays(const StageRef* stage, uint rays) {
  if (rays > 0) atomic_add(&stage->counters[get_group_id(0) % kRayCounters], rays);
}

#include "core/shared/stage_glue.inl"
#include "core/shared/list_stages.inl"

#endif
