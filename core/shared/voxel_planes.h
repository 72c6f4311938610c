// The half spaces whose common voxels are those that a triangle meets, or those whose targets it meets
// (core/voxel/triangle_rows.h, separating_rows.h: what they are and why), in a block of 64 x 64 x 64 voxels.
// In a device's floats, with all that rounding leaves open said to be open.
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

/// A triangle in voxels, as seen from a block.
SL_STRUCT(VoxelTriangle) {
  RealPoint a;  ///< without rounding
  RealPoint b;
  RealPoint c;
  VoxelPlace base;  ///< the block's lowest voxel
  VoxelPlace low;   ///< what of the triangle's box of voxels is in the block, from its base on
  VoxelPlace high;
  RoundedVector normal;
  AxisSigns signs;  ///< of the normal
  SL_REAL size;     ///< what a voxel of the block and a corner are apart at most, along an axis
  bool straight;    ///< all voxels of its box meet it
  bool open;        ///< rounding leaves open what it is like: nothing else is to be trusted but the box
};

SL_STRUCT(VoxelPlanes) {
  VoxelHalf at[SL_MOST_VOXEL_PLANES];
  int count;
  bool empty;  ///< there is no such voxel, whatever the half spaces are
  bool open;   ///< rounding leaves open which half spaces there are
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

SL_FUNC VoxelTriangle voxelTriangle(RealPoint a, RealPoint b, RealPoint c, VoxelPlace base) {
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
  int farthest = max(max(max(-low.x, -low.y), max(-low.z, high.x)), max(max(high.y, high.z), 64));
  t.size = slReal(farthest) + slReal(67);
  t.low.x = max(low.x, 0);
  t.low.y = max(low.y, 0);
  t.low.z = max(low.z, 0);
  t.high.x = min(high.x, 63);
  t.high.y = min(high.y, 63);
  t.high.z = min(high.z, 63);
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

/// target - (p - base).
SL_FUNC RealPoint fromCorner(RealPoint target, RealPoint p, VoxelPlace base) {
  return realPoint(target.x - offsetOf(p.x, base.x), target.y - offsetOf(p.y, base.y),
                   target.z - offsetOf(p.z, base.z));
}

/// The corner of voxel (0, 0, 0) that is farthest along side * signs.
SL_FUNC RealPoint innerCorner(AxisSigns signs, int side) {
  return realPoint(slReal(side * signs.x > 0 ? 1 : 0), slReal(side * signs.y > 0 ? 1 : 0),
                   slReal(side * signs.z > 0 ? 1 : 0));
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

/// Of the voxels that the triangle meets, beside its box. Not for straight ones.
SL_FUNC VoxelPlanes meetingPlanes(VoxelTriangle t) {
  VoxelPlanes planes;
  planes.count = 0;
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
      int steps = (signs.x == 0 ? 0 : 1) + (signs.y == 0 ? 0 : 1) + (signs.z == 0 ? 0 : 1);
      if (steps < 2) continue;  // along an axis: the box says the same
      planes.at[planes.count] =
          voxelHalf(g, signs, side, fromCorner(innerCorner(signs, side), p, t.base), t.size);
      planes.count = planes.count + 1;
    }
  }
  int steps = (t.signs.x == 0 ? 0 : 1) + (t.signs.y == 0 ? 0 : 1) + (t.signs.z == 0 ? 0 : 1);
  if (steps < 2) return planes;  // none, or the box says the same
  for (int side = -1; side <= 1; side += 2) {
    planes.at[planes.count] =
        voxelHalf(t.normal, t.signs, side, fromCorner(innerCorner(t.signs, side), t.a, t.base), t.size);
    planes.count = planes.count + 1;
  }
  return planes;
}

/// Of the voxels whose targets along `along` the triangle meets.
SL_FUNC VoxelPlanes targetPlanes(VoxelTriangle t, AxisSigns along) {
  VoxelPlanes planes;
  planes.count = 0;
  planes.open = t.open;
  int side = roundedSignAlong(t.normal, along);
  planes.empty = side == 0;
  if (side == kOpenSign) planes.open = true;
  if (planes.empty || planes.open) return planes;
  for (int edge = 0; edge < 3; ++edge) {
    RealPoint p = cornerOf(t, edge);
    RealPoint q = cornerOf(t, edge == 2 ? 0 : edge + 1);
    RoundedVector g = edgeGradient(p, q, along);
    AxisSigns signs = edgeSigns(g, p, q);
    if (signs.x == kOpenSign || signs.y == kOpenSign || signs.z == kOpenSign) planes.open = true;
    RealPoint middle = realPoint(slReal(0.5f), slReal(0.5f), slReal(0.5f));
    planes.at[edge] = voxelHalf(g, signs, side, fromCorner(middle, p, t.base), t.size);
  }
  for (int end = -1; end <= 1; end += 2) {
    RealPoint target =
        realPoint(slReal(1 + end * along.x) * slReal(0.5f), slReal(1 + end * along.y) * slReal(0.5f),
                  slReal(1 + end * along.z) * slReal(0.5f));
    planes.at[end < 0 ? 3 : 4] =
        voxelHalf(t.normal, t.signs, end * side, fromCorner(target, t.a, t.base), t.size);
  }
  planes.count = 5;
  return planes;
}

/// A row's voxels, from the block's lowest on: none where low > high.
SL_FUNC VoxelRun rowOf(VoxelPlanes planes, VoxelTriangle t, int y, int z) {
  VoxelRun run;
  run.low = t.low.x;
  run.high = t.high.x;
  bool open = false;
  for (int i = 0; i < planes.count && run.low <= run.high; ++i) {
    VoxelHalf h = planes.at[i];
    SL_REAL value = (h.rest + h.factor.z * slReal(z)) + h.factor.y * slReal(y);
    if (h.rises.x != 0) {
      run = narrowRun(run, value, inverseOf(h.factor.x, h.rises.x), h.tolerance, h.rises.x);
      open = open || run.open;
    } else if (value < -h.tolerance) {
      run.high = run.low - 1;
    } else if (!(value > h.tolerance)) {
      open = true;
    }
  }
  run.open = open && run.low <= run.high;
  return run;
}

SL_NAMESPACE_END
#endif
