// The half spaces whose common voxels are those that a triangle meets, or those whose targets it meets
// (core/voxel/triangle_rows.h, separating_rows.h: what they are and why), in a block of 64 x 64 x 64 voxels
// or a part of it. In a device's floats, with all that rounding leaves open said to be open.
#ifndef SL_VOXEL_PLANES_H
#define SL_VOXEL_PLANES_H
#include "core/shared/voxel_half.h"
SL_NAMESPACE_BEGIN

/// Of a triangle's planes: of edges along each axis (9, or 2 where it is a segment), and its own (2).
#define SL_MOST_VOXEL_PLANES 11

/// A voxel, or a block's place.
SL_STRUCT(VoxelPlace) {
  int x;
  int y;
  int z;
};

/// From the lowest to the highest along each axis, both with their ends.
SL_STRUCT(PlaceBox) {
  VoxelPlace low;
  VoxelPlace high;
};

/// A triangle in voxels, as seen from a block.
SL_STRUCT(VoxelTriangle) {
  RealPoint a;  ///< without rounding
  RealPoint b;
  RealPoint c;
  VoxelPlace base;  ///< the lowest voxel of the part of a block that is looked at
  PlaceBox box;     ///< what of the triangle's box of voxels is in that part, from its base on
  RoundedVector normal;
  AxisSigns signs;  ///< of the normal
  SL_REAL size;     ///< what a voxel of the block and a corner are apart at most, along an axis
  bool straight;    ///< all voxels of its box meet it
  bool open;        ///< rounding leaves open what it is like: nothing else is to be trusted but the box
};

/// Half spaces, all of which hold in the triangle's voxels.
SL_STRUCT(VoxelPlanes) {
  VoxelHalf at[SL_MOST_VOXEL_PLANES];
  int source[SL_MOST_VOXEL_PLANES];  ///< what each comes from: sourceOf
  int count;
  PlaceBox box;  ///< in which the voxels are, from the block's lowest on
  bool empty;    ///< there is no such voxel, whatever the half spaces are
  bool open;     ///< rounding leaves open which half spaces there are
};

SL_FUNC bool differenceIsExact(SL_REAL a, SL_REAL b) {
  SL_REAL difference = a - b;
  SL_REAL b_part = a - difference;
  SL_REAL a_part = difference + b_part;
  return a - a_part == slReal(0) && b_part - b == slReal(0);
}

SL_FUNC bool stepIsExact(RealPoint p, RealPoint q) {
  return differenceIsExact(p.x, q.x) && differenceIsExact(p.y, q.y) && differenceIsExact(p.z, q.z);
}

/// Veltkamp's split, as twoProduct (core/shared/two_float.h).
SL_FUNC bool productIsExact(SL_REAL a, SL_REAL b) {
#if SL_REAL_IS_FLOAT
  SL_REAL splitter = slReal(4097);
#else
  SL_REAL splitter = slReal(134217729);
#endif
  SL_REAL a_shifted = a * splitter;
  SL_REAL a_high = a_shifted - (a_shifted - a);
  SL_REAL a_low = a - a_high;
  SL_REAL b_shifted = b * splitter;
  SL_REAL b_high = b_shifted - (b_shifted - b);
  SL_REAL b_low = b - b_high;
  SL_REAL product = a * b;
  return ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low == slReal(0);
}

SL_FUNC int signOfReal(SL_REAL value) {
  return value > slReal(0) ? 1 : (value < slReal(0) ? -1 : 0);
}

/// Of a product of two steps that are exact, less another: exact where the products are.
SL_FUNC int signOfProducts(int rounded, SL_REAL value, SL_REAL a, SL_REAL b, SL_REAL c, SL_REAL d) {
  if (rounded != kOpenSign) return rounded;
  return productIsExact(a, b) && productIsExact(c, d) ? signOfReal(value) : kOpenSign;
}

/// Signs of a triangle's normal. Walls that stand upright have one of zero, where bounds on rounding say
/// nothing: numbers of few bits make no rounding.
SL_FUNC AxisSigns normalSigns(RoundedVector normal, RealPoint a, RealPoint b, RealPoint c) {
  AxisSigns signs = roundedSigns(normal);
  if (signs.x != kOpenSign && signs.y != kOpenSign && signs.z != kOpenSign) return signs;
  if (!stepIsExact(b, a) || !stepIsExact(c, a)) return signs;
  RealPoint u = stepOf(b, a);
  RealPoint v = stepOf(c, a);
  signs.x = signOfProducts(signs.x, normal.value.x, u.y, v.z, u.z, v.y);
  signs.y = signOfProducts(signs.y, normal.value.y, u.z, v.x, u.x, v.z);
  signs.z = signOfProducts(signs.z, normal.value.z, u.x, v.y, u.y, v.x);
  return signs;
}

#if SL_REAL_IS_FLOAT
/// Whether a product of two such may fall below what floats hold.
SL_FUNC bool isTooFine(float x) {
  return x != 0.0f && realAbs(x) < 9.094947e-13f;  // 2^-40
}
SL_FUNC bool stepIsTooFine(RealPoint p, RealPoint q) {
  return isTooFine(p.x - q.x) || isTooFine(p.y - q.y) || isTooFine(p.z - q.z);
}
SL_FUNC bool pointIsTooFine(RealPoint p) {
  return isTooFine(p.x) || isTooFine(p.y) || isTooFine(p.z);
}
#endif

/// p - base, rounded once: also where floats do not hold the base.
SL_FUNC SL_REAL offsetOf(SL_REAL p, int base) {
  int whole = ceilingOf(p);
  return slReal(whole - base) + (p - slReal(whole));
}

SL_FUNC SL_REAL largerOf(SL_REAL a, SL_REAL b) {
  return a < b ? b : a;
}
SL_FUNC SL_REAL smallerOf(SL_REAL a, SL_REAL b) {
  return a < b ? a : b;
}

/// The lowest and the highest voxel along an axis whose closed cube meets what reaches from one number to the
/// other.
SL_FUNC int lowestVoxel(SL_REAL low) {
  return ceilingOf(low) - 1;
}
SL_FUNC int highestVoxel(SL_REAL high) {
  return -ceilingOf(-high);
}

/// In so many voxels from the base on.
SL_FUNC VoxelTriangle voxelTriangle(RealPoint a, RealPoint b, RealPoint c, VoxelPlace base, VoxelPlace size) {
  VoxelTriangle t;
  t.a = a;
  t.b = b;
  t.c = c;
  t.base = base;
  VoxelPlace low;
  low.x = lowestVoxel(smallerOf(smallerOf(a.x, b.x), c.x)) - base.x;
  low.y = lowestVoxel(smallerOf(smallerOf(a.y, b.y), c.y)) - base.y;
  low.z = lowestVoxel(smallerOf(smallerOf(a.z, b.z), c.z)) - base.z;
  VoxelPlace high;
  high.x = highestVoxel(largerOf(largerOf(a.x, b.x), c.x)) - base.x;
  high.y = highestVoxel(largerOf(largerOf(a.y, b.y), c.y)) - base.y;
  high.z = highestVoxel(largerOf(largerOf(a.z, b.z), c.z)) - base.z;
  t.straight = (high.x == low.x ? 1 : 0) + (high.y == low.y ? 1 : 0) + (high.z == low.z ? 1 : 0) >= 2;
  // The corners are in the box, and so is every voxel that is asked, or in the block.
  int farthest = max(max(max(-low.x, -low.y), max(-low.z, high.x)), max(high.y, high.z));
  farthest = max(farthest, max(max(size.x, size.y), size.z));
  t.size = slReal(farthest) + slReal(3);
  t.box.low.x = max(low.x, 0);
  t.box.low.y = max(low.y, 0);
  t.box.low.z = max(low.z, 0);
  t.box.high.x = min(high.x, size.x - 1);
  t.box.high.y = min(high.y, size.y - 1);
  t.box.high.z = min(high.z, size.z - 1);
  t.normal = triangleNormal(a, b, c);
  t.signs = normalSigns(t.normal, a, b, c);
  t.open = t.signs.x == kOpenSign || t.signs.y == kOpenSign || t.signs.z == kOpenSign;
#if SL_REAL_IS_FLOAT
  // Then nothing is told by it, not even its box: a float below 2^-126 may have become 0.
  if (stepIsTooFine(a, b) || stepIsTooFine(b, c) || stepIsTooFine(c, a) || pointIsTooFine(a) ||
      pointIsTooFine(b) || pointIsTooFine(c)) {
    t.open = true;
    t.straight = false;
  }
#endif
  return t;
}

SL_FUNC RealPoint cornerOf(VoxelTriangle t, int i) {
  if (i == 0) return t.a;
  if (i == 1) return t.b;
  return t.c;
}

SL_FUNC AxisSigns axisAlong(int axis) {
  AxisSigns d;
  d.x = axis == 0 ? 1 : 0;
  d.y = axis == 1 ? 1 : 0;
  d.z = axis == 2 ? 1 : 0;
  return d;
}

/// halves / 2 - (p - base).
SL_FUNC RealPoint fromCorner(AxisSigns halves, RealPoint p, VoxelPlace base) {
  return realPoint(slReal(halves.x) * slReal(0.5f) - offsetOf(p.x, base.x),
                   slReal(halves.y) * slReal(0.5f) - offsetOf(p.y, base.y),
                   slReal(halves.z) * slReal(0.5f) - offsetOf(p.z, base.z));
}

/// Twice the corner of voxel (0, 0, 0) that is farthest along side * signs.
SL_FUNC AxisSigns innerCorner(AxisSigns signs, int side) {
  AxisSigns halves;
  halves.x = side * signs.x > 0 ? 2 : 0;
  halves.y = side * signs.y > 0 ? 2 : 0;
  halves.z = side * signs.z > 0 ? 2 : 0;
  return halves;
}

/// The signs of an edge's gradient.
SL_FUNC AxisSigns edgeSigns(RoundedVector gradient, RealPoint p, RealPoint q) {
  AxisSigns signs = roundedSigns(gradient);
  if (signs.x != kOpenSign && signs.y != kOpenSign && signs.z != kOpenSign) return signs;
  if (!stepIsExact(p, q)) return signs;
  signs.x = signOfReal(gradient.value.x);
  signs.y = signOfReal(gradient.value.y);
  signs.z = signOfReal(gradient.value.z);
  return signs;
}

SL_FUNC int countOf(AxisSigns signs) {
  return (signs.x == 0 ? 0 : 1) + (signs.y == 0 ? 0 : 1) + (signs.z == 0 ? 0 : 1);
}

/// Of the edge from corner `edge` to the next, or of the triangle's plane (3), seen along axis `axis`, and
/// the point of a voxel that is asked: halves / 2 from its lowest corner.
SL_FUNC int sourceOf(int edge, int axis, AxisSigns halves) {
  return edge + 4 * (axis + 4 * (halves.x + 4 * (halves.y + 4 * halves.z)));
}

/// Of the voxels that the triangle meets, beside its box. Not for straight ones.
SL_FUNC VoxelPlanes meetingPlanes(VoxelTriangle t) {
  VoxelPlanes planes;
  planes.count = 0;
  planes.box = t.box;
  planes.empty = false;
  planes.open = t.open;
  for (int axis = 0; axis < 3; ++axis) {
    AxisSigns along = axisAlong(axis);
    int orientation = axis == 0 ? t.signs.x : (axis == 1 ? t.signs.y : t.signs.z);
    int longest = -1;
    if (orientation == 0) {
      SL_REAL most = slReal(-1);
      for (int edge = 0; edge < 3; ++edge) {
        RoundedVector g = edgeGradient(cornerOf(t, edge), cornerOf(t, edge == 2 ? 0 : edge + 1), along);
        SL_REAL size = (g.magnitude.x + g.magnitude.y) + g.magnitude.z;
        if (size > most) {
          most = size;
          longest = edge;
        }
      }
    }
    for (int edge = 0; edge < 3; ++edge) {
      if (longest >= 0 && edge == 2) break;
      int from = longest >= 0 ? longest : edge;
      int side = longest >= 0 ? (edge == 0 ? 1 : -1) : orientation;
      RealPoint p = cornerOf(t, from);
      RoundedVector g = edgeGradient(p, cornerOf(t, from == 2 ? 0 : from + 1), along);
      AxisSigns signs = roundedSigns(g);  // one step each: never open
      if (countOf(signs) < 2) continue;   // along an axis: the box says the same
      AxisSigns halves = innerCorner(signs, side);
      planes.source[planes.count] = sourceOf(from, axis, halves);
      planes.at[planes.count] = voxelHalf(g, signs, side, fromCorner(halves, p, t.base), t.size);
      planes.count = planes.count + 1;
    }
  }
  if (countOf(t.signs) < 2) return planes;  // none, or the box says the same
  for (int side = -1; side <= 1; side += 2) {
    AxisSigns halves = innerCorner(t.signs, side);
    planes.source[planes.count] = sourceOf(3, 0, halves);
    planes.at[planes.count] = voxelHalf(t.normal, t.signs, side, fromCorner(halves, t.a, t.base), t.size);
    planes.count = planes.count + 1;
  }
  return planes;
}

SL_FUNC bool sumIsExact(SL_REAL a, SL_REAL b) {
  return differenceIsExact(a, -b);
}

/// Of the normal along a target's direction, or kOpenSign.
SL_FUNC int signAlong(VoxelTriangle t, AxisSigns d) {
  int x = t.signs.x * d.x;
  int y = t.signs.y * d.y;
  int z = t.signs.z * d.z;
  if (x >= 0 && y >= 0 && z >= 0) return x + y + z > 0 ? 1 : 0;
  if (x <= 0 && y <= 0 && z <= 0) return -1;
  int sign = roundedSignAlong(t.normal, d);
  if (sign != kOpenSign) return sign;
  RealPoint u = stepOf(t.b, t.a);
  RealPoint v = stepOf(t.c, t.a);
  bool exact = stepIsExact(t.b, t.a) && stepIsExact(t.c, t.a);
  exact = exact && productIsExact(u.y, v.z) && productIsExact(u.z, v.y) && productIsExact(u.z, v.x) &&
          productIsExact(u.x, v.z) && productIsExact(u.x, v.y) && productIsExact(u.y, v.x);
  exact = exact && differenceIsExact(u.y * v.z, u.z * v.y) && differenceIsExact(u.z * v.x, u.x * v.z) &&
          differenceIsExact(u.x * v.y, u.y * v.x);
  SL_REAL along_x = t.normal.value.x * slReal(d.x);
  SL_REAL along_y = t.normal.value.y * slReal(d.y);
  SL_REAL along_z = t.normal.value.z * slReal(d.z);
  if (!exact || !sumIsExact(along_x, along_y)) return kOpenSign;
  return signOfReal((along_x + along_y) + along_z);
}

/// The lowest whole number v with v + halves / 2 >= p; halves: 0, 1 or 2. Exact.
SL_FUNC int lowestFrom(SL_REAL p, int halves) {
  int whole = ceilingOf(p);
  if (halves == 0) return whole;
  if (halves == 2) return whole - 1;
  // From 2^23 on floats are whole numbers.
  if (realAbs(p) >= slReal(8388608))
    return SL_REAL_IS_FLOAT == 1 || p > slReal(whole) - slReal(0.5f) ? whole : whole - 1;
  return p <= slReal(whole) - slReal(0.5f) ? whole - 1 : whole;
}

/// What a half space says that only one coordinate decides: v + halves / 2 - p is not below zero, ties
/// included, if it rises; else it is below zero, without ties. That is what shifted targets make of ties.
SL_FUNC PlaceBox cutBox(PlaceBox box, AxisSigns rises, RealPoint p, AxisSigns halves, VoxelPlace base) {
  if (rises.x != 0) {
    int from = lowestFrom(p.x, halves.x) - base.x;
    if (rises.x > 0) box.low.x = max(box.low.x, from);
    if (rises.x < 0) box.high.x = min(box.high.x, from - 1);
  }
  if (rises.y != 0) {
    int from = lowestFrom(p.y, halves.y) - base.y;
    if (rises.y > 0) box.low.y = max(box.low.y, from);
    if (rises.y < 0) box.high.y = min(box.high.y, from - 1);
  }
  if (rises.z != 0) {
    int from = lowestFrom(p.z, halves.z) - base.z;
    if (rises.z > 0) box.low.z = max(box.low.z, from);
    if (rises.z < 0) box.high.z = min(box.high.z, from - 1);
  }
  return box;
}

/// The planes and a half space more: side * (gradient . (v + halves / 2 - p)) > 0.
SL_FUNC VoxelPlanes withHalf(VoxelPlanes planes, VoxelTriangle t, int edge, RoundedVector gradient,
                             AxisSigns signs, int side, AxisSigns halves) {
  RealPoint p = cornerOf(t, edge == 3 ? 0 : edge);
  if (countOf(signs) == 1) {
    AxisSigns rises;
    rises.x = side * signs.x;
    rises.y = side * signs.y;
    rises.z = side * signs.z;
    planes.box = cutBox(planes.box, rises, p, halves, t.base);
    return planes;
  }
  planes.source[planes.count] = sourceOf(edge, 0, halves);
  planes.at[planes.count] = voxelHalf(gradient, signs, side, fromCorner(halves, p, t.base), t.size);
  planes.count = planes.count + 1;
  return planes;
}

/// Of the voxels whose targets along `along` the triangle meets.
SL_FUNC VoxelPlanes targetPlanes(VoxelTriangle t, AxisSigns along) {
  VoxelPlanes planes;
  planes.count = 0;
  planes.box = t.box;
  planes.open = t.open;
  int side = t.open ? kOpenSign : signAlong(t, along);
  planes.empty = side == 0;
  planes.open = side == kOpenSign;
  if (planes.empty || planes.open) return planes;
  AxisSigns halves;
  halves.x = 1;
  halves.y = 1;
  halves.z = 1;
  for (int edge = 0; edge < 3; ++edge) {
    RealPoint p = cornerOf(t, edge);
    RealPoint q = cornerOf(t, edge == 2 ? 0 : edge + 1);
    RoundedVector g = edgeGradient(p, q, along);
    AxisSigns signs = edgeSigns(g, p, q);
    if (signs.x == kOpenSign || signs.y == kOpenSign || signs.z == kOpenSign) planes.open = true;
    planes = withHalf(planes, t, edge, g, signs, side, halves);
  }
  for (int end = -1; end <= 1; end += 2) {
    halves.x = 1 + end * along.x;
    halves.y = 1 + end * along.y;
    halves.z = 1 + end * along.z;
    planes = withHalf(planes, t, 3, t.normal, t.signs, end * side, halves);
  }
  return planes;
}

/// The part of a row's run that is in a half space. inverse: of factor.x, as inverseOf. open: also what was
/// open before.
SL_FUNC VoxelRun narrowRow(VoxelRun row, VoxelHalf h, SL_REAL inverse, int y, int z) {
  SL_REAL value = (h.rest + h.factor.z * slReal(z)) + h.factor.y * slReal(y);
  bool was_open = row.open;
  if (h.rises.x != 0) {
    row = narrowRun(row, value, inverse, h.tolerance, h.rises.x);
    row.open = row.open || was_open;
  } else if (value < -h.tolerance) {
    row.high = row.low - 1;
  } else if (!(value > h.tolerance)) {
    row.open = true;
  }
  return row;
}

/// x + halves / 2 - p, as seen from a base, and whether that is without rounding.
SL_STRUCT(ExactReal) {
  SL_REAL value;
  bool exact;
};

SL_FUNC ExactReal exactStep(int x, int halves, SL_REAL p, int base) {
  int whole = ceilingOf(p);
  SL_REAL rest = p - slReal(whole);
  SL_REAL place = slReal(base + x - whole) + slReal(halves) * slReal(0.5f);
  ExactReal step;
  step.value = place - rest;
  step.exact = differenceIsExact(p, slReal(whole)) && differenceIsExact(place, rest);
  return step;
}

/// The sign of a half space's value at a voxel, by arithmetic that happens not to round, as it does not for
/// numbers of few bits; or kOpenSign. along: where targets are sampled; of meetingPlanes any.
SL_FUNC int exactSignAt(VoxelTriangle t, int source, bool on_axes, AxisSigns along, AxisSigns rises, int x,
                        int y, int z) {
  int edge = source & 3;
  if (on_axes) along = axisAlong((source >> 2) & 3);
  RealPoint p = cornerOf(t, edge == 3 ? 0 : edge);
  RoundedVector g = t.normal;
  bool exact = true;
  if (edge == 3) {
    RealPoint u = stepOf(t.b, t.a);
    RealPoint v = stepOf(t.c, t.a);
    exact = stepIsExact(t.b, t.a) && stepIsExact(t.c, t.a);
    exact = exact && productIsExact(u.y, v.z) && productIsExact(u.z, v.y) && productIsExact(u.z, v.x) &&
            productIsExact(u.x, v.z) && productIsExact(u.x, v.y) && productIsExact(u.y, v.x);
    exact = exact && differenceIsExact(u.y * v.z, u.z * v.y) && differenceIsExact(u.z * v.x, u.x * v.z) &&
            differenceIsExact(u.x * v.y, u.y * v.x);
  } else {
    RealPoint q = cornerOf(t, edge == 2 ? 0 : edge + 1);
    g = edgeGradient(p, q, along);
    RealPoint s = stepOf(p, q);
    exact = stepIsExact(p, q);
    exact = exact && differenceIsExact(s.y * slReal(along.z), s.z * slReal(along.y)) &&
            differenceIsExact(s.z * slReal(along.x), s.x * slReal(along.z)) &&
            differenceIsExact(s.x * slReal(along.y), s.y * slReal(along.x));
  }
  ExactReal step_x = exactStep(x, (source >> 4) & 3, p.x, t.base.x);
  ExactReal step_y = exactStep(y, (source >> 6) & 3, p.y, t.base.y);
  ExactReal step_z = exactStep(z, (source >> 8) & 3, p.z, t.base.z);
  exact = exact && (g.value.x == slReal(0) || (step_x.exact && productIsExact(g.value.x, step_x.value)));
  exact = exact && (g.value.y == slReal(0) || (step_y.exact && productIsExact(g.value.y, step_y.value)));
  exact = exact && (g.value.z == slReal(0) || (step_z.exact && productIsExact(g.value.z, step_z.value)));
  SL_REAL a = g.value.x * step_x.value;
  SL_REAL b = g.value.y * step_y.value;
  SL_REAL c = g.value.z * step_z.value;
  // The sign of a rounded sum of two numbers is that of their sum.
  if (!exact || (!sumIsExact(a, b) && c != slReal(0))) return kOpenSign;
  int side = rises.x != 0   ? rises.x * signOfReal(g.value.x)
             : rises.y != 0 ? rises.y * signOfReal(g.value.y)
                            : rises.z * signOfReal(g.value.z);
  return side * signOfReal((a + b) + c);
}

/// What a row's run is in a half space that narrowRow left open. closed: ties hold; else those of shifted
/// targets.
SL_FUNC VoxelRun decideRow(VoxelRun row, VoxelTriangle t, VoxelHalf h, int source, bool closed,
                           AxisSigns along, SL_REAL inverse, int y, int z) {
  int at = 0;
  if (h.rises.x != 0) {
    SL_REAL value = (h.rest + h.factor.z * slReal(z)) + h.factor.y * slReal(y);
    SL_REAL end = -value * inverse;
    // Then one voxel at most is not told by rounded numbers.
    if (!(h.tolerance * realAbs(inverse) < slReal(0.125f)) || !(realAbs(end) < slReal(1000000))) return row;
    at = ceilingOf(end - slReal(0.5f));
  }
  int sign = exactSignAt(t, source, closed, along, h.rises, at, y, z);
  if (sign == kOpenSign) return row;
  if (sign == 0 && closed) sign = 1;
  if (sign == 0) sign = h.rises.x != 0 ? h.rises.x : (h.rises.y != 0 ? h.rises.y : h.rises.z);
  row.open = false;
  if (h.rises.x > 0) {
    row.low = max(row.low, sign > 0 ? at : at + 1);
  } else if (h.rises.x < 0) {
    row.high = min(row.high, sign > 0 ? at : at - 1);
  } else if (sign < 0) {
    row.high = row.low - 1;
  }
  return row;
}

SL_NAMESPACE_END
#endif
