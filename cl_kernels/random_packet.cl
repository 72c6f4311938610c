// Random rays of SL_PACKET neighbouring slots of a segment: the rays of core/shared/random_ray.h, bit for bit.
// On eight lanes the digits of the Halton indices are taken apart in 16-bit parts, where a vector divides by a
// small constant in one multiplication.
#include "cl_kernels/ray_packet.cl"
#include "cl_kernels/trace_packet.cl"
#include "cl_kernels/trace_single.cl"
#include "core/shared/random_ray.h"

#if SL_PACKET == 8

/// slMulHigh on all lanes.
static inline uint8 mulHigh8(uint8 a, uint b) { return convert_uint8((convert_ulong8(a) * (ulong)b) >> 32); }

/// reverseDigits of values below 2^16 for a base and count known at compile time.
#define SL_REVERSE16(value, base, count)                       \
  ushort16 reversed = (ushort16)0;                             \
  __attribute__((opencl_unroll_hint)) for (int i = 0; i < (count); ++i) { \
    ushort16 quotient = (value) / (ushort)(base);              \
    reversed = reversed * (ushort)(base) + ((value) - quotient * (ushort)(base)); \
    (value) = quotient;                                        \
  }                                                            \
  return reversed

static inline ushort16 reverse16Base3(ushort16 value) { SL_REVERSE16(value, 3, 10); }
static inline ushort16 reverse16Base5(ushort16 value) { SL_REVERSE16(value, 5, 6); }
static inline ushort16 reverse16Base7(ushort16 value) { SL_REVERSE16(value, 7, 5); }

static inline ushort16 joined(uint8 low, uint8 high) {
  return (ushort16)(convert_ushort8(low), convert_ushort8(high));
}

/// (first + offset) modulo period.
static inline uint8 indexModulo(uint64 first, uint8 offset, uint period) {
  uint start = (uint)(first % period);
  uint8 rest = offset % period;
  return rest >= period - start ? rest - (period - start) : rest + start;
}

static inline uint8 shifted(uint8 digits, uint shift, uint period) {
  return digits >= period - shift ? digits - (period - shift) : digits + shift;
}

static inline uint8 halton2x8(uint64 first, uint8 offset, uint shift) {
  uint8 value = (uint)first + offset;
  value = ((value >> 1) & 0x55555555u) | ((value & 0x55555555u) << 1);
  value = ((value >> 2) & 0x33333333u) | ((value & 0x33333333u) << 2);
  value = ((value >> 4) & 0x0f0f0f0fu) | ((value & 0x0f0f0f0fu) << 4);
  value = ((value >> 8) & 0x00ff00ffu) | ((value & 0x00ff00ffu) << 8);
  value = (value >> 16) | (value << 16);
  return (value + shift) >> 8;
}

static inline uint8 halton3x8(uint64 first, uint8 offset, uint shift) {
  uint8 index = indexModulo(first, offset, kHaltonPeriod3);
  uint8 high = index / 59049u;  // 3^10
  ushort16 parts = reverse16Base3(joined(index - high * 59049u, high));
  uint8 digits = convert_uint8(parts.lo) * 59049u + convert_uint8(parts.hi);
  return mulHigh8(shifted(digits, shift, kHaltonPeriod3), 20665916u);
}

static inline uint8 halton5x8(uint64 first, uint8 offset, uint shift) {
  uint8 index = indexModulo(first, offset, kHaltonPeriod5);
  uint8 rest = index / 15625u;  // 5^6
  uint8 top = rest / 15625u;
  ushort16 parts = reverse16Base5(joined(index - rest * 15625u, rest - top * 15625u));
  uint8 digits = convert_uint8(parts.lo) * 78125u + convert_uint8(parts.hi) * 5u + top;
  return mulHigh8(shifted(digits, shift, kHaltonPeriod5), 59029581u);
}

static inline uint8 halton7x8(uint64 first, uint8 offset, uint shift) {
  uint8 index = indexModulo(first, offset, kHaltonPeriod7);
  uint8 rest = index / 16807u;  // 7^5
  uint8 top = rest / 16807u;
  ushort16 parts = reverse16Base7(joined(index - rest * 16807u, rest - top * 16807u));
  uint8 digits = convert_uint8(parts.lo) * 117649u + convert_uint8(parts.hi) * 7u + top;
  return mulHigh8(shifted(digits, shift, kHaltonPeriod7), 36441925u);
}

static inline float8 fraction8(uint8 fixed24) { return convert_float8(as_int8(fixed24)) * 5.9604644775390625e-8f; }

static inline float8 sinQuarter8(float8 x) {
  float8 x2 = x * x;
  float8 p = -3.5988432e-6f;
  p = p * x2 + 1.6044118e-4f;
  p = p * x2 + -4.6817541e-3f;
  p = p * x2 + 7.9692626e-2f;
  p = p * x2 + -6.4596410e-1f;
  p = p * x2 + 1.5707963f;
  return least(p * x, (float8)1.0f);
}

/// randomRay of the points first + offset; lanes whose offset is kNoTriangle get none.
static inline RayPacket randomRays8(uint64 first, uint8 offset, Face face, uint4 shifts) {
  uint8 azimuth = halton2x8(first, offset, shifts.x);
  float8 height = fraction8(halton3x8(first, offset, shifts.y));
  float8 u = fraction8(halton5x8(first, offset, shifts.z));
  float8 v = fraction8(halton7x8(first, offset, shifts.w));
  uint8 quadrant = azimuth >> 22;
  float8 within = convert_float8(as_int8(azimuth & 0x3fffffu)) * 2.384185791015625e-7f;
  float8 s = sinQuarter8(within);
  float8 c = sinQuarter8(1.0f - within);
  float8 z = 1.0f - height;
  float8 r = sqrt(height * (1.0f + z));
  float8 x = (quadrant & 1u) == 0u ? c : s;
  float8 y = (quadrant & 1u) == 0u ? s : c;
  x = ((quadrant == 1u) | (quadrant == 2u)) ? -x : x;
  y = quadrant >= 2u ? -y : y;
  x = r * x;
  y = r * y;
  int8 none = offset == kNoTriangle;
  RayPacket rays;
#define SL_AXIS(i, a)                                                                                 \
  rays.origin[i] = (face.corner.a + face.edge_u.a * u) + face.edge_v.a * v;                           \
  rays.direction[i] = none ? (float8)0.0f : (face.axis_u.a * x + face.axis_v.a * y) + face.normal.a * z
  SL_AXIS(0, x);
  SL_AXIS(1, y);
  SL_AXIS(2, z);
#undef SL_AXIS
  return rays;
}

#endif

/// slotOffset of the slots first .. first + SL_PACKET - 1; kNoTriangle past the last slot.
static inline void slotOffsets(RandomSegment segment, uint first, uint* offsets) {
  uint slots = segment.batch.y * segment.batch.z;
  uint stratum = first / segment.batch.z;
  uint turn = first - stratum * segment.batch.z;
  uint start = first < slots ? stratumOffset(segment, stratum) : 0u;
  for (uint lane = 0; lane < SL_PACKET; ++lane) {
    ulong whole = (ulong)turn * segment.batch.y + start;
    offsets[lane] = first + lane < slots && whole < segment.range.w ? (uint)whole : kNoTriangle;
    ++turn;
    if (turn == segment.batch.z && first + lane + 1 < slots) {
      turn = 0;
      ++stratum;
      start = stratumOffset(segment, stratum);
    }
  }
}

/// Generates and traces the rays of the slots first .. first + SL_PACKET - 1. offsets: of each ray in the
/// segment, or kNoTriangle where a slot has none (its hit is a miss).
static inline void traceSlots(SceneRef scene, RandomSegment segment, Face face, uint4 shifts, uint first,
                              uint* offsets, Hit* hits) {
  slotOffsets(segment, first, offsets);
#if SL_PACKET == 8
  RayPacket rays = randomRays8(segmentFirst(segment), vload8(0, offsets), face, shifts);
  storeHits(traceLanes(scene, &rays), hits);
#else
  hits[0] = missHit();
  if (offsets[0] == kNoTriangle) return;
  hits[0] = traceRay(scene, randomRay(segmentFirst(segment) + offsets[0], face, shifts));
#endif
}
