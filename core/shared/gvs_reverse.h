// The original reverse sampling: two rays past an occluder, each from a mutated origin on the view cell
// (thesis 4.2.2, figure 4.3; Wonka et al. 2006).
//
//        x_target                 The plane through x_origin, x_t (where the entry's ray meets its triangle
//        t) /  :  \                  and x_target cuts the occluder in a segment. Two points lie on the line
//        of
//      /    :    \                the segment just beyond its ends; the lines from x_target through them meet
//    x --occluder-- y             the view cell in the mutated origins. What leaves the cell is rejected.
//   /       :        \            .
// -m1----x_origin-----m2- cell
//
// Where the thesis is silent: "just beyond" is the border distance of border.h (the thesis's program: 0.01
// world units). Of a box's faces, the line enters the cell through the one that looks at x_target and holds
// the meeting point (the lowest face on an edge); there the ray to x_target leaves the cell.
#ifndef SL_GVS_REVERSE_H
#define SL_GVS_REVERSE_H
#include "core/shared/gvs_border.h"
#include "core/shared/reverse.h"
SL_NAMESPACE_BEGIN

/// Where the line from a to c crosses the plane; side_a, side_c: their signed distances from it.
SL_FUNC vec3 crossesPlane(vec3 a, vec3 c, float side_a, float side_c) {
  return add3(a, scale3(sub3(c, a), slDivide(side_a, side_a - side_c)));
}

/// Makes of a discontinuity with its occluder (corners a, b, c) the one of the original method: a and b
/// become the points beside the occluder, and number.w = 0 where there are none. found: the ray of the entry
/// whose triangle is p0 p1 p2.
SL_FUNC ReverseItem gvsReverseItem(ReverseItem item, Ray found, vec3 p0, vec3 p1, vec3 p2,
                                   StageParams params) {
  vec3 origin = xyz3(found.origin);
  float t = meetsPlane(found, p0, p1, p2);
  vec3 x_t = add3(origin, scale3(xyz3(found.direction), t));
  vec3 normal = cross3(sub3(x_t, origin), sub3(xyz3(item.target), x_t));
  float side_a = dot3(normal, sub3(xyz3(item.a), origin));
  float side_b = dot3(normal, sub3(xyz3(item.b), origin));
  float side_c = dot3(normal, sub3(xyz3(item.c), origin));
  bool a_above = side_a > 0.0f;
  bool b_above = side_b > 0.0f;
  bool c_above = side_c > 0.0f;
  // The corner that is alone on its side of the plane; from it the segment's ends lie towards the others.
  vec4 lone = item.c;
  vec4 other0 = item.a;
  vec4 other1 = item.b;
  float side_lone = side_c;
  float side0 = side_a;
  float side1 = side_b;
  if (a_above != b_above && a_above != c_above) {
    lone = item.a;
    other0 = item.b;
    other1 = item.c;
    side_lone = side_a;
    side0 = side_b;
    side1 = side_c;
  } else if (b_above != a_above && b_above != c_above) {
    lone = item.b;
    other0 = item.a;
    other1 = item.c;
    side_lone = side_b;
    side0 = side_a;
    side1 = side_c;
  }
  bool cut = t > 0.0f && item.number.w != 0u && (side_lone > 0.0f) != (side0 > 0.0f);
  vec3 end0 = crossesPlane(xyz3(other0), xyz3(lone), side0, side_lone);
  vec3 end1 = crossesPlane(xyz3(other1), xyz3(lone), side1, side_lone);
  vec3 along = normalize3(sub3(end0, end1));
  cut = cut && dot3(along, along) > 0.0f;
  end0 = add3(end0, scale3(along, borderDistance(end0, origin, params)));
  end1 = add3(end1, scale3(along, -borderDistance(end1, origin, params)));
  item.a = vec4(end0.x, end0.y, end0.z, 0.0f);
  item.b = vec4(end1.x, end1.y, end1.z, 0.0f);
  item.c = vec4(0.0f, 0.0f, 0.0f, 0.0f);
  item.number.w = cut ? 1u : 0u;
  return item;
}

/// Reverse ray k, 0 or 1, of an item of gvsReverseItem, if its origin lies on the face and the cell looks
/// along it; else none.
SL_FUNC Ray gvsReverseRay(ReverseItem item, Face face, uint k, StageParams params) {
  vec3 target = xyz3(item.target);
  if (item.number.w == 0u || !faceLooksAt(face, target)) return noRay();
  vec3 line = sub3(k == 0u ? xyz3(item.a) : xyz3(item.b), target);
  float speed = dot3(line, xyz3(face.normal));
  if (!(speed < 0.0f)) return noRay();
  float t = slDivide(dot3(sub3(xyz3(face.corner), target), xyz3(face.normal)), speed);
  vec3 met = sub3(add3(target, scale3(line, t)), xyz3(face.corner));
  float u = dot3(met, xyz3(face.axis_u));
  float v = dot3(met, xyz3(face.axis_v));
  bool inside = u >= 0.0f && u <= dot3(xyz3(face.edge_u), xyz3(face.axis_u)) && v >= 0.0f &&
                v <= dot3(xyz3(face.edge_v), xyz3(face.axis_v));
  if (!inside) return noRay();
  vec3 along_u = scale3(xyz3(face.axis_u), u);
  vec3 along_v = scale3(xyz3(face.axis_v), v);
  return whereCellLooks(rayTo(add3(add3(xyz3(face.corner), along_u), along_v), target), params);
}

SL_NAMESPACE_END
#endif
