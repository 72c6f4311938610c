// The sampling stages' main function and their way to the nearest hit: a ray generation shader of a ray
// tracing pipeline, or, with SL_RAY_QUERY, ray queries in a compute shader.
#extension GL_GOOGLE_include_directive : require
#if SL_RAY_QUERY
#extension GL_EXT_ray_query : require
#else
#extension GL_EXT_ray_tracing : require
#endif
#include "vk_shaders/sampling.glsl"

/// What the driver found: t, and the leaf (a triangle's place in the order of upload) or kNoTriangle.
struct LeafHit {
  float t;
  uint leaf;
  uint part;  ///< the instance of the top level that it was met in
};

const float kFarthest = 3.402823466e38f;

uint leafOf(uint part, uint primitive) {
  return Buffer_uint(SL_THE_LAUNCH.part_starts).at[part] + primitive;
}

#if SL_RAY_QUERY

layout(local_size_x_id = 0) in;
uint itemIndex() {
  return gl_GlobalInvocationID.x;
}

LeafHit traceNearest(Ray ray) {
  rayQueryEXT query;
  rayQueryInitializeEXT(query, accelerationStructureEXT(SL_THE_LAUNCH.tlas), gl_RayFlagsOpaqueEXT, 0xffu,
                        ray.origin.xyz, 0.0f, ray.direction.xyz, kFarthest);
  while (rayQueryProceedEXT(query)) {
  }
  if (rayQueryGetIntersectionTypeEXT(query, true) == gl_RayQueryCommittedIntersectionNoneEXT) {
    return LeafHit(0.0f, kNoTriangle, 0u);
  }
  uint part = rayQueryGetIntersectionInstanceCustomIndexEXT(query, true);
  uint primitive = rayQueryGetIntersectionPrimitiveIndexEXT(query, true);
  return LeafHit(rayQueryGetIntersectionTEXT(query, true), leafOf(part, primitive), part);
}

#else

/// x: bits of t, y: instance's custom index or kNoTriangle, z: primitive.
layout(location = 0) rayPayloadEXT uvec3 found;
uint itemIndex() {
  return gl_LaunchIDEXT.x;
}

LeafHit traceNearest(Ray ray) {
  traceRayEXT(accelerationStructureEXT(SL_THE_LAUNCH.tlas), gl_RayFlagsOpaqueEXT, 0xffu, 0u, 0u, 0u,
              ray.origin.xyz, 0.0f, ray.direction.xyz, kFarthest, 0);
  if (found.y == kNoTriangle) return LeafHit(0.0f, kNoTriangle, 0u);
  return LeafHit(uintBitsToFloat(found.x), leafOf(found.y, found.z), found.y);
}

#endif

/// Nearest hit of a ray, by leaf; a ray without direction hits nothing.
LeafHit nearestHit(Ray ray) {
  if (!hasDirection(ray)) return LeafHit(0.0f, kNoTriangle, 0u);
  return traceNearest(ray);
}

uint triangleOf(LeafHit hit) {
  if (hit.leaf == kNoTriangle) return kNoTriangle;
  return Buffer_uint(SL_THE_LAUNCH.leaf_ids).at[hit.leaf] + Buffer_uint(SL_THE_LAUNCH.part_ids).at[hit.part];
}

/// Nearest hit of a ray, by triangle; t of a miss is 0.
Hit nearestTriangle(Ray ray) {
  LeafHit nearest = nearestHit(ray);
  Hit hit;
  hit.t = nearest.t;
  hit.triangle = triangleOf(nearest);
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
