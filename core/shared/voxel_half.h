// Half spaces of voxels: where a row of voxels enters or leaves one, by arithmetic with a bound on its error.
// What the bound leaves open is said to be open, for exact arithmetic to decide (core/voxel/exact_sign.h). So
// a device may decide with whatever floats it has, and no bit depends on which.
#ifndef SL_VOXEL_HALF_H
#define SL_VOXEL_HALF_H
#include "core/shared/language.h"

// The device's floats. SL_VOXEL_FLOATS: single precision although there is double (for tests).
#if defined(__OPENCL_VERSION__) && (!SL_FP64 || defined(SL_VOXEL_FLOATS))
#define SL_REAL float
#define SL_REAL_IS_FLOAT 1
#define SL_REAL_UNIT 5.9604644775390625e-8f
#else
#define SL_REAL double
#define SL_REAL_IS_FLOAT 0
#define SL_REAL_UNIT (slReal(5.9604644775390625e-8f) * slReal(1.862645149230957e-9f))
#endif
#if defined(__OPENCL_VERSION__)
#define slReal(x) ((SL_REAL)(x))
#elif defined(__cplusplus)
#define slReal(x) (static_cast<double>(x))
#else
#define slReal(x) double(x)
#endif

SL_NAMESPACE_BEGIN

/// A sign that rounding leaves open.
SL_CONST int kOpenSign = 2;

/// A point in voxels, or a vector.
SL_STRUCT(RealPoint) {
  SL_REAL x;
  SL_REAL y;
  SL_REAL z;
};

/// Signs, or steps, along each axis.
SL_STRUCT(AxisSigns) {
  int x;
  int y;
  int z;
};

/// A vector of sums, and the sums of the magnitudes of what is added: `value` is off by at most 8 units of
/// rounding of those, and exactly zero where they are zero.
SL_STRUCT(RoundedVector) {
  RealPoint value;
  RealPoint magnitude;
};

/// Those voxels v (relative to a base) with factor . v + rest > 0, or >= 0: the caller knows. In numbers that
/// are off by `tolerance` at most together.
SL_STRUCT(VoxelHalf) {
  RealPoint factor;  ///< exactly zero where `rises` is
  SL_REAL rest;
  SL_REAL tolerance;
  AxisSigns rises;  ///< signs of factor without rounding
};

/// Voxels of a row from low to high, both with their ends.
SL_STRUCT(VoxelRun) {
  int low;
  int high;
  bool open;  ///< rounding leaves more than one answer: low and high are as they were
};

SL_FUNC RealPoint realPoint(SL_REAL x, SL_REAL y, SL_REAL z) {
  RealPoint p;
  p.x = x;
  p.y = y;
  p.z = z;
  return p;
}

SL_FUNC SL_REAL realAbs(SL_REAL x) {
  return x < slReal(0) ? -x : x;
}

/// p - q.
SL_FUNC RealPoint stepOf(RealPoint p, RealPoint q) {
  return realPoint(p.x - q.x, p.y - q.y, p.z - q.z);
}

/// How d . ((p - r) x (q - r)), on which side of the edge p q the point r lies as seen along d, grows with r:
/// (p - q) x d. d's components are -1, 0 or 1, its lines are what voxels are sampled by.
SL_FUNC RoundedVector edgeGradient(RealPoint p, RealPoint q, AxisSigns d) {
  RealPoint s = stepOf(p, q);
  RoundedVector g;
  SL_REAL x = slReal(d.x);
  SL_REAL y = slReal(d.y);
  SL_REAL z = slReal(d.z);
  g.value = realPoint(s.y * z - s.z * y, s.z * x - s.x * z, s.x * y - s.y * x);
  SL_REAL sx = realAbs(s.x);
  SL_REAL sy = realAbs(s.y);
  SL_REAL sz = realAbs(s.z);
  x = realAbs(x);
  y = realAbs(y);
  z = realAbs(z);
  g.magnitude = realPoint(sy * z + sz * y, sz * x + sx * z, sx * y + sy * x);
  return g;
}

/// (b - a) x (c - a).
SL_FUNC RoundedVector triangleNormal(RealPoint a, RealPoint b, RealPoint c) {
  RealPoint u = stepOf(b, a);
  RealPoint v = stepOf(c, a);
  RealPoint plus = realPoint(u.y * v.z, u.z * v.x, u.x * v.y);
  RealPoint minus = realPoint(u.z * v.y, u.x * v.z, u.y * v.x);
  RoundedVector n;
  n.value = stepOf(plus, minus);
  n.magnitude = realPoint(realAbs(plus.x) + realAbs(minus.x), realAbs(plus.y) + realAbs(minus.y),
                          realAbs(plus.z) + realAbs(minus.z));
  return n;
}

/// The sign of a sum of a RoundedVector, or kOpenSign.
SL_FUNC int roundedSign(SL_REAL value, SL_REAL magnitude) {
  if (realAbs(value) > slReal(16) * SL_REAL_UNIT * magnitude) return value > slReal(0) ? 1 : -1;
  return magnitude == slReal(0) ? 0 : kOpenSign;
}

SL_FUNC AxisSigns roundedSigns(RoundedVector v) {
  AxisSigns signs;
  signs.x = roundedSign(v.value.x, v.magnitude.x);
  signs.y = roundedSign(v.value.y, v.magnitude.y);
  signs.z = roundedSign(v.value.z, v.magnitude.z);
  return signs;
}

/// The sign of v . d, or kOpenSign.
SL_FUNC int roundedSignAlong(RoundedVector v, AxisSigns d) {
  SL_REAL x = slReal(d.x);
  SL_REAL y = slReal(d.y);
  SL_REAL z = slReal(d.z);
  return roundedSign((v.value.x * x + v.value.y * y) + v.value.z * z,
                     (v.magnitude.x * realAbs(x) + v.magnitude.y * realAbs(y)) + v.magnitude.z * realAbs(z));
}

/// The half space where side * (gradient . (v + from)) is not negative, for voxels of which v + from is at
/// most `size` long along each axis. signs: of the gradient, exactly.
SL_FUNC VoxelHalf voxelHalf(RoundedVector gradient, AxisSigns signs, int side, RealPoint from, SL_REAL size) {
  VoxelHalf half_space;
  half_space.factor.x = signs.x == 0 ? slReal(0) : slReal(side) * gradient.value.x;
  half_space.factor.y = signs.y == 0 ? slReal(0) : slReal(side) * gradient.value.y;
  half_space.factor.z = signs.z == 0 ? slReal(0) : slReal(side) * gradient.value.z;
  half_space.rises.x = side * signs.x;
  half_space.rises.y = side * signs.y;
  half_space.rises.z = side * signs.z;
  half_space.rest =
      (half_space.factor.x * from.x + half_space.factor.y * from.y) + half_space.factor.z * from.z;
  // Of rounding in factors, rest and value together, in units of the sum of what is added: each of some
  // twenty operations gives at most one.
  half_space.tolerance = slReal(32) * SL_REAL_UNIT *
                         ((gradient.magnitude.x + gradient.magnitude.y) + gradient.magnitude.z) * size;
  return half_space;
}

/// 1 / factor; infinite where rounding turned the factor, which then says nothing: each row is left open.
SL_FUNC SL_REAL inverseOf(SL_REAL factor, int rises) {
  if (factor * slReal(rises) > slReal(0)) return slReal(1) / factor;
#if SL_REAL_IS_FLOAT
  return uintBitsToFloat(0x7f800000u);
#else
  return slReal(uintBitsToFloat(0x7f800000u));
#endif
}

/// value <= the result, a whole number.
SL_FUNC int ceilingOf(SL_REAL value) {
  int whole = slInt(value);
  return slReal(whole) < value ? whole + 1 : whole;
}

/// The part of a run that is in a half space. rest: the half space's value at voxel 0 of the row; inverse: of
/// its factor along the row, rises: that factor's sign, not 0.
SL_FUNC VoxelRun narrowRun(VoxelRun run, SL_REAL rest, SL_REAL inverse, SL_REAL tolerance, int rises) {
  SL_REAL end = -rest * inverse;
  SL_REAL reach = tolerance * realAbs(inverse);
  SL_REAL from = slReal(run.low);
  SL_REAL to = slReal(run.high);
  run.open = false;
  if (!(reach < slReal(1.0e9f))) {
    run.open = true;
  } else if (rises > 0) {
    if (end + reach < from) return run;
    if (end - reach > to) {
      run.low = run.high + 1;
      return run;
    }
    int first = end - reach > from ? ceilingOf(end - reach) : run.low;
    run.open = !(end - reach > from && end + reach < slReal(first));
    if (!run.open) run.low = first;
  } else {
    if (end - reach > to) return run;
    if (end + reach < from) {
      run.high = run.low - 1;
      return run;
    }
    int last = end + reach < to ? -ceilingOf(-(end + reach)) : run.high;
    run.open = !(end + reach < to && end - reach > slReal(last));
    if (!run.open) run.high = last;
  }
  return run;
}

SL_NAMESPACE_END
#endif
