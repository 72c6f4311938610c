// The sampling stages' main function and their way to the nearest hit: a ray generation shader of a ray
// tracing pipeline, or, with SL_RAY_QUERY, ray queries in a compute shader. SL_HAS_SURFACES: the scene has holes, glass
// or sides; SL_HAS_GLASS: it has glass.
#extension GL_GOOGLE_include_directive : require
#if SL_RAY_QUERY
#extension GL_EXT_ray_query : require
#else
#extension GL_EXT_ray_tracing : require
#include "vk_shaders/payload.glsl"
#endif
#include "vk_shaders/sampling.glsl"
#if SL_HAS_SURFACES
#include "vk_shaders/surfaces.glsl"
#endif

/// What the driver found: t, and the leaf (a triangle's place in the order of upload) or kNoTriangle.
struct LeafHit {
  float t;
  uint leaf;
  uint part;  ///< the instance of the top level that it was met in
};

const float kFarthest = 3.402823466e38f;

#if SL_HAS_SURFACES
const uint kTracedFlags = gl_RayFlagsNoneEXT;
/// Whether the last ray met glass before what ended it, and perhaps where it met any.
bool met_glass;
#else
const uint kTracedFlags = gl_RayFlagsOpaqueEXT;
#endif

#if SL_RAY_QUERY

layout(local_size_x_id = 0) in;
uint itemIndex() {
  return gl_GlobalInvocationID.x;
}

LeafHit traceNearest(Ray ray) {
  rayQueryEXT query;
  rayQueryInitializeEXT(query, accelerationStructureEXT(SL_THE_LAUNCH.tlas), kTracedFlags, 0xffu, ray.origin.xyz,
                        0.0f, ray.direction.xyz, kFarthest);
  while (rayQueryProceedEXT(query)) {
#if SL_HAS_SURFACES
    uint met_part = rayQueryGetIntersectionInstanceCustomIndexEXT(query, false);
    uint leaf = leafOf(met_part, rayQueryGetIntersectionPrimitiveIndexEXT(query, false));
    if (isGlass(leaf)) {
      met_glass = true;
    } else if (leafHolds(ray, leaf, met_part)) {
      rayQueryConfirmIntersectionEXT(query);
    }
#endif
  }
  if (rayQueryGetIntersectionTypeEXT(query, true) == gl_RayQueryCommittedIntersectionNoneEXT) {
    return LeafHit(0.0f, kNoTriangle, 0u);
  }
  uint part = rayQueryGetIntersectionInstanceCustomIndexEXT(query, true);
  uint primitive = rayQueryGetIntersectionPrimitiveIndexEXT(query, true);
  return LeafHit(rayQueryGetIntersectionTEXT(query, true), leafOf(part, primitive), part);
}

#if SL_HAS_GLASS
/// Visits the glass that the ray meets no farther than `end`; to be looked for up to `beyond`. true: the set lacks some.
bool traceGlass(uint action, uint index, Ray ray, float end, float beyond) {
  bool lacks = false;
  rayQueryEXT query;
  rayQueryInitializeEXT(query, accelerationStructureEXT(SL_THE_LAUNCH.tlas), gl_RayFlagsCullOpaqueEXT, 0xffu,
                        ray.origin.xyz, 0.0f, ray.direction.xyz, beyond);
  while (rayQueryProceedEXT(query)) {
    uint part = rayQueryGetIntersectionInstanceCustomIndexEXT(query, false);
    uint leaf = leafOf(part, rayQueryGetIntersectionPrimitiveIndexEXT(query, false));
    if (visitLeaf(action, index, ray, leaf, part, rayQueryGetIntersectionTEXT(query, false), end)) lacks = true;
  }
  return lacks;
}
#endif

#else

layout(location = 0) rayPayloadEXT SL_PAYLOAD carried;
uint itemIndex() {
  return gl_LaunchIDEXT.x;
}

LeafHit traceNearest(Ray ray) {
#if SL_HAS_GLASS
  carried.w = 0u;
#endif
  traceRayEXT(accelerationStructureEXT(SL_THE_LAUNCH.tlas), kTracedFlags, 0xffu, 0u, 0u, 0u, ray.origin.xyz, 0.0f,
              ray.direction.xyz, kFarthest, 0);
#if SL_HAS_GLASS
  met_glass = carried.w != 0u;
#endif
  if (carried.y == kNoTriangle) return LeafHit(0.0f, kNoTriangle, 0u);
  return LeafHit(uintBitsToFloat(carried.x), leafOf(carried.y, carried.z), carried.y);
}

#if SL_HAS_GLASS
/// As with ray queries: the second group of hit shaders visits.
bool traceGlass(uint action, uint index, Ray ray, float end, float beyond) {
  carried = uvec4(action, index, floatBitsToUint(end), 0u);
  traceRayEXT(accelerationStructureEXT(SL_THE_LAUNCH.tlas), gl_RayFlagsCullOpaqueEXT, 0xffu, 1u, 0u, 0u,
              ray.origin.xyz, 0.0f, ray.direction.xyz, beyond, 0);
  return carried.w != 0u;
}
#endif

#endif

/// Nearest hit of a ray, by leaf; a ray without direction hits nothing.
LeafHit nearestHit(Ray ray) {
#if SL_HAS_SURFACES
  met_glass = false;
#endif
  if (!hasDirection(ray)) return LeafHit(0.0f, kNoTriangle, 0u);
  return traceNearest(ray);
}

uint triangleOf(LeafHit hit) {
  if (hit.leaf == kNoTriangle) return kNoTriangle;
  return idOfLeaf(hit.leaf, hit.part);
}

/// Nearest hit of a ray, by triangle; t of a miss is 0.
Hit nearestTriangle(Ray ray) {
  LeafHit nearest = nearestHit(ray);
  Hit hit;
  hit.t = nearest.t;
  hit.triangle = triangleOf(nearest);
  return hit;
}

#if SL_HAS_GLASS
/// Visits the glass that a ray meets no farther than its hit, some perhaps several times. true: kTestGlass found some
/// that the set lacks.
bool walkGlass(uint action, uint index, Ray ray, Hit hit) {
  if (!hasDirection(ray)) return false;
  float end = hit.triangle == kNoTriangle ? kFarthest : hit.t;
  float beyond = end < kFarthest ? uintBitsToFloat(floatBitsToUint(end) + 1u) : end;
  return traceGlass(action, index, ray, end, beyond);
}
#endif

/// Traces a ray and inserts what it sees under its index.
Hit insertSight(Ray ray, uint index) {
  Hit hit = nearestTriangle(ray);
  insertHit(kTheSet, hit.triangle, index);
#if SL_HAS_GLASS
  if (met_glass) walkGlass(kInsertGlass, index, ray, hit);
#endif
  return hit;
}

void writeHit(uint item, Hit hit) {
  SL_BUFFER(hits, item) = hit;
}

void countRay(uint item) {
  SL_STAGE_ADD(counters, (item >> 5) % kRayCounters, 1u);
}

void runItem(uint item);

void main() {
  uint item = push.first_item + itemIndex();
  if (item < push.item_end) runItem(item);
}
