// The scene as kernels read it: the 2-wide tree and the triangles in leaf order.
#include "core/shared/box.h"
#include "core/shared/ray.h"
#include "core/shared/triangle.h"

/// BvhNode2 of bvh/bvh.h.
typedef struct BvhNode2 {
  float4 x;  // low and high of child 0, low and high of child 1
  float4 y;
  float4 z;
  uint child[2];
  uint count[2];
} BvhNode2;

#if SL_PACKET > 1
/// TriangleRecord of core/trace/trace_layout.h.
typedef struct TriangleRecord {
  float vertices[9];
  uint id;
} TriangleRecord;
#else
/// TriangleRecordGpu of core/trace/trace_layout.h.
typedef struct TriangleRecord {
  float4 v0;  // w: bits of the id
  float4 v1;
  float4 v2;
} TriangleRecord;
#endif

typedef struct SceneRef {
  __global const BvhNode2* nodes;
  __global const TriangleRecord* triangles;
  float reach;  // sceneReach of the bounds
} SceneRef;

/// Parameters of a kernel that traces, and the SceneRef made of them. The host passes, in this order, the
/// node buffer, the triangle buffer and the reach (core/device/opencl/opencl_scene.h).
#define SL_SCENE_ARGS                                                                                     \
  __global const BvhNode2 *restrict scene_nodes, __global const TriangleRecord *restrict scene_triangles, \
      float scene_reach
#define SL_SCENE_PACK packScene(scene_nodes, scene_triangles, scene_reach)

static inline SceneRef packScene(__global const BvhNode2* nodes, __global const TriangleRecord* triangles,
                                 float reach) {
  SceneRef scene;
  scene.nodes = nodes;
  scene.triangles = triangles;
  scene.reach = reach;
  return scene;
}

/// Inner nodes on a path at most (kMaxDepth of bvh/bvh.h): each leaves one sibling on the stack.
#define SL_STACK_SIZE 96

static inline Hit missHit(void) {
  Hit hit;
  hit.t = as_float(0x7f800000u);
  hit.triangle = kNoTriangle;
  return hit;
}
