// The scene as kernels read it: the 2-wide tree and the triangles in leaf order. With SL_INSTANCES the tree has two
// levels (bvh/bvh.h), and triangles of meshes are in the mesh's space.
#include "core/shared/box.h"
#include "core/shared/bvh_node.h"
#include "core/shared/placement.h"
#include "core/shared/ray.h"
#include "core/shared/surface.h"
#include "core/shared/triangle.h"

// What the scene needs, by the host (core/device/opencl/opencl_scene.h): SL_HAS_SURFACES where there are holes, glass
// or sides, SL_HAS_GLASS where there is glass; SL_INSTANCES where there are instances.

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
#if SL_INSTANCES
  __global const InstanceRecord* instances;
  __global const uint* instance_order;
  uint instance_count;  // without the last, if that holds what is in no mesh
  uint root;            // of the upper level
#endif
} SceneRef;

/// Parameters of a kernel that traces, and the SceneRef made of them. The host passes, in this order, the node buffer,
/// the triangle buffer, the reach, and, where there are any, the surfaces and the instances (launchOnScene,
/// core/device/opencl/opencl_scene.h).
#if SL_HAS_SURFACES
#define SL_SURFACES_ARG , __global const uint *restrict scene_surfaces
#define SL_SURFACES_PACK , scene_surfaces
#else
#define SL_SURFACES_ARG
#define SL_SURFACES_PACK
#endif
#if SL_INSTANCES
#define SL_INSTANCES_ARG                                                                              \
  , __global const InstanceRecord *restrict scene_instances, __global const uint *restrict scene_order, \
      uint scene_instance_count, uint scene_root
#define SL_INSTANCES_PACK , scene_instances, scene_order, scene_instance_count, scene_root
#else
#define SL_INSTANCES_ARG
#define SL_INSTANCES_PACK
#endif
#define SL_SCENE_ARGS                                                                                     \
  __global const BvhNode2 *restrict scene_nodes, __global const SceneTriangle *restrict scene_triangles, \
      float scene_reach SL_SURFACES_ARG SL_INSTANCES_ARG
#define SL_SCENE_PACK packScene(scene_nodes, scene_triangles, scene_reach SL_SURFACES_PACK SL_INSTANCES_PACK)

static inline SceneRef packScene(SL_SCENE_ARGS) {
  SceneRef scene;
  scene.nodes = scene_nodes;
  scene.triangles = scene_triangles;
  scene.reach = scene_reach;
#if SL_HAS_SURFACES
  scene.surfaces = scene_surfaces;
#endif
#if SL_INSTANCES
  scene.instances = scene_instances;
  scene.instance_order = scene_order;
  scene.instance_count = scene_instance_count;
  scene.root = scene_root;
#endif
  return scene;
}

static inline Corners recordCorners(__global const SceneTriangle* record) {
  Corners corners;
#if SL_PACKET > 1
  __global const float* v = record->vertices;
  corners.a = (float3)(v[0], v[1], v[2]);
  corners.b = (float3)(v[3], v[4], v[5]);
  corners.c = (float3)(v[6], v[7], v[8]);
#else
  corners.a = record->v0.xyz;
  corners.b = record->v1.xyz;
  corners.c = record->v2.xyz;
#endif
  return corners;
}

static inline uint recordId(__global const SceneTriangle* record) {
#if SL_PACKET > 1
  return record->id;
#else
  return as_uint(record->v0.w);
#endif
}

#if SL_INSTANCES
#define SL_INSTANCES_PARAM SceneRef scene
#define SL_INSTANCE_IDS(k) scene.instances[k].ids
#include "core/shared/find_triangle.inl"

/// The record's corners where the instance has them.
static inline Corners placedCorners(__global const InstanceRecord* instance, __global const SceneTriangle* record) {
  const Corners corners = recordCorners(record);
  return placeCorners(instance->place, instance->roots.z, corners.a, corners.b, corners.c);
}
#endif

static inline Hit missHit(void) {
  Hit hit;
  hit.t = as_float(0x7f800000u);
  hit.triangle = kNoTriangle;
  return hit;
}
