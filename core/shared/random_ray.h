// Random rays of a view cell's face (thesis 5.2, algorithm 6.1), and the order in which they are traced.
//
// A point of the four-dimensional Halton sequence gives a ray: bases 2 and 3 its direction, uniform over the
// hemisphere about the face's normal, bases 5 and 7 its origin, uniform over the face.
//
// Order: the points whose direction and origin fall into one cell of a 2^a by 3^b by 5^c by 7^d grid are
// those with one residue modulo M = 2^a 3^b 5^c 7^d (the low digits of the index are the high digits of the
// fraction). So a run of the sequence can be enumerated stratum by stratum without sorting: slot s belongs
// to stratum s / per_stratum, the strata walk the grid of directions row by row, to and fro, and within a
// direction the grid of origins. Rays of neighbouring slots leave close to each other in almost the same
// direction. A random shift moves the grid but not this property.
#ifndef SL_RANDOM_RAY_H
#define SL_RANDOM_RAY_H
#include "core/shared/halton.h"
#include "core/shared/stage_params.h"
#include "core/shared/vector.h"
SL_NAMESPACE_BEGIN

/// sin(x * pi / 2) for x in [0, 1], error below 3e-7: Taylor polynomial of degree 11. The runtimes' own
/// sines differ from each other.
SL_FUNC float sinQuarter(float x) {
  float x2 = x * x;
  float p = -3.5988432e-6f;
  p = p * x2 + 1.6044118e-4f;
  p = p * x2 + -4.6817541e-3f;
  p = p * x2 + 7.9692626e-2f;
  p = p * x2 + -6.4596410e-1f;
  p = p * x2 + 1.5707963f;
  return min(p * x, 1.0f);
}

/// Unit direction in the face's frame (x: axis_u, y: axis_v, z: normal, z > 0) for fixed-point numbers of 24
/// bits (equation 5.3 with z = 1 - h).
SL_FUNC vec3 hemisphereDirection(uint azimuth24, uint height24) {
  uint quadrant = azimuth24 >> 22;
  float within = slFloat(azimuth24 & 0x3fffffu) * 2.384185791015625e-7f;  // exact, [0, 1)
  float s = sinQuarter(within);
  float c = sinQuarter(1.0f - within);
  float height = haltonFraction(height24);
  float z = 1.0f - height;
  float r = sqrt(height * (1.0f + z));
  float x = (quadrant & 1u) == 0u ? c : s;
  float y = (quadrant & 1u) == 0u ? s : c;
  x = (quadrant == 1u || quadrant == 2u) ? -x : x;
  y = quadrant >= 2u ? -y : y;
  return vec3(r * x, r * y, z);
}

/// The ray of point `index` of the sequence. shifts: StageParams::shifts.
SL_FUNC Ray randomRay(uint64 index, Face face, uvec4 shifts) {
  vec3 framed = hemisphereDirection(halton2(index, shifts.x), halton3(index, shifts.y));
  float u = haltonFraction(halton5(index, shifts.z));
  float v = haltonFraction(halton7(index, shifts.w));
  vec3 origin = add3(add3(xyz3(face.corner), scale3(xyz3(face.edge_u), u)), scale3(xyz3(face.edge_v), v));
  vec3 direction = add3(add3(scale3(xyz3(face.axis_u), framed.x), scale3(xyz3(face.axis_v), framed.y)),
                        scale3(xyz3(face.normal), framed.z));
  Ray ray;
  ray.origin = vec4(origin.x, origin.y, origin.z, 0.0f);
  ray.direction = vec4(direction.x, direction.y, direction.z, 0.0f);
  return ray;
}

SL_FUNC uint64 segmentFirst(RandomSegment segment) {
  return (slUint64(segment.range.z) << 32) | slUint64(segment.range.y);
}

/// base^exponent; the powers of a segment fit 32 bits.
SL_FUNC uint power(uint base, uint exponent) {
  uint result = 1u;
  for (uint i = 0u; i < exponent; ++i) result *= base;
  return result;
}

/// Offset in the segment of the first ray of a stratum; its others follow `strata` apart.
SL_FUNC uint stratumOffset(RandomSegment segment, uint stratum) {
  uint strata = segment.batch.y;
  uint size2 = power(2u, segment.digits.x);
  uint size5 = power(5u, segment.digits.z);
  uint size7 = power(7u, segment.digits.w);

  // Rank of the stratum -> cell of the grid, odd rows backwards.
  uint row = stratum / size7;
  uint cell7 = stratum - row * size7;
  cell7 = (row & 1u) == 0u ? cell7 : size7 - 1u - cell7;
  uint rest = row / size5;
  uint cell5 = row - rest * size5;
  cell5 = (rest & 1u) == 0u ? cell5 : size5 - 1u - cell5;
  uint cell3 = rest / size2;
  uint cell2 = rest - cell3 * size2;
  cell2 = (cell3 & 1u) == 0u ? cell2 : size2 - 1u - cell2;

  // Cell -> residues -> residue modulo M.
  uint64 residue = slUint64(reverseDigits2(cell2, segment.digits.x)) * segment.coefficients.x;
  residue += slUint64(reverseDigits3(cell3, segment.digits.y)) * segment.coefficients.y;
  residue += slUint64(reverseDigits5(cell5, segment.digits.z)) * segment.coefficients.z;
  residue += slUint64(reverseDigits7(cell7, segment.digits.w)) * segment.coefficients.w;
  uint rest_of_strata = slUint(residue % strata);
  return rest_of_strata >= segment.batch.w ? rest_of_strata - segment.batch.w
                                           : rest_of_strata + (strata - segment.batch.w);
}

/// Offset in the segment (0 .. count - 1) of the ray that slot s traces, or kNoTriangle for the few slots
/// that have none (where the number of strata does not divide count).
SL_FUNC uint slotOffset(RandomSegment segment, uint slot) {
  uint stratum = slot / segment.batch.z;
  uint turn = slot - stratum * segment.batch.z;
  uint64 whole = slUint64(turn) * segment.batch.y + stratumOffset(segment, stratum);
  return whole < segment.range.w ? slUint(whole) : kNoTriangle;
}

/// The ray of slot s, or one without direction where the slot has none.
SL_FUNC Ray slotRay(RandomSegment segment, Face face, uvec4 shifts, uint slot) {
  uint offset = slotOffset(segment, slot);
  Ray ray = randomRay(segmentFirst(segment) + slUint64(offset), face, shifts);
  if (offset == kNoTriangle) ray.direction = vec4(0.0f, 0.0f, 0.0f, 0.0f);
  return ray;
}

SL_NAMESPACE_END
#endif
