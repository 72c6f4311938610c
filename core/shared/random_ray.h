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
#include "core/shared/ray.h"
#include "core/shared/stage_params.h"
SL_NAMESPACE_BEGIN

/// The ray of point first + offset of the sequence. shifts: StageParams::shifts.
SL_FUNC Ray randomRay(uint64 first, uint offset, Face face, uvec4 shifts) {
  RandomRays rays = randomRays(first, offset, face, shifts);
  Ray ray;
  ray.origin = vec4(rays.origin_x, rays.origin_y, rays.origin_z, 0.0f);
  ray.direction = vec4(rays.direction_x, rays.direction_y, rays.direction_z, 0.0f);
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

/// Offset in the segment of the first ray of a stratum.
SL_FUNC uint stratumOffset(RandomSegment segment, uint stratum) {
  uint strata = segment.batch.y;
  uint size2 = 1u << segment.digits.x;
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
  uint64 sum = slUint64(reverseBits(cell2, segment.digits.x)) * segment.coefficients.x;
  sum += slUint64(reverseDigits(cell3, 3u, segment.digits.y)) * segment.coefficients.y;
  sum += slUint64(reverseDigits(cell5, 5u, segment.digits.z)) * segment.coefficients.z;
  sum += slUint64(reverseDigits(cell7, 7u, segment.digits.w)) * segment.coefficients.w;
  uint residue = slUint(sum % strata);
  return residue >= segment.batch.w ? residue - segment.batch.w : residue + (strata - segment.batch.w);
}

/// A place in the walk over a segment's slots; slots one after the other share their stratum's offset.
SL_STRUCT(SlotWalk) {
  uint first;   ///< slot of the stratum; kNoTriangle before the first
  uint offset;  ///< stratumOffset
};

SL_FUNC SlotWalk startSlotWalk() {
  SlotWalk walk;
  walk.first = kNoTriangle;
  walk.offset = 0u;
  return walk;
}

/// The walk at `slot`.
SL_FUNC SlotWalk walkToSlot(SlotWalk walk, RandomSegment segment, uint slot) {
  if (slot < walk.first || slot - walk.first >= segment.batch.z) {
    uint stratum = slot / segment.batch.z;
    walk.first = stratum * segment.batch.z;
    walk.offset = stratumOffset(segment, stratum);
  }
  return walk;
}

/// Offset in the segment (0 .. count - 1) of the ray that the slot traces, or kNoTriangle for the few slots
/// that have none (where the number of strata does not divide count). walk: at the slot.
SL_FUNC uint walkOffset(SlotWalk walk, RandomSegment segment, uint slot) {
  uint64 offset = slUint64(slot - walk.first) * segment.batch.y + walk.offset;
  return offset < segment.range.w ? slUint(offset) : kNoTriangle;
}

/// The same for a single slot.
SL_FUNC uint slotOffset(RandomSegment segment, uint slot) {
  return walkOffset(walkToSlot(startSlotWalk(), segment, slot), segment, slot);
}

/// The ray at an offset of slotOffset; one without direction for kNoTriangle.
SL_FUNC Ray offsetRay(RandomSegment segment, Face face, uvec4 shifts, uint offset) {
  Ray ray = randomRay(segmentFirst(segment), offset, face, shifts);
  if (offset == kNoTriangle) ray.direction = vec4(0.0f, 0.0f, 0.0f, 0.0f);
  return ray;
}

SL_NAMESPACE_END
#endif
