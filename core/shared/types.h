// Values that travel between host and device. Structs in buffers consist of vec4/uvec4 only, so that their
// layout is the same in C++, OpenCL C and GLSL (sizes are checked in the tests of all three).
#ifndef SL_TYPES_H
#define SL_TYPES_H
#include "core/shared/language.h"
SL_NAMESPACE_BEGIN

/// No triangle: the id of a miss.
SL_CONST uint kNoTriangle = 0xffffffffu;

/// Stage that a ray belongs to; kept with a witness.
SL_CONST uint kStageRandom = 0u;
SL_CONST uint kStageBorder = 1u;
SL_CONST uint kStageReverse = 2u;
/// Not found by a ray: the triangle meets the view cell itself.
SL_CONST uint kStageContained = 3u;

/// A ray: points origin + t * direction for t in (0, inf). The direction is not normalised; t counts in
/// units of it. A direction of zero marks a lane without a ray: it hits nothing and is not counted.
SL_STRUCT(Ray) {
  vec4 origin;     ///< xyz; w = 0
  vec4 direction;  ///< xyz; w = 0
};

/// Nearest hit: smallest t, among equal t the lowest triangle id, whatever the tree and the order.
SL_STRUCT(Hit) {
  float t;        ///< in units of the ray's direction; meaningless where triangle == kNoTriangle
  uint triangle;  ///< id in file order, or kNoTriangle
};

/// The corners of a triangle.
SL_STRUCT(Corners) {
  vec3 a;
  vec3 b;
  vec3 c;
};

/// One rectangle of a view cell's surface: points corner + u * edge_u + v * edge_v, u and v in [0, 1].
///
///        v
///        ^   +-----------+
///  axis_v|   |           |      normal = axis_u x axis_v points out of the cell, to the viewer of
///        |   |           |      this page; rays leave on that side only.
///     corner +-----------+
///            ---> axis_u, u
SL_STRUCT(Face) {
  vec4 corner;
  vec4 edge_u;
  vec4 edge_v;
  vec4 axis_u;  ///< unit vector along edge_u
  vec4 axis_v;  ///< unit vector along edge_v
  vec4 normal;  ///< unit vector out of the cell
};

/// A triangle of the PVS with the ray that found it (its witness), in the order of discovery. The queue of
/// the exploration and the PVS are this one list.
SL_STRUCT(PvsEntry) {
  uvec4 origin_triangle;  ///< xyz: bits of the ray's origin, w: triangle id
  uvec4 direction_stage;  ///< xyz: bits of the ray's direction, w: kStage...
};

SL_NAMESPACE_END
#endif
