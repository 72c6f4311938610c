// SL_PACKET rays side by side: a lane of a vector a ray.
#ifndef SL_RAY_PACKET_CL
#define SL_RAY_PACKET_CL
#include "cl_kernels/scene.cl"

#if SL_PACKET == 8

typedef struct RayPacket {
  float8 origin[3];     // x, y, z
  float8 direction[3];  // zero on all axes: a lane without a ray
} RayPacket;

typedef struct HitPacket {
  float8 t;
  uint8 triangle;
  uint glass;  // bits of the lanes that met glass before what ends them, and perhaps of others that met any
} HitPacket;

/// Bit i: lane i of the mask is set (all bits of it).
static inline uint laneBits(int8 mask) {
#ifdef __AVX__
  return (uint)__builtin_ia32_movmskps256(as_float8(mask));
#else
  int8 bits = mask & (int8)(1, 2, 4, 8, 16, 32, 64, 128);
  int4 sum4 = bits.lo + bits.hi;
  int2 sum2 = sum4.lo + sum4.hi;
  return (uint)(sum2.x + sum2.y);
#endif
}

/// `min` and `max` of OpenCL take several instructions for their rules on NaN; these take one.
static inline float8 least(float8 a, float8 b) {
  return a < b ? a : b;
}
static inline float8 most(float8 a, float8 b) {
  return a > b ? a : b;
}

#endif
#endif
