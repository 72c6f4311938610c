// The sampling stages' main function and their way to the nearest hit: a ray generation shader of a ray
// tracing pipeline, or, with SL_RAY_QUERY, ray queries in a compute shader. SL_HAS_SURFACES, only with ray queries:
// the scene has holes, glass or sides; SL_HAS_GLASS: it has glass.
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

#if SL_HAS_SURFACES
/// Whether the last ray met glass before what ended it, and perhaps where it met any.
bool met_glass;
const uint kTracedFlags = gl_RayFlagsNoneEXT;

uint surfaceOfLeaf(uint leaf) {
  return SL_SURFACE_WORD(kSurfaceHeaderWords + leaf);
}

/// Whether a ray that the driver says hits the leaf's triangle meets something there.
bool leafHolds(Ray ray, uint leaf) {
  return surfaceHolds(kTheSurfaces, surfaceOfLeaf(leaf), shearRay(ray), leafCorner(leaf, 0u), leafCorner(leaf, 1u),
                      leafCorner(leaf, 2u));
}
#else
const uint kTracedFlags = gl_RayFlagsOpaqueEXT;
#endif

LeafHit traceNearest(Ray ray) {
  rayQueryEXT query;
  rayQueryInitializeEXT(query, accelerationStructureEXT(SL_THE_LAUNCH.tlas), kTracedFlags, 0xffu, ray.origin.xyz,
                        0.0f, ray.direction.xyz, kFarthest);
  while (rayQueryProceedEXT(query)) {
#if SL_HAS_SURFACES
    uint leaf = leafOf(rayQueryGetIntersectionInstanceCustomIndexEXT(query, false),
                       rayQueryGetIntersectionPrimitiveIndexEXT(query, false));
    if ((surfaceOfLeaf(leaf) & kSurfaceGlass) != 0u) {
      met_glass = true;
    } else if (leafHolds(ray, leaf)) {
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
#if SL_HAS_SURFACES
  met_glass = false;
#endif
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

#if SL_HAS_GLASS
/// What becomes of glass that a ray meets: into the set under the ray's index, whether the set lacks any, or ray and
/// triangle into `indices`, as many as list_end.
const uint kInsertGlass = 0u;
const uint kTestGlass = 1u;
const uint kListGlass = 2u;

/// true: the set lacks the triangle.
bool visitGlass(uint action, uint index, uint triangle) {
  if (action == kTestGlass) return !isInSet(kTheSet, triangle);
  if (action == kInsertGlass) {
    insertHit(kTheSet, triangle, index);
    return false;
  }
  uint place = SL_STAGE_ADD(counters, kListCounter, 1u);
  if (place < SL_LAUNCH(list_end)) {
    SL_BUFFER(indices, 2u * place) = index;
    SL_BUFFER(indices, 2u * place + 1u) = triangle;
  }
  return false;
}

/// Visits the glass that a ray meets no farther than its hit, some perhaps several times. true: kTestGlass found some
/// that the set lacks.
bool walkGlass(uint action, uint index, Ray ray, Hit hit) {
  if (!hasDirection(ray)) return false;
  float end = hit.triangle == kNoTriangle ? kFarthest : hit.t;
  float beyond = end < kFarthest ? uintBitsToFloat(floatBitsToUint(end) + 1u) : end;
  bool lacks = false;
  rayQueryEXT query;
  rayQueryInitializeEXT(query, accelerationStructureEXT(SL_THE_LAUNCH.tlas), gl_RayFlagsCullOpaqueEXT, 0xffu,
                        ray.origin.xyz, 0.0f, ray.direction.xyz, beyond);
  while (rayQueryProceedEXT(query)) {
    uint leaf = leafOf(rayQueryGetIntersectionInstanceCustomIndexEXT(query, false),
                       rayQueryGetIntersectionPrimitiveIndexEXT(query, false));
    if ((surfaceOfLeaf(leaf) & kSurfaceGlass) == 0u || rayQueryGetIntersectionTEXT(query, false) > end) continue;
    if (leafHolds(ray, leaf) && visitGlass(action, index, Buffer_uint(SL_THE_LAUNCH.leaf_ids).at[leaf])) lacks = true;
  }
  return lacks;
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
