// Eight rays together through the 2-wide tree: the way of CPUs, where a vector register holds a packet.
// Every number of the triangle test is computed as in core/shared/triangle.h, lane by lane.
#include "cl_kernels/scene.cl"

#if SL_PACKET == 8

/// Bit i: lane i of the mask is set (all bits of it).
static inline uint laneBits(int8 mask) {
#ifdef __AVX__
  return (uint)__builtin_ia32_movmskps256(as_float8(mask));
#else
  int8 bits = mask & (int8)(1, 2, 4, 8, 16, 32, 64, 128);
  int4 sum4 = bits.lo + bits.hi;
  int2 sum2 = sum4.lo + sum4.hi;
  return (uint)(sum2.x + sum2.y);
#endif
}

/// `min` and `max` of OpenCL take several instructions for their rules on NaN; these take one.
static inline float8 least(float8 a, float8 b) { return a < b ? a : b; }
static inline float8 most(float8 a, float8 b) { return a > b ? a : b; }

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
} Packet;

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
  return convert_float8(mixed | (det == 0.0) ? (double8)0.0 : depth);
}

static inline void intersectRecord8(__global const TriangleRecord* record, Packet* p) {
  __global const float* vertices = record->vertices;
  float8 az = vertices[p->axis_z] - p->origin_z;
  float8 ax = (vertices[p->axis_x] - p->origin_x) - p->shear_x * az;
  float8 ay = (vertices[p->axis_y] - p->origin_y) - p->shear_y * az;
  float8 bz = vertices[3 + p->axis_z] - p->origin_z;
  float8 bx = (vertices[3 + p->axis_x] - p->origin_x) - p->shear_x * bz;
  float8 by = (vertices[3 + p->axis_y] - p->origin_y) - p->shear_y * bz;
  float8 cz = vertices[6 + p->axis_z] - p->origin_z;
  float8 cx = (vertices[6 + p->axis_x] - p->origin_x) - p->shear_x * cz;
  float8 cy = (vertices[6 + p->axis_y] - p->origin_y) - p->shear_y * cz;
  float8 u = cx * by - cy * bx;
  float8 v = ax * cy - ay * cx;
  float8 w = bx * ay - by * ax;
  float8 lowest = least(u, least(v, w));
  float8 highest = most(u, most(v, w));
  int8 inside = (lowest >= 0.0f) | (highest <= 0.0f);
  if (laneBits(inside) == 0) return;

  float8 det = u + v + w;
  float8 reach = most(most(most(fabs(ax), fabs(ay)), most(fabs(bx), fabs(by))), most(fabs(cx), fabs(cy)));
  float8 nearest = least(az, least(bz, cz));
  float8 farthest = most(az, most(bz, cz));
  float8 area = fabs(det);
  float8 trusted = area * most(fabs(nearest), fabs(farthest));
  int8 rough = (trusted < most(reach * reach * (farthest - nearest), (float8)kUnderflowGuard)) |
               (area < kUnderflowGuard) | (u == 0.0f) | (v == 0.0f) | (w == 0.0f);
  float8 depth = (u * az + v * bz + w * cz) / det;
  if (laneBits(rough & inside) != 0) {
    float8 precise = preciseDepth8(ax, ay, az, bx, by, bz, cx, cy, cz);
    depth = rough ? precise : depth;
  }
  float8 t = depth * p->shear_z;
  uint id = record->id;
  // An infinite t is no hit: p->t starts at infinity, and the id of a miss is the largest.
  int8 closer = (t < p->t) | ((t == p->t) & (id < p->triangle) & (t < as_float(0x7f800000u)));
  int8 hit = inside & (t > 0.0f) & closer;
  p->t = hit ? t : p->t;
  p->triangle = hit ? (uint8)id : p->triangle;
}

/// Visits the tree with all lanes; lanes with t < 0 take no part.
static void tracePacket(SceneRef scene, Packet* p) {
  float8 stack_near[SL_STACK_SIZE];
  uint stack_child[SL_STACK_SIZE];
  uint stack_count[SL_STACK_SIZE];
  uint size = 0;
  uint child = 0;
  uint count = 0;
  for (;;) {
    while (count == 0) {
      __global const float* node = (__global const float*)&scene.nodes[child];
      __global const uint* links = (__global const uint*)(node + 12);
      float8 near0 = most(most(slab(node[p->back_x], p->inverse_x, p->near_x),
                               slab(node[4 + p->back_y], p->inverse_y, p->near_y)),
                          most(slab(node[8 + p->back_z], p->inverse_z, p->near_z), (float8)0.0f));
      float8 far0 = least(least(slab(node[1 - p->back_x], p->inverse_x, p->far_x),
                                slab(node[5 - p->back_y], p->inverse_y, p->far_y)),
                          least(slab(node[9 - p->back_z], p->inverse_z, p->far_z), p->t));
      float8 near1 = most(most(slab(node[2 + p->back_x], p->inverse_x, p->near_x),
                               slab(node[6 + p->back_y], p->inverse_y, p->near_y)),
                          most(slab(node[10 + p->back_z], p->inverse_z, p->near_z), (float8)0.0f));
      float8 far1 = least(least(slab(node[3 - p->back_x], p->inverse_x, p->far_x),
                                slab(node[7 - p->back_y], p->inverse_y, p->far_y)),
                          least(slab(node[11 - p->back_z], p->inverse_z, p->far_z), p->t));
      uint meets0 = laneBits(near0 <= far0);
      uint meets1 = laneBits(near1 <= far1);
      if (meets0 != 0 && meets1 != 0) {
        // First the child that most lanes of both enter first.
        uint both = meets0 | meets1;
        uint sooner1 = laneBits(near1 < near0) & both;
        bool swap = 2 * popcount(sooner1) > popcount(both);
        stack_near[size] = swap ? near0 : near1;
        uint first = swap ? 1 : 0;
        stack_child[size] = links[1 - first];
        stack_count[size] = links[3 - first];
        ++size;
        child = links[first];
        count = links[2 + first];
      } else if (meets0 != 0) {
        child = links[0];
        count = links[2];
      } else if (meets1 != 0) {
        child = links[1];
        count = links[3];
      } else {
        do {
          if (size == 0) return;
          --size;
        } while (laneBits(stack_near[size] <= p->t) == 0);
        child = stack_child[size];
        count = stack_count[size];
      }
    }
    for (uint i = child; i < child + count; ++i) intersectRecord8(&scene.triangles[i], p);
    do {
      if (size == 0) return;
      --size;
    } while (laneBits(stack_near[size] <= p->t) == 0);
    child = stack_child[size];
    count = stack_count[size];
  }
}

static void traceRays(SceneRef scene, const Ray* rays, Hit* hits) {
  uint classes[8];
  uint waiting = 0;
  for (uint i = 0; i < 8; ++i) {
    float4 d = rays[i].direction;
    hits[i] = missHit();
    float x = fabs(d.x);
    float y = fabs(d.y);
    float z = fabs(d.z);
    uint depth = x >= y ? (x >= z ? 0u : 2u) : (y >= z ? 1u : 2u);
    classes[i] = (d.x < 0.0f ? 1u : 0u) | (d.y < 0.0f ? 2u : 0u) | (d.z < 0.0f ? 4u : 0u) | (depth << 3);
    waiting |= isInactive(rays[i]) ? 0u : 1u << i;
  }
  while (waiting != 0) {
    uint first = 31u - clz(waiting & (0u - waiting));
    uint chosen = classes[first];
    Packet p;
    uint depth = chosen >> 3;
    p.axis_z = depth;
    p.axis_x = depth == 2u ? 0u : depth + 1u;
    p.axis_y = depth == 0u ? 2u : depth - 1u;
    p.back_x = chosen & 1u;
    p.back_y = (chosen >> 1) & 1u;
    p.back_z = (chosen >> 2) & 1u;
    float soa[19][8];
    uint taken = 0;
    for (uint i = 0; i < 8; ++i) {
      bool takes_part = (waiting >> i & 1u) != 0 && classes[i] == chosen;
      Ray ray = rays[takes_part ? i : first];
      BoxRay box_ray = boxRay(ray, scene.reach);
      ShearedRay sheared = shearRay(ray);
      taken |= takes_part ? 1u << i : 0u;
      soa[0][i] = box_ray.inverse.x;
      soa[1][i] = box_ray.inverse.y;
      soa[2][i] = box_ray.inverse.z;
      soa[3][i] = box_ray.near_addend.x;
      soa[4][i] = box_ray.near_addend.y;
      soa[5][i] = box_ray.near_addend.z;
      soa[6][i] = box_ray.far_addend.x;
      soa[7][i] = box_ray.far_addend.y;
      soa[8][i] = box_ray.far_addend.z;
      soa[9][i] = sheared.origin.x;
      soa[10][i] = sheared.origin.y;
      soa[11][i] = sheared.origin.z;
      soa[12][i] = sheared.shear.x;
      soa[13][i] = sheared.shear.y;
      soa[14][i] = sheared.shear.z;
      soa[15][i] = takes_part ? as_float(0x7f800000u) : -1.0f;
    }
    p.inverse_x = vload8(0, soa[0]);
    p.inverse_y = vload8(0, soa[1]);
    p.inverse_z = vload8(0, soa[2]);
    p.near_x = vload8(0, soa[3]);
    p.near_y = vload8(0, soa[4]);
    p.near_z = vload8(0, soa[5]);
    p.far_x = vload8(0, soa[6]);
    p.far_y = vload8(0, soa[7]);
    p.far_z = vload8(0, soa[8]);
    p.origin_x = vload8(0, soa[9]);
    p.origin_y = vload8(0, soa[10]);
    p.origin_z = vload8(0, soa[11]);
    p.shear_x = vload8(0, soa[12]);
    p.shear_y = vload8(0, soa[13]);
    p.shear_z = vload8(0, soa[14]);
    p.t = vload8(0, soa[15]);
    p.triangle = (uint8)kNoTriangle;
    tracePacket(scene, &p);
    float t[8];
    uint triangle[8];
    vstore8(p.t, 0, t);
    vstore8(p.triangle, 0, triangle);
    for (uint i = 0; i < 8; ++i) {
      if ((taken >> i & 1u) != 0) {
        hits[i].t = t[i];
        hits[i].triangle = triangle[i];
      }
    }
    waiting &= ~taken;
  }
}

#endif
