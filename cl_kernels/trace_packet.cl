// Eight rays together through the 2-wide tree: the way of CPUs, where a vector register holds a packet.
// Every number of the triangle test is computed as in core/shared/triangle.h, lane by lane.
#include "cl_kernels/ray_packet.cl"

#if SL_PACKET == 8

/// Box distances may be contracted: they are conservative either way.
static inline float8 slab(float plane, float8 inverse, float8 addend) {
#if defined(FP_FAST_FMAF) || defined(__FMA__)
  return fma((float8)plane, inverse, addend);
#else
  return plane * inverse + addend;
#endif
}

/// Rays of one class: same signs of the directions, same axis of depth.
typedef struct Packet {
  float8 inverse_x, inverse_y, inverse_z;
  float8 near_x, near_y, near_z;  // addends
  float8 far_x, far_y, far_z;
  float8 origin_x, origin_y, origin_z;  // in the order of the axes below
  float8 shear_x, shear_y, shear_z;
  uint axis_x, axis_y, axis_z;
  uint back_x, back_y, back_z;  // 1: the direction is negative
  float8 t;
  uint8 triangle;
  uint glass;  // as of HitPacket
} Packet;

#if SL_HAS_SURFACES
/// A lane's ray as the triangle test has it.
static inline ShearedRay shearedLane(const Packet* p, uint lane) {
  ShearedRay ray;
  ray.origin = vec4(((const float*)&p->origin_x)[lane], ((const float*)&p->origin_y)[lane],
                    ((const float*)&p->origin_z)[lane], 0.0f);
  ray.shear = vec4(((const float*)&p->shear_x)[lane], ((const float*)&p->shear_y)[lane],
                   ((const float*)&p->shear_z)[lane], 0.0f);
  ray.axes = uvec4(p->axis_x, p->axis_y, p->axis_z, 0u);
  return ray;
}

/// Those of the lanes, a bit each, that meet something where they hit the triangle: lane by lane.
static inline uint lanesThatHold(SceneRef scene, uint surface, Corners v, bool mirrored, const Packet* p, uint lanes) {
  uint holding = 0;
  for (uint left = lanes; left != 0; left &= left - 1) {
    const uint lane = slLowestBit(left);
    if (placedSurfaceHolds(scene.surfaces, surface, shearedLane(p, lane), v.a, v.b, v.c, mirrored)) {
      holding |= 1u << lane;
    }
  }
  return holding;
}
#endif

static inline float8 preciseDepth8(float8 fax, float8 fay, float8 faz, float8 fbx, float8 fby, float8 fbz,
                                   float8 fcx, float8 fcy, float8 fcz) {
  double8 ax = convert_double8(fax);
  double8 ay = convert_double8(fay);
  double8 bx = convert_double8(fbx);
  double8 by = convert_double8(fby);
  double8 cx = convert_double8(fcx);
  double8 cy = convert_double8(fcy);
  double8 u = cx * by - cy * bx;
  double8 v = ax * cy - ay * cx;
  double8 w = bx * ay - by * ax;
  long8 mixed = ((u < 0.0) | (v < 0.0) | (w < 0.0)) & ((u > 0.0) | (v > 0.0) | (w > 0.0));
  double8 det = u + v + w;
  double8 depth = (u * convert_double8(faz) + v * convert_double8(fbz) + w * convert_double8(fcz)) / det;
  return convert_float8((mixed | (det == 0.0)) ? (double8)0.0 : depth);
}

/// Bits of the lanes whose direction's sign or depth axis is that of lane `first`.
static inline uint lanesLike(uint first, uint bits) {
  return (bits >> first & 1u) != 0 ? bits : ~bits;
}

/// 1 / direction and the addends of boxRay (core/shared/box.h) along one axis.
static inline float8 inverseSlope(float8 direction, float8 smallest) {
  float8 bounded = direction < 0.0f ? -smallest : smallest;
  return 1.0f / (fabs(direction) < smallest ? bounded : direction);
}

#define SL_INTERSECT intersectStored8
#define SL_VERTICES __global
#include "cl_kernels/packet_triangle.inl"
#undef SL_INTERSECT
#undef SL_VERTICES

/// A triangle that is stored where it is.
static inline void intersectRecord8(SceneRef scene, uint place, Packet* p) {
  intersectStored8(scene, place, scene.triangles[place].vertices, 0u, scene.triangles[place].id, p);
}

#define SL_WALK walkTriangles8
#define SL_WALK_PARAM
#define SL_VISIT(i) intersectRecord8(scene, i, p)
#include "cl_kernels/packet_walk.inl"
#undef SL_WALK
#undef SL_WALK_PARAM
#undef SL_VISIT

#if SL_INSTANCES
#include "cl_kernels/packet_instance.cl"
#else
static inline void tracePacket(SceneRef scene, const RayPacket* rays, Packet* p) {
  walkTriangles8(scene, 0, p);
}
#endif

/// The nearest hits of all lanes; t of a miss is not a number to use. Lanes of one class (signs of the
/// direction, axis of depth) go through the tree together; rays that were put side by side well are of one
/// class.
static HitPacket traceLanes(SceneRef scene, const RayPacket* rays) {
  float8 x = fabs(rays->direction[0]);
  float8 y = fabs(rays->direction[1]);
  float8 z = fabs(rays->direction[2]);
  float8 largest = most(x, most(y, z));
  uint waiting = laneBits(largest > 0.0f);
  // Lanes without a ray compute with something harmless.
  float8 smallest = largest > 0.0f ? largest * kSmallestSlope : (float8)1.0f;
  float8 far_origin = most(fabs(rays->origin[0]), most(fabs(rays->origin[1]), fabs(rays->origin[2])));
  float8 padding = kBoxPadding * (far_origin + scene.reach);
  uint back_x = laneBits(rays->direction[0] < 0.0f);
  uint back_y = laneBits(rays->direction[1] < 0.0f);
  uint back_z = laneBits(rays->direction[2] < 0.0f);
  uint deep_x = laneBits((x >= y) & (x >= z));
  uint deep_y = laneBits(y >= z) & ~deep_x;

  Packet p;
  p.inverse_x = inverseSlope(rays->direction[0], smallest);
  p.inverse_y = inverseSlope(rays->direction[1], smallest);
  p.inverse_z = inverseSlope(rays->direction[2], smallest);
  float8 middle_x = -rays->origin[0] * p.inverse_x;
  float8 middle_y = -rays->origin[1] * p.inverse_y;
  float8 middle_z = -rays->origin[2] * p.inverse_z;
  p.near_x = middle_x - padding * fabs(p.inverse_x);
  p.near_y = middle_y - padding * fabs(p.inverse_y);
  p.near_z = middle_z - padding * fabs(p.inverse_z);
  p.far_x = middle_x + padding * fabs(p.inverse_x);
  p.far_y = middle_y + padding * fabs(p.inverse_y);
  p.far_z = middle_z + padding * fabs(p.inverse_z);

  HitPacket hits;
  hits.t = (float8)as_float(0x7f800000u);
  hits.triangle = (uint8)kNoTriangle;
  hits.glass = 0;
  while (waiting != 0) {
    uint first = 31u - clz(waiting & (0u - waiting));
    uint taken = waiting & lanesLike(first, back_x) & lanesLike(first, back_y) & lanesLike(first, back_z) &
                 lanesLike(first, deep_x) & lanesLike(first, deep_y);
    waiting &= ~taken;
    p.back_x = back_x >> first & 1u;
    p.back_y = back_y >> first & 1u;
    p.back_z = back_z >> first & 1u;
    uint depth = (deep_x >> first & 1u) != 0 ? 0u : ((deep_y >> first & 1u) != 0 ? 1u : 2u);
    p.axis_x = depth == 2u ? 0u : depth + 1u;
    p.axis_y = depth == 0u ? 2u : depth - 1u;
    p.axis_z = depth;
    p.origin_x = rays->origin[p.axis_x];
    p.origin_y = rays->origin[p.axis_y];
    p.origin_z = rays->origin[p.axis_z];
    float8 along = rays->direction[p.axis_z];
    p.shear_x = rays->direction[p.axis_x] / along;
    p.shear_y = rays->direction[p.axis_y] / along;
    p.shear_z = 1.0f / along;
    int8 takes_part = ((int8)(int)taken & (int8)(1, 2, 4, 8, 16, 32, 64, 128)) != 0;
    p.t = takes_part ? (float8)as_float(0x7f800000u) : (float8)-1.0f;
    p.triangle = (uint8)kNoTriangle;
    p.glass = 0;
    tracePacket(scene, rays, &p);
    hits.t = takes_part ? p.t : hits.t;
    hits.triangle = takes_part ? p.triangle : hits.triangle;
    hits.glass |= p.glass & taken;
  }
  return hits;
}

static inline void storeHits(HitPacket packet, Hit* hits) {
  float t[8];
  uint triangle[8];
  vstore8(packet.t, 0, t);
  vstore8(packet.triangle, 0, triangle);
  for (uint i = 0; i < 8; ++i) {
    hits[i].t = t[i];
    hits[i].triangle = triangle[i];
  }
}

/// Nearest hits. Returns the bits of the rays that met glass before what ends them, and perhaps of others.
static uint traceRays(SceneRef scene, const Ray* rays, Hit* hits) {
  RayPacket packet;
#define SL_LANES(field, a)                                                                      \
  (float8)(rays[0].field.a, rays[1].field.a, rays[2].field.a, rays[3].field.a, rays[4].field.a, \
           rays[5].field.a, rays[6].field.a, rays[7].field.a)
  packet.origin[0] = SL_LANES(origin, x);
  packet.origin[1] = SL_LANES(origin, y);
  packet.origin[2] = SL_LANES(origin, z);
  packet.direction[0] = SL_LANES(direction, x);
  packet.direction[1] = SL_LANES(direction, y);
  packet.direction[2] = SL_LANES(direction, z);
#undef SL_LANES
  const HitPacket found = traceLanes(scene, &packet);
  storeHits(found, hits);
  return found.glass;
}

#endif
