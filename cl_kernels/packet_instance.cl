// Eight rays through two levels: the instances' boxes in the world, then a mesh's own tree in its space, by rays that
// are taken there. A triangle is met in the world (core/shared/placement.h says why nothing is lost).
#define SL_INTERSECT intersectPlaced8
#define SL_VERTICES
#include "cl_kernels/packet_triangle.inl"
#undef SL_INTERSECT
#undef SL_VERTICES

/// placeCorners, three axes at once.
static inline void intersectInMesh8(SceneRef scene, __global const InstanceRecord* instance, uint place, Packet* p) {
  const bool mirrors = (instance->roots.z & kInstanceMirrors) != 0;
  __global const float* stored = scene.triangles[place].vertices;
  float vertices[9];
  for (uint corner = 0; corner < 3; ++corner) {
    __global const float* v = stored + 3 * corner;
    const float4 placed =
        ((instance->place.origin + v[0] * instance->place.x) + v[1] * instance->place.y) + v[2] * instance->place.z;
    vstore3(placed.xyz, mirrors && corner != 0 ? 3 - corner : corner, vertices);
  }
  intersectPlaced8(scene, place, vertices, instance->roots.z, instance->ids.x + scene.triangles[place].id, p);
}

#define SL_WALK walkMesh8
#define SL_WALK_PARAM , __global const InstanceRecord* instance
#define SL_VISIT(i) intersectInMesh8(scene, instance, i, p)
#include "cl_kernels/packet_walk.inl"
#undef SL_WALK
#undef SL_WALK_PARAM
#undef SL_VISIT

/// A row of the inverse with eight vectors.
static inline float8 weighedSum8(float4 row, const float8* v) {
  return (row.x * v[0] + row.y * v[1]) + row.z * v[2];
}

/// localRay and instanceBoxRay (core/shared/placement.h), lane by lane. Lanes whose direction's signs differ in the
/// mesh's space go through its tree in turn.
static void enterInstance8(SceneRef scene, const RayPacket* rays, uint number, Packet* p) {
  __global const InstanceRecord* instance = &scene.instances[number];
  if ((instance->roots.z & kInstanceInPlace) != 0) {
    walkTriangles8(scene, instance->roots.x, p);
    return;
  }
  const float8 from[3] = {rays->origin[0] - instance->place.origin.x, rays->origin[1] - instance->place.origin.y,
                          rays->origin[2] - instance->place.origin.z};
  const float4 rows[3] = {instance->local_x, instance->local_y, instance->local_z};
  const float padding[3] = {instance->padding.x, instance->padding.y, instance->padding.z};
  const float8 size =
      most(fabs(rays->origin[0]), most(fabs(rays->origin[1]), fabs(rays->origin[2]))) + scene.reach;
  const float8 far_from = most(fabs(from[0]), most(fabs(from[1]), fabs(from[2])));
  const float8 spread = kReachPadding * size + kOriginPadding * far_from;
  float8 direction[3], inverse[3], near[3], far[3];
  for (uint axis = 0; axis < 3; ++axis) direction[axis] = weighedSum8(rows[axis], rays->direction);
  const float8 largest = most(fabs(direction[0]), most(fabs(direction[1]), fabs(direction[2])));
  uint waiting = laneBits((p->t >= 0.0f) & (largest > 0.0f));
  const float8 smallest = largest > 0.0f ? largest * kSmallestSlope : (float8)1.0f;
  uint back[3];
  for (uint axis = 0; axis < 3; ++axis) {
    inverse[axis] = inverseSlope(direction[axis], smallest);
    const float8 middle = -weighedSum8(rows[axis], from) * inverse[axis];
    const float8 grown = (rows[axis].w * spread + padding[axis]) * fabs(inverse[axis]);
    near[axis] = middle - grown;
    far[axis] = middle + grown;
    back[axis] = laneBits(direction[axis] < 0.0f);
  }
  Packet inner = *p;
  inner.inverse_x = inverse[0];
  inner.inverse_y = inverse[1];
  inner.inverse_z = inverse[2];
  inner.near_x = near[0];
  inner.near_y = near[1];
  inner.near_z = near[2];
  inner.far_x = far[0];
  inner.far_y = far[1];
  inner.far_z = far[2];
  while (waiting != 0) {
    const uint first = 31u - clz(waiting & (0u - waiting));
    const uint taken =
        waiting & lanesLike(first, back[0]) & lanesLike(first, back[1]) & lanesLike(first, back[2]);
    waiting &= ~taken;
    inner.back_x = back[0] >> first & 1u;
    inner.back_y = back[1] >> first & 1u;
    inner.back_z = back[2] >> first & 1u;
    const int8 takes_part = ((int8)(int)taken & (int8)(1, 2, 4, 8, 16, 32, 64, 128)) != 0;
    inner.t = takes_part ? p->t : (float8)-1.0f;
    walkMesh8(scene, instance->roots.x, &inner, instance);
    p->t = takes_part ? inner.t : p->t;
    p->triangle = takes_part ? inner.triangle : p->triangle;
    p->glass |= inner.glass;
  }
}

#define SL_WALK walkInstances8
#define SL_WALK_PARAM , const RayPacket* rays
#define SL_VISIT(i) enterInstance8(scene, rays, scene.instance_order[i], p)
#include "cl_kernels/packet_walk.inl"
#undef SL_WALK
#undef SL_WALK_PARAM
#undef SL_VISIT

static inline void tracePacket(SceneRef scene, const RayPacket* rays, Packet* p) {
  walkInstances8(scene, scene.root, p, rays);
}
