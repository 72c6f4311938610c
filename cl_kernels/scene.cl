// The scene as kernels read it: the 2-wide tree and the triangles in leaf order.
#include "core/shared/box.h"
#include "core/shared/bvh_node.h"
#include "core/shared/ray.h"
#include "core/shared/triangle.h"

/// A triangle as this program reads it.
#if SL_PACKET > 1
typedef TriangleRecord SceneTriangle;
#else
typedef TriangleRecordGpu SceneTriangle;
#endif

typedef struct SceneRef {
  __global const BvhNode2* nodes;
  __global const SceneTriangle* triangles;
  float reach;  // sceneReach of the bounds
} SceneRef;

/// Parameters of a kernel that traces, and the SceneRef made of them. The host passes, in this order, the
/// node buffer, the triangle buffer and the reach (core/device/opencl/opencl_scene.h).
#define SL_SCENE_ARGS                                                                                     \
  __global const BvhNode2 *restrict scene_nodes, __global const SceneTriangle *restrict scene_triangles, \
      float scene_reach
#define SL_SCENE_PACK packScene(scene_nodes, scene_triangles, scene_reach)

static inline SceneRef packScene(__global const BvhNode2* nodes, __global const SceneTriangle* triangles,
                                 float reach) {
  SceneRef scene;
  scene.nodes = nodes;
  scene.triangles = triangles;
  scene.reach = reach;
  return scene;
}

static inline Hit missHit(void) {
  Hit hit;
  hit.t = as_float(0x7f800000u);
  hit.triangle = kNoTriangle;
  return hit;
}
