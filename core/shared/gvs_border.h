// The original adaptive border sampling: rays to the nine vertices of the border polygon, and between two
// neighbouring samples that hit different triangles, up to three times.
//
// Based on: Wonka, Wimmer, Zhou, Maierhofer, Hesina, Reshetov, Guided Visibility Sampling, 2006;
// thesis 4.2.2.
//
// Positions on the polygon are eighths of its nine edges, 0 .. 71; vertex v of border.h is at 8 v. A sample
// of level 1, 2 or 3 lies in the middle between two positions of lower levels and is traced only if both of
// them were, and hit different triangles (nothing counts as a triangle of its own):
//
//   vertex 0               vertex 1
//   0   1   2   3   4   5   6   7   8   position
//   0   3   2   3   1   3   2   3   0   level
//
// So each level is one launch of independent rays that looks up what the levels before it hit.
#ifndef SL_GVS_BORDER_H
#define SL_GVS_BORDER_H
#include "core/shared/border.h"
SL_NAMESPACE_BEGIN

SL_CONST uint kGvsLevels = 4u;
/// In place of the triangle of a position whose ray was not traced.
SL_CONST uint kNotTraced = 0xfffffffeu;

/// Positions of the level: 9, 9, 18 or 36.
SL_FUNC uint gvsSlots(uint level) {
  return level == 0u ? 9u : 9u << (level - 1u);
}

/// The position of slot 0 .. gvsSlots(level) - 1 of the level.
SL_FUNC uint gvsPosition(uint level, uint slot) {
  return level == 0u ? slot * 8u : slot * (16u >> level) + (8u >> level);
}

/// The positions on either side of a position of level 1, 2 or 3, between which it lies in the middle.
SL_FUNC uint gvsBefore(uint level, uint position) {
  return position - (8u >> level);
}
SL_FUNC uint gvsAfter(uint level, uint position) {
  return (position + (8u >> level)) % kGvsPositions;
}

/// Whether the middle between two positions is traced; before, after: what they hit, or kNotTraced.
SL_FUNC bool gvsDivides(uint before, uint after) {
  return before != after && before != kNotTraced && after != kNotTraced;
}

/// Vertex 0 .. 8 of the border polygon, of its side vertex / 3.
SL_FUNC vec3 gvsVertexOf(BorderEdge edge, uint vertex) {
  uint place = vertex % 3u;
  return xyz3(place == 0u ? edge.bisector : (place == 1u ? edge.start : edge.end));
}

/// The vertex at or before a position, and the one after it.
SL_FUNC uint gvsFirstVertex(uint position) {
  return position / 8u;
}
SL_FUNC uint gvsSecondVertex(uint position) {
  return (position / 8u + 1u) % 9u;
}

/// The place of a position between its vertices.
SL_FUNC vec3 gvsPoint(vec3 first, vec3 second, uint position) {
  uint eighths = position % 8u;
  float t = slFloat(eighths) * 0.125f;
  return eighths == 0u ? first : add3(scale3(first, 1.0f - t), scale3(second, t));
}

/// Ray k to a border polygon of the original method. first, second: the vertices of gvsFirstVertex and
/// gvsSecondVertex. Without direction where the cell does not look.
SL_FUNC Ray gvsBorderRay(vec3 first, vec3 second, uint k, vec3 origin, StageParams params) {
  return whereCellLooks(rayTo(origin, gvsPoint(first, second, k)), params);
}

/// Ray k to the border polygon of triangle p0 p1 p2, by the method of the parameters. samples: borderSamples.
SL_FUNC Ray polygonRay(vec3 p0, vec3 p1, vec3 p2, uint k, uint samples, vec3 origin, StageParams params) {
  if (!isGvs(params)) {
    return borderRay(borderEdge(p0, p1, p2, borderSide(k, samples), origin, params), k, origin, params);
  }
  uint first = gvsFirstVertex(k);
  uint second = gvsSecondVertex(k);
  BorderEdge from = borderEdge(p0, p1, p2, first / 3u, origin, params);
  BorderEdge to = borderEdge(p0, p1, p2, second / 3u, origin, params);
  return gvsBorderRay(gvsVertexOf(from, first), gvsVertexOf(to, second), k, origin, params);
}

/// Where the ray meets the plane of triangle p0 p1 p2, in units of its direction; 0 where it runs beside it.
SL_FUNC float meetsPlane(Ray ray, vec3 p0, vec3 p1, vec3 p2) {
  vec3 normal = cross3(sub3(p1, p0), sub3(p2, p0));
  float speed = dot3(normal, xyz3(ray.direction));
  return speed == 0.0f ? 0.0f : slDivide(dot3(normal, sub3(p0, xyz3(ray.origin))), speed);
}

/// Whether a border ray of triangle p0 p1 p2 meets a discontinuity: something nearer than the triangle's
/// plane by more than delta_RS. A ray that hits nothing meets none: what is farther is found from the farther
/// side.
SL_FUNC bool isGvsDiscontinuity(Ray ray, Hit hit, vec3 p0, vec3 p1, vec3 p2, StageParams params) {
  if (hit.triangle == kNoTriangle || !hasDirection(ray)) return false;
  float predicted = meetsPlane(ray, p0, p1, p2);
  float unit = length3(xyz3(ray.direction));
  return predicted > 0.0f &&
         (predicted - hit.t) * unit > params.distances.z * (predicted * unit) + params.distances.w;
}

SL_NAMESPACE_END
#endif
