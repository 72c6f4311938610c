// The glass that a ray meets before what ends it: a second walk, bounded by where the first one ended, so that what is
// seen depends on no order. A scene without glass has none of this.
#ifndef SL_GLASS_CL
#define SL_GLASS_CL
#include "cl_kernels/stage.cl"

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

static inline bool visitLeaf(const StageRef* stage, GlassVisit visit, uint first, uint count, ShearedRay ray,
                             float end) {
  bool lacks = false;
  for (uint i = first; i < first + count; ++i) {
    const uint surface = stage->scene.surfaces[kSurfaceHeaderWords + i];
    if ((surface & kSurfaceGlass) == 0) continue;
    const Corners v = recordCorners(&stage->scene.triangles[i]);
    const float t = intersectTriangle(ray, v.a, v.b, v.c);
    if (!(t > 0.0f && t <= end)) continue;
    if (!surfaceHolds(stage->scene.surfaces, surface, ray, v.a, v.b, v.c)) continue;
    lacks |= visitGlass(stage, visit, recordId(&stage->scene.triangles[i]));
  }
  return lacks;
}

/// Visits the glass that the ray meets no farther than its hit; some perhaps several times. true: SL_GLASS_TEST found
/// some that the set lacks.
static bool walkGlass(const StageRef* stage, GlassVisit visit, Ray ray, Hit hit) {
  if (!hasDirection(ray)) return false;
  const float end = hit.triangle == kNoTriangle ? as_float(0x7f800000u) : hit.t;
  const BoxRay box_ray = boxRay(ray, stage->scene.reach);
  const ShearedRay sheared = shearRay(ray);
  uint stack[SL_MAX_DEPTH + 1];
  uint size = 0;
  uint place = 0;
  bool lacks = false;
  for (;;) {
    const BvhNode2 node = stage->scene.nodes[place];
    uint next = kNoTriangle;
    for (uint i = 0; i < 2; ++i) {
      const float2 range =
          i == 0 ? intersectBox(box_ray, vec3(node.x.x, node.y.x, node.z.x), vec3(node.x.y, node.y.y, node.z.y))
                 : intersectBox(box_ray, vec3(node.x.z, node.y.z, node.z.z), vec3(node.x.w, node.y.w, node.z.w));
      if (!(range.x <= min(range.y, end)) || node.child[i] == kNoTriangle) continue;
      if (node.count[i] > 0) {
        lacks |= visitLeaf(stage, visit, node.child[i], node.count[i], sheared, end);
      } else if (next == kNoTriangle) {
        next = node.child[i];
      } else {
        stack[size++] = node.child[i];
      }
    }
    if (next == kNoTriangle) {
      if (size == 0) return lacks;
      next = stack[--size];
    }
    place = next;
  }
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
