// The glass that a ray meets before what ends it: a second walk, bounded by where the first one ended, so that what is
// seen depends on no order. A scene without glass has none of this.
#ifndef SL_GLASS_CL
#define SL_GLASS_CL
#include "cl_kernels/stage.cl"
#include "cl_kernels/trace_single.cl"

#if SL_HAS_GLASS

/// What becomes of glass that a ray meets.
#define SL_GLASS_INSERT 0u  // into the set, under the ray's index
#define SL_GLASS_TEST 1u    // whether the set lacks any
#define SL_GLASS_LIST 2u    // ray and triangle into the stage's list

typedef struct GlassVisit {
  uint action;
  uint ray;  // its index, to insert or list
} GlassVisit;

/// true: the set lacks the triangle.
static inline bool visitGlass(const StageRef* stage, GlassVisit visit, uint triangle) {
  if (visit.action == SL_GLASS_TEST) return !isInSet(setOf(stage), triangle);
  if (visit.action == SL_GLASS_INSERT) {
    insertHit(setOf(stage), triangle, visit.ray);
    return false;
  }
  const uint place = atomic_add(&stage->counters[kListCounter], 1u);
  if (place < stage->launch.list_end) {
    stage->indices[2 * place] = visit.ray;
    stage->indices[2 * place + 1] = triangle;
  }
  return false;
}

/// Visits the triangle of a record, if it is glass that the ray meets no farther than end. v: its corners in the world;
/// bits: kInstance... of what placed them.
static inline bool visitTriangle(const StageRef* stage, GlassVisit visit, uint place, Corners v, uint bits, uint id,
                                 ShearedRay ray, float end) {
  const uint surface = stage->scene.surfaces[kSurfaceHeaderWords + place];
  const float t = intersectTriangle(ray, v.a, v.b, v.c);
  return t > 0.0f && t <= end &&
         placedSurfaceHolds(stage->scene.surfaces, surface, ray, v.a, v.b, v.c, (bits & kInstanceMirrors) != 0) &&
         visitGlass(stage, visit, id);
}

static inline bool isGlass(const StageRef* stage, uint place) {
  return (stage->scene.surfaces[kSurfaceHeaderWords + place] & kSurfaceGlass) != 0;
}

static inline bool visitStored(const StageRef* stage, GlassVisit visit, uint place, ShearedRay ray, float end) {
  if (!isGlass(stage, place)) return false;
  __global const SceneTriangle* record = &stage->scene.triangles[place];
  return visitTriangle(stage, visit, place, recordCorners(record), 0u, recordId(record), ray, end);
}

#define SL_WALK walkGlassTree
#define SL_WALK_PARAM
#define SL_VISIT(i) visitStored(stage, visit, i, ray, end)
#include "cl_kernels/glass_walk.inl"
#undef SL_WALK
#undef SL_WALK_PARAM
#undef SL_VISIT

#if SL_INSTANCES
static inline bool visitPlaced(const StageRef* stage, GlassVisit visit, __global const InstanceRecord* instance,
                               uint place, ShearedRay ray, float end) {
  if (!isGlass(stage, place)) return false;
  __global const SceneTriangle* record = &stage->scene.triangles[place];
  return visitTriangle(stage, visit, place, placedCorners(instance, record), instance->roots.z,
                       instance->ids.x + recordId(record), ray, end);
}

#define SL_WALK walkGlassMesh
#define SL_WALK_PARAM , __global const InstanceRecord* instance
#define SL_VISIT(i) visitPlaced(stage, visit, instance, i, ray, end)
#include "cl_kernels/glass_walk.inl"
#undef SL_WALK
#undef SL_WALK_PARAM
#undef SL_VISIT

static inline bool walkGlassInstance(const StageRef* stage, GlassVisit visit, uint number, Ray world, BoxRay box_ray,
                                     ShearedRay ray, float end) {
  __global const InstanceRecord* instance = &stage->scene.instances[number];
  const uint root = instance->roots.x;
  if ((instance->roots.z & kInstanceInPlace) != 0) return walkGlassTree(stage, visit, root, box_ray, ray, end);
  const BoxRay inner = boxRayIn(stage->scene, instance, world);
  return walkGlassMesh(stage, visit, root, inner, ray, end, instance);
}

#define SL_WALK walkGlassInstances
#define SL_WALK_PARAM , Ray world
#define SL_VISIT(i) walkGlassInstance(stage, visit, stage->scene.instance_order[i], world, box_ray, ray, end)
#include "cl_kernels/glass_walk.inl"
#undef SL_WALK
#undef SL_WALK_PARAM
#undef SL_VISIT
#endif

/// Visits the glass that the ray meets no farther than its hit; some perhaps several times. true: SL_GLASS_TEST found
/// some that the set lacks.
static bool walkGlass(const StageRef* stage, GlassVisit visit, Ray ray, Hit hit) {
  if (!hasDirection(ray)) return false;
  const float end = hit.triangle == kNoTriangle ? as_float(0x7f800000u) : hit.t;
  const BoxRay box_ray = boxRay(ray, stage->scene.reach);
#if SL_INSTANCES
  return walkGlassInstances(stage, visit, stage->scene.root, box_ray, shearRay(ray), end, ray);
#else
  return walkGlassTree(stage, visit, 0u, box_ray, shearRay(ray), end);
#endif
}

static inline void insertGlass(const StageRef* stage, Ray ray, Hit hit, uint index) {
  GlassVisit visit;
  visit.action = SL_GLASS_INSERT;
  visit.ray = index;
  walkGlass(stage, visit, ray, hit);
}

static inline bool lacksGlass(const StageRef* stage, Ray ray, Hit hit) {
  GlassVisit visit;
  visit.action = SL_GLASS_TEST;
  visit.ray = 0;
  return walkGlass(stage, visit, ray, hit);
}

#endif

#define SL_TRACE_GLASS(X) X(counters) X(indices) X(rays) X(hits)
/// Lists the glass that each of the rays meets no farther than its hit, pairs of ray and triangle, in `indices`: as
/// many as list_end; counts all.
__kernel void traceGlass(SL_STAGE_ARGS(SL_TRACE_GLASS)) {
#if SL_HAS_GLASS
  SL_STAGE_PACK(SL_TRACE_GLASS)
  const uint first = (uint)get_global_id(0) * SL_PACKET;
  for (uint i = first; i < min(first + SL_PACKET, launch.item_count); ++i) {
    GlassVisit visit;
    visit.action = SL_GLASS_LIST;
    visit.ray = i;
    walkGlass(&stage, visit, rays[i], hits[i]);
  }
#endif
}

#endif
