// What every kernel of a bake sees: the scene, the launch and all buffers of the stages. All kernels have the
// same parameters; the host binds those that a stage uses.
#ifndef SL_STAGE_CL
#define SL_STAGE_CL
#include "cl_kernels/trace.cl"
#include "core/shared/counters.h"
#include "core/shared/gvs_reverse.h"
#include "core/shared/random_ray.h"
#include "core/shared/set.h"
#include "core/shared/stage_launch.h"

#define SL_BUFFER_ARG(type, name) , __global type *name
#define SL_BUFFER_MEMBER(type, name) __global type* name;
#define SL_BUFFER_PACK(type, name) stage.name = name;

typedef struct StageRef {
  SceneRef scene;
  StageLaunch launch;
  SL_STAGE_BUFFERS(SL_BUFFER_MEMBER)
} StageRef;

/// Parameters of a kernel, and the StageRef `stage` made of them. The host passes nodes, triangles, reach and
/// launch, then the buffers (core/device/opencl/opencl_stages.cpp).
#define SL_STAGE_ARGS SL_SCENE_ARGS, StageLaunch launch SL_STAGE_BUFFERS(SL_BUFFER_ARG)
#define SL_STAGE_PACK           \
  StageRef stage;               \
  stage.scene = SL_SCENE_PACK;  \
  stage.launch = launch;        \
  SL_STAGE_BUFFERS(SL_BUFFER_PACK)

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
  return recordCorners(&stage->scene.triangles[stage->place_of[triangle]]);
}

/// Rays are counted by work-group.
static inline void countRays(const StageRef* stage, uint rays) {
  if (rays > 0) atomic_add(&stage->counters[get_group_id(0) % kRayCounters], rays);
}

#include "core/shared/stage_glue.inl"
#include "core/shared/list_stages.inl"

#endif
