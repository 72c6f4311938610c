// Meshes that a scene holds once and shows in many places: where their vertices are, and how a ray reaches
// them.
//
// A vertex of an instance is *defined* as what placeVertex makes of the mesh's vertex: four float operations
// an axis in a fixed order. Whoever writes the instances out as plain triangles (core/scene/instances.h) and
// every device that meets a triangle in a mesh's leaf computes it so, bit for bit, and tests that triangle
// with the ray as it is in the world. So a hit and its t are those of the flattened scene. Only the way to
// the leaf is another: through the mesh's own boxes, by a ray that is taken into the mesh's space (localRay).
// That way may meet more leaves than needed, but must not miss one: its boxes are grown by what the ray may
// be off.
//
// Error analysis, with u, S of triangle.h. A: the placement's three columns, B: its inverse, T: its origin; w
// = A v + T. r_i: sum of the magnitudes of B's row i; Q: the largest magnitude in o - T; V_i: largest |v_i|
// of the mesh; R: largest over the axes of |T_i| + sum |A_ij| V_j. Offsets are those of the local point that
// belongs to the hit, on axis i.
// 1. The point o + t d is within 25 u S of the world-space triangle (triangle.h), whose vertices are within
//    4 u R of A v + T: r_i (25 u S + 4 u R).
// 2. B is computed in double from the placement's floats and rounded: u of every entry (doubles add 2^-30 of
// r_i
//    at the condition that canInstance allows). o - T rounds once; the sums of three products by 3 u: in all
//    r_i 5 u Q for the origin, r_i 4 u S for t times the direction, as |t d| <= S.
// 3. Slab distances err by 4.1 u (|p| + |o|) (box.h), |p| <= V_i, |o| <= r_i Q.
// 4. Slopes below 2^-40 of the largest are replaced: at a condition of at most kMostCondition that is less
// than
//    r_i u S.
// In all r_i u (30 S + 9.1 Q + 4 R) + 4.1 u V_i. The boxes are grown by r_i u (48 S + 16 Q + 8 R) + 8 u V_i.
//
// The range of S / max |direction| that box.h asks for shrinks by kMostCondition on both sides.
#ifndef SL_PLACEMENT_H
#define SL_PLACEMENT_H
#include "core/shared/box.h"
#include "core/shared/types.h"
SL_NAMESPACE_BEGIN

/// From a mesh's space to the world: what x, y and z of the mesh become, and where its origin is. xyz; w = 0.
SL_STRUCT(Placement) {
  vec4 x;
  vec4 y;
  vec4 z;
  vec4 origin;
};

SL_FUNC vec3 placeVertex(Placement place, vec3 v) {
  return vec3(((place.origin.x + v.x * place.x.x) + v.y * place.y.x) + v.z * place.z.x,
              ((place.origin.y + v.x * place.x.y) + v.y * place.y.y) + v.z * place.z.y,
              ((place.origin.z + v.x * place.x.z) + v.y * place.y.z) + v.z * place.z.z);
}

/// The instance is mirrored: the second and third corner of each triangle change places, so that its front
/// stays the front.
SL_CONST uint kInstanceMirrors = 1u;
/// The triangles are in world space already, bit for bit: those of the scene that are in no mesh.
SL_CONST uint kInstanceInPlace = 2u;

/// An instance as tracers read it.
SL_STRUCT(InstanceRecord) {
  Placement place;
  vec4 local_x;  ///< xyz: first row of B; w: r_x, rounded up
  vec4 local_y;
  vec4 local_z;
  vec4 padding;  ///< xyz: u (8 R r_i + 8 V_i), rounded up
  uvec4 ids;     ///< x: id of its first triangle, y: how many it has, z: triangles in no mesh with lower
                 ///< ids, w: the mesh's first in Scene::triangles
  uvec4 roots;   ///< x: root of its tree in nodes2, y: in nodes8, z: bits kInstance...
};

/// Where the corners of a triangle are stored: an index of Scene::triangles, and the instance that places
/// them, in the order of ids; kNoTriangle: none, they are in place.
SL_STRUCT(StoredTriangle) {
  uint triangle;
  uint instance;
};

SL_FUNC Corners placeCorners(Placement place, uint bits, vec3 a, vec3 b, vec3 c) {
  Corners corners;
  bool mirrors = (bits & kInstanceMirrors) != 0u;
  corners.a = placeVertex(place, a);
  corners.b = placeVertex(place, mirrors ? c : b);
  corners.c = placeVertex(place, mirrors ? b : c);
  return corners;
}

SL_FUNC float weighedSum(vec4 row, vec3 v) {
  return (row.x * v.x + row.y * v.y) + row.z * v.z;
}

/// The ray in the mesh's space; t is the same.
SL_FUNC Ray localRay(InstanceRecord instance, Ray ray) {
  vec3 from = vec3(ray.origin.x - instance.place.origin.x, ray.origin.y - instance.place.origin.y,
                   ray.origin.z - instance.place.origin.z);
  vec3 along = vec3(ray.direction.x, ray.direction.y, ray.direction.z);
  Ray inner;
  inner.origin = vec4(weighedSum(instance.local_x, from), weighedSum(instance.local_y, from),
                      weighedSum(instance.local_z, from), 0.0f);
  inner.direction = vec4(weighedSum(instance.local_x, along), weighedSum(instance.local_y, along),
                         weighedSum(instance.local_z, along), 0.0f);
  return inner;
}

// The factors of S and Q above, times u.
SL_CONST float kReachPadding = 2.8610229e-6f;   // 48 * 2^-24
SL_CONST float kOriginPadding = 9.5367432e-7f;  // 16 * 2^-24

/// What the mesh's boxes are tested with. inner: localRay; scene_reach: of the whole scene.
SL_FUNC BoxRay instanceBoxRay(InstanceRecord instance, Ray ray, Ray inner, float scene_reach) {
  vec4 o = ray.origin;
  vec4 t = instance.place.origin;
  float size = max(fabs(o.x), max(fabs(o.y), fabs(o.z))) + scene_reach;
  float from = max(fabs(o.x - t.x), max(fabs(o.y - t.y), fabs(o.z - t.z)));
  float spread = kReachPadding * size + kOriginPadding * from;
  return paddedBoxRay(inner, vec3(instance.local_x.w * spread + instance.padding.x,
                                  instance.local_y.w * spread + instance.padding.y,
                                  instance.local_z.w * spread + instance.padding.z));
}

SL_NAMESPACE_END
#endif
