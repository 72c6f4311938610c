// Where a ray meets a triangle.
//
// Based on: Woop, Benthin, Wald, Watertight Ray/Triangle Intersection, JCGT 2(1), 2013. The vertices are
// moved to the ray's origin and sheared so that the ray becomes the positive depth axis; three edge
// functions of the remaining two coordinates say on which side of each edge the ray passes. Two triangles
// that share an edge compute the same number for it, up to the sign, so no ray slips between them.
//
// Where we differ: no culling; depth in world units (only the final multiplication knows the direction's
// length); and a second reason for the double path: where float would place the hit too far from the
// triangle. Then whether a triangle is hit, and at which t, is a function of ray and triangle alone, and
// the point at t lies so close to the triangle that a padded box test (box.h) never prunes it: the nearest
// hit does not depend on tree, layout, packets or order.
//
// Error analysis. u = 2^-24; S = largest |coordinate| of the origin plus largest |coordinate| of the
// scene, so that |vertex - origin| <= S on each axis; x, y: sheared coordinates, z: depth, m = max |x|, |y|
// and zmax = max |z| of the three vertices, zr = their range of z.
// 1. Vertices. The differences to the origin err by u S. The sheared x errs by u S for each of: the shear,
//    the product, and 2 u S for the subtraction. So x, y, z are exact for vertices that are moved by at most
//    5 u S on the two lateral axes and u S in depth. Neighbours see the same moved vertices.
// 2. Sides. Rounding is monotone: the sign of a float edge function is right, or the function is zero; zero
//    is computed again in double, where products of floats are exact.
// 3. Depth. With the exact edge functions U, V, W of the moved vertices, depth* = (U az + V bz + W cz) /
//    (U + V + W) is the depth of a point of the moved triangle on the ray. A float edge function errs by at
//    most 4 u m^2, and since the weighted sum of (z - depth*) vanishes, the depth errs by at most
//    3 * 4 u m^2 zr / |det| plus 8 u zmax for the roundings of sum, determinant, quotient and scaling.
//    Where m^2 zr > |det| zmax the first part could exceed 12 u zmax, so there everything is computed in
//    double (error 4 u zmax). In all, the point at t is within 5 u S + 20 u S = 25 u S of a point of the
//    true triangle, on every axis.
// Below kUnderflowGuard products lose bits to underflow and the analysis fails, so double is used as well.
//
// Coordinates up to 2^40 in magnitude. NaN in ray or triangle: a miss or any hit, never more harm than that.
#ifndef SL_TRIANGLE_H
#define SL_TRIANGLE_H
#include "core/shared/two_float.h"
#include "core/shared/types.h"
SL_NAMESPACE_BEGIN

/// Determinants (area times two, world units squared) and determinants times depth below this are left to
/// double. Not a tolerance: the result is the same number, more exactly.
SL_CONST float kUnderflowGuard = 8.0779357e-28f;  // 2^-90

/// What the triangle test needs of a ray, computed once a ray.
SL_STRUCT(ShearedRay) {
  vec4 origin;  ///< coordinates in the order of axes
  vec4 shear;   ///< x, y: slope of the two lateral axes over depth; z: 1 / direction along depth
  uvec4 axes;   ///< x, y: lateral, z: depth, the axis of the largest |direction| (the first of equals)
};

SL_FUNC float componentAt(vec3 v, uint axis) {
  return axis == 0u ? v.x : (axis == 1u ? v.y : v.z);
}

/// The direction must not be zero.
SL_FUNC ShearedRay shearRay(Ray ray) {
  float x = fabs(ray.direction.x);
  float y = fabs(ray.direction.y);
  float z = fabs(ray.direction.z);
  uint depth = x >= y ? (x >= z ? 0u : 2u) : (y >= z ? 1u : 2u);
  uint lateral = depth == 2u ? 0u : depth + 1u;
  uint lateral2 = depth == 0u ? 2u : depth - 1u;
  vec3 origin = vec3(ray.origin.x, ray.origin.y, ray.origin.z);
  vec3 direction = vec3(ray.direction.x, ray.direction.y, ray.direction.z);
  float along = componentAt(direction, depth);
  ShearedRay result;
  result.origin =
      vec4(componentAt(origin, lateral), componentAt(origin, lateral2), componentAt(origin, depth), 0.0f);
  result.shear = vec4(slDivide(componentAt(direction, lateral), along),
                      slDivide(componentAt(direction, lateral2), along), slDivide(1.0f, along), 0.0f);
  result.axes = uvec4(lateral, lateral2, depth, 0u);
  return result;
}

/// A vertex as seen from the ray: x, y sheared, z depth in world units.
SL_FUNC vec3 shearVertex(ShearedRay ray, vec3 vertex) {
  float z = componentAt(vertex, ray.axes.z) - ray.origin.z;
  float x = componentAt(vertex, ray.axes.x) - ray.origin.x;
  float y = componentAt(vertex, ray.axes.y) - ray.origin.y;
  return vec3(x - ray.shear.x * z, y - ray.shear.y * z, z);
}

/// The edge functions of three sheared vertices, and their sum, in double or, where a device has none, in two
/// floats each.
SL_STRUCT(PreciseEdges) {
#if SL_FP64
  double u;
  double v;
  double w;
  double det;
#else
  TwoFloat u;
  TwoFloat v;
  TwoFloat w;
  TwoFloat det;
#endif
};

SL_FUNC PreciseEdges preciseEdges(vec3 a, vec3 b, vec3 c) {
  PreciseEdges edges;
#if SL_FP64
  double ax = a.x;
  double ay = a.y;
  double bx = b.x;
  double by = b.y;
  double cx = c.x;
  double cy = c.y;
  edges.u = cx * by - cy * bx;
  edges.v = ax * cy - ay * cx;
  edges.w = bx * ay - by * ax;
  edges.det = edges.u + edges.v + edges.w;
#else
  edges.u = differenceOfProducts(c.x, b.y, c.y, b.x);
  edges.v = differenceOfProducts(a.x, c.y, a.y, c.x);
  edges.w = differenceOfProducts(b.x, a.y, b.y, a.x);
  edges.det = addTwoFloats(addTwoFloats(edges.u, edges.v), edges.w);
#endif
  return edges;
}

/// Depth of the hit in double; 0 where there is none.
SL_FUNC float preciseDepth(vec3 a, vec3 b, vec3 c) {
  PreciseEdges e = preciseEdges(a, b, c);
#if SL_FP64
  if (min(e.u, min(e.v, e.w)) < 0.0 && max(e.u, max(e.v, e.w)) > 0.0) {
    return 0.0f;
  }
  double az = a.z;
  double bz = b.z;
  double cz = c.z;
  return e.det == 0.0 ? 0.0f : slFloat(slDivide(e.u * az + e.v * bz + e.w * cz, e.det));
#else
  if (min(e.u.high, min(e.v.high, e.w.high)) < 0.0f && max(e.u.high, max(e.v.high, e.w.high)) > 0.0f) {
    return 0.0f;
  }
  TwoFloat sum =
      addTwoFloats(addTwoFloats(scaleTwoFloat(e.u, a.z), scaleTwoFloat(e.v, b.z)), scaleTwoFloat(e.w, c.z));
  return e.det.high == 0.0f ? 0.0f : divideTwoFloats(sum, e.det);
#endif
}

/// t of the hit, in units of the direction, in (0, inf); 0: no hit. Both sides count; a ray through an edge
/// or a vertex hits; a triangle of zero area, as seen along the ray, cannot be hit, nor one through the
/// origin (t = 0).
SL_FUNC float intersectTriangle(ShearedRay ray, vec3 v0, vec3 v1, vec3 v2) {
  vec3 a = shearVertex(ray, v0);
  vec3 b = shearVertex(ray, v1);
  vec3 c = shearVertex(ray, v2);
  float u = c.x * b.y - c.y * b.x;
  float v = a.x * c.y - a.y * c.x;
  float w = b.x * a.y - b.y * a.x;
  if (min(u, min(v, w)) < 0.0f && max(u, max(v, w)) > 0.0f) {
    return 0.0f;
  }
  float det = u + v + w;
  float reach = max(max(max(fabs(a.x), fabs(a.y)), max(fabs(b.x), fabs(b.y))), max(fabs(c.x), fabs(c.y)));
  float nearest = min(a.z, min(b.z, c.z));
  float farthest = max(a.z, max(b.z, c.z));
  float area = fabs(det);
  float trusted = area * max(fabs(nearest), fabs(farthest));
  bool rough = trusted < max(reach * reach * (farthest - nearest), kUnderflowGuard) ||
               area < kUnderflowGuard || u == 0.0f || v == 0.0f || w == 0.0f;
  float depth = rough ? preciseDepth(a, b, c) : slDivide(u * a.z + v * b.z + w * c.z, det);
  float t = depth * ray.shear.z;
  return t > 0.0f && t < uintBitsToFloat(0x7f800000u) ? t : 0.0f;
}

SL_NAMESPACE_END
#endif
