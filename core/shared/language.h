// One dialect for C++, OpenCL C and GLSL: the only file with an #ifdef by language.
//
// Rules of the dialect (docs/style in short): GLSL spelling, no pointers except SetRef and the macros
// below, results by value, integer index arithmetic, no transcendental functions, floating-point
// contraction off. vec3(...) always takes three arguments. Divisions and square roots must be correctly
// rounded on every device: floats are divided by slDivide, since Vulkan promises 2.5 units in the last place.
#ifndef SL_LANGUAGE_H
#define SL_LANGUAGE_H

#if defined(__OPENCL_VERSION__)

#pragma OPENCL FP_CONTRACT OFF
#if defined(cl_khr_fp64) || defined(__opencl_c_fp64)
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#define SL_FP64 1
#else
#define SL_FP64 0
#endif
typedef float2 vec2;
typedef float3 vec3;
typedef float4 vec4;
typedef uint2 uvec2;
typedef uint4 uvec4;
typedef ulong uint64;
#define vec2(x, y) ((float2)((x), (y)))
#define vec3(x, y, z) ((float3)((x), (y), (z)))
#define vec4(x, y, z, w) ((float4)((x), (y), (z), (w)))
#define uvec4(x, y, z, w) ((uint4)((x), (y), (z), (w)))
#define SL_STRUCT(S)  \
  typedef struct S S; \
  struct S
#define SL_FUNC static inline
#define SL_CONST __constant
#define floatBitsToUint as_uint
#define uintBitsToFloat as_float
// Not mul_hi: PoCL makes four multiplications of it.
#define slMulHigh(a, b) ((uint)(((ulong)(uint)(a) * (ulong)(uint)(b)) >> 32))
#define SL_SET_PARAM SetRef sl_set
#define SL_SET sl_set
#define SL_SET_CAPACITY sl_set.capacity
// OpenCL C 1.2 has no atomic read but one that writes. A volatile read of an aligned word serves as one; a checker that
// takes it for a race is told by SL_ATOMIC_LOADS (tests/checker): an atomic that writes makes bakes on a processor half
// as long again.
#ifdef SL_ATOMIC_LOADS
#define SL_SET_LOAD(field, i) atomic_or(&sl_set.field[i], 0u)
#else
#define SL_SET_LOAD(field, i) (sl_set.field[i])
#endif
#define SL_SET_CAS(field, i, expected, desired) atomic_cmpxchg(&sl_set.field[i], (expected), (desired))
#define SL_SET_OR(field, i, bits) atomic_or(&sl_set.field[i], (bits))
#define SL_SET_ADD(field, i, value) atomic_add(&sl_set.field[i], (value))
/// The set's buffers (core/shared/set.h). keys and winner have `capacity` slots, or capacity is 0 and winner
/// one a triangle.
typedef struct SetRef {
  volatile __global uint* keys;
  volatile __global uint* winner;
  volatile __global uint* fresh;
  volatile __global uint* overflow;
  uint capacity;
} SetRef;
// The scene's surfaces (surface.h): one array of words.
#define SL_SURFACES_PARAM __global const uint* sl_surfaces
#define SL_SURFACES sl_surfaces
#define SL_SURFACE_WORD(i) sl_surfaces[i]
// A stage's buffers, launch and triangles (stage_launch.h), in StageRef of cl_kernels/stage.cl.
#define SL_STAGE_PARAM const StageRef* sl_stage
#define SL_STAGE sl_stage
#define SL_BUFFER(name, i) sl_stage->name[i]
#define SL_LAUNCH(field) sl_stage->launch.field
#define SL_CORNERS(triangle) cornersOf(sl_stage, (triangle))
#define SL_STAGE_SET setOf(sl_stage)
#define SL_STAGE_ADD(name, i, value) atomic_add(&sl_stage->name[i], (value))
#define slInt(x) ((int)(x))
#define slUint(x) ((uint)(x))
#define slUint64(x) ((uint64)(x))
#define slFloat(x) ((float)(x))
#define slDivide(a, b) ((a) / (b))
#define slBitCount(x) popcount(x)
#define slLowestBit(x) (31u - clz((x) & (0u - (x))))

#elif defined(__cplusplus)

#include <atomic>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#define SL_FP64 1
namespace sightline {
using glm::floatBitsToUint;
using glm::max;
using glm::min;
using glm::uintBitsToFloat;
using glm::uvec2;
using glm::uvec4;
using glm::vec2;
using glm::vec3;
using glm::vec4;
using std::fabs;
using std::sqrt;
using uint = std::uint32_t;
using uint64 = std::uint64_t;
inline int slInt(auto x) {
  return static_cast<int>(x);
}
inline uint slUint(auto x) {
  return static_cast<uint>(x);
}
inline uint64 slUint64(auto x) {
  return static_cast<uint64>(x);
}
inline float slFloat(auto x) {
  return static_cast<float>(x);
}
inline float slDivide(float a, float b) {
  return a / b;
}
inline double slDivide(double a, double b) {
  return a / b;
}
inline uint slMulHigh(uint a, uint b) {
  return uint((uint64(a) * uint64(b)) >> 32);
}
/// The set's buffers (core/shared/set.h). keys and winner have `capacity` slots, or capacity is 0 and winner
/// one a triangle.
struct SetRef {
  uint* keys;
  uint* winner;
  uint* fresh;
  uint* overflow;
  uint capacity;
};
inline uint slAtomicCas(uint& slot, uint expected, uint desired) {
  std::atomic_ref<uint>(slot).compare_exchange_strong(expected, desired, std::memory_order_relaxed);
  return expected;
}
}  // namespace sightline
#define SL_SET_PARAM SetRef sl_set
#define SL_SET sl_set
#define SL_SET_CAPACITY sl_set.capacity
#define SL_SET_LOAD(field, i) (std::atomic_ref<uint>(sl_set.field[i]).load(std::memory_order_relaxed))
#define SL_SET_CAS(field, i, expected, desired) slAtomicCas(sl_set.field[i], (expected), (desired))
#define SL_SET_OR(field, i, bits) \
  std::atomic_ref<uint>(sl_set.field[i]).fetch_or((bits), std::memory_order_relaxed)
#define SL_SET_ADD(field, i, value) \
  std::atomic_ref<uint>(sl_set.field[i]).fetch_add((value), std::memory_order_relaxed)
#define SL_SURFACES_PARAM const uint* sl_surfaces
#define SL_SURFACES sl_surfaces
#define SL_SURFACE_WORD(i) sl_surfaces[i]
   // On the host a stage is an object with a function for each buffer and number that it has.
#define SL_STAGE_PARAM auto&& sl_stage
#define SL_STAGE sl_stage
#define SL_BUFFER(name, i) sl_stage.name(i)
#define SL_LAUNCH(field) sl_stage.field()
#define SL_CORNERS(triangle) sl_stage.corners(triangle)
   /// Buffers in a launch are addresses in C++, in order (vk_shaders/launch.h).
#define SL_ADDRESSES(buffers, count) uint64 addresses[count];
#define SL_STRUCT(S) struct S
#define SL_FUNC inline
#define SL_CONST constexpr

#else  // GLSL

#extension GL_ARB_gpu_shader_int64 : require
#define SL_FP64 1
#define uint64 uint64_t
#define SL_STRUCT(S) struct S
#define SL_FUNC
#define SL_CONST const
#define fabs abs
// A shader declares the set's buffers sl_set_keys, sl_set_winner, sl_set_fresh, sl_set_overflow and the
// constant sl_set_capacity before it includes core/shared/set.h; GLSL has no references, so the argument is a
// dummy.
#define SL_SET_PARAM uint sl_set
#define SL_SET sl_set
#define SL_SET_CAPACITY sl_set_capacity
#define SL_SET_LOAD(field, i) (sl_set_##field[i])
#define SL_SET_CAS(field, i, expected, desired) atomicCompSwap(sl_set_##field[i], (expected), (desired))
#define SL_SET_OR(field, i, bits) atomicOr(sl_set_##field[i], (bits))
#define SL_SET_ADD(field, i, value) atomicAdd(sl_set_##field[i], (value))
// The scene's surfaces are the launch's too (vk_shaders/surface.glsl): the argument is a dummy.
#define SL_SURFACES_PARAM uint sl_surfaces
#define SL_SURFACES sl_surfaces
#ifndef SL_SURFACE_WORD
#define SL_SURFACE_WORD(i) 0u
#endif
// A stage's launch is the whole shader's (vk_shaders/state.glsl); so this argument too is a dummy.
#define SL_STAGE_PARAM uint sl_stage
#define SL_STAGE sl_stage
#define SL_BUFFER(name, i) SL_THE_LAUNCH.name.at[i]
#define SL_LAUNCH(field) SL_THE_LAUNCH.numbers.field
#define SL_CORNERS(triangle) cornersOf(triangle)
#define SL_STAGE_SET kTheSet
#define SL_STAGE_ADD(name, i, value) atomicAdd(SL_THE_LAUNCH.name.at[i], (value))
#define SL_ADDRESS(type, name) Buffer_##type name;
#define SL_ADDRESSES(buffers, count) buffers(SL_ADDRESS)
#define slInt(x) int(x)
#define slUint(x) uint(x)
#define slBitCount(x) uint(bitCount(x))
#define slLowestBit(x) uint(findLSB(x))
#define slUint64(x) uint64_t(x)
#define slFloat(x) float(x)

// Vulkan promises division to 2.5 units in the last place and square roots to about 5; the following make the
// correctly rounded result of them. The true result lies beyond the midpoint to the next float if a lies
// beyond the midpoint times b (or squared): a product of at most 50 bits, exact in double. Not a division in
// double: lavapipe's errs too much. Zero, subnormal, infinite and NaN results stay as they are.
float slNeighbour(float positive, int steps) {
  return uintBitsToFloat(uint(int(floatBitsToUint(positive)) + steps));
}
double slMidpoint(float positive, int steps) {
  return 0.5lf * (double(positive) + double(slNeighbour(positive, steps)));
}
bool slIsNormal(float positive) {
  return positive >= uintBitsToFloat(0x00800000u) && positive < uintBitsToFloat(0x7f7fffffu);
}
float slDivide(float a, float b) {
  float quotient = a / b;
  float size = abs(quotient);
  for (int i = 0; i < 4 && slIsNormal(size); ++i) {
    int steps = double(abs(a)) > slMidpoint(size, 1) * double(abs(b))    ? 1
                : double(abs(a)) < slMidpoint(size, -1) * double(abs(b)) ? -1
                                                                         : 0;
    if (steps == 0) break;
    size = slNeighbour(size, steps);
  }
  return quotient < 0.0f ? -size : (quotient > 0.0f ? size : quotient);
}
float slSqrt(float x) {
  float root = sqrt(x);
  for (int i = 0; i < 8 && slIsNormal(root); ++i) {
    double high = slMidpoint(root, 1);
    double low = slMidpoint(root, -1);
    int steps = double(x) > high * high ? 1 : (double(x) < low * low ? -1 : 0);
    if (steps == 0) break;
    root = slNeighbour(root, steps);
  }
  return root;
}
// To a unit or two of the double's last place, by Newton's method.
double slDivide(double a, double b) {
  double quotient = a / b;
  quotient += (a - quotient * b) / b;
  return quotient + (a - quotient * b) / b;
}
#define sqrt slSqrt
uint slMulHigh(uint a, uint b) {
  uint high;
  uint low;
  umulExtended(a, b, high, low);
  return high;
}

#endif

#if defined(__cplusplus)
#define SL_NAMESPACE_BEGIN namespace sightline {
#define SL_NAMESPACE_END }
#else
#define SL_NAMESPACE_BEGIN
#define SL_NAMESPACE_END
#endif

#endif
