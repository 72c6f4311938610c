// The scene as kernels read it: the 2-wide tree and the triangles in leaf order.
#include "core/shared/box.h"
#include "core/shared/bvh_node.h"
#include "core/shared/ray.h"
#include "core/shared/surface.h"
#include "core/shared/triangle.h"

// What the scene needs, by the host (core/device/opencl/opencl_scene.h): SL_HAS_SURFACES where there are holes, glass
// or sides, SL_HAS_GLASS where there is glass.

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
#if SL_HAS_SURFACES
  __global const uint* surfaces;  // core/shared/surface.h
#endif
} SceneRef;

/// Parameters of a kernel that traces, and the SceneRef made of them. The host passes, in this order, the
/// node buffer, the triangle buffer, the reach, and, where there are any, the surfaces
/// (core/device/opencl/opencl_scene.h).
#if SL_HAS_SURFACES
#define SL_SURFACES_ARG , __global const uint *restrict scene_surfaces
#define SL_SURFACES_PACK , scene_surfaces
#else
#define SL_SURFACES_ARG
#define SL_SURFACES_PACK
#endif
#define SL_SCENE_ARGS                                                                                     \
  __global const BvhNode2 *restrict scene_nodes, __global const SceneTriangle *restrict scene_triangles, \
      float scene_reach SL_SURFACES_ARG
#define SL_SCENE_PACK packScene(scene_nodes, scene_triangles, scene_reach SL_SURFACES_PACK)

static inline SceneRef packScene(__global const BvhNode2* nodes, __global const SceneTriangle* triangles,
                                 float reach SL_SURFACES_ARG) {
  SceneRef scene;
  scene.nodes = nodes;
  scene.triangles = triangles;
  scene.reach = reach;
#if SL_HAS_SURFACES
  scene.surfaces = scene_surfaces;
#endif
  return scene;
}

static inline Hit missHit(void) {
  Hit hit;
  hit.t = as_float(0x7f800000u);
  hit.triangle = kNoTriangle;
  return hit;
}
