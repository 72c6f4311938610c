// One dialect for C++, OpenCL C and GLSL: the only file with an #ifdef by language.
//
// Rules of the dialect (docs/style in short): GLSL spelling, no pointers except SetRef and the macros
// below, results by value, integer index arithmetic, no transcendental functions, floating-point
// contraction off. vec3(...) always takes three arguments. Divisions and square roots must be correctly
// rounded on every device.
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
#define SL_STRUCT(S)   \
  typedef struct S S; \
  struct S
#define SL_FUNC static inline
#define SL_CONST __constant
#define floatBitsToUint as_uint
#define uintBitsToFloat as_float
#define slMulHigh(a, b) mul_hi((uint)(a), (uint)(b))
#define slFloat(x) ((float)(x))

#elif defined(__cplusplus)

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
inline uint slMulHigh(uint a, uint b) { return uint((uint64(a) * uint64(b)) >> 32); }
inline float slFloat(double x) { return float(x); }
}  // namespace sightline
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
#define slFloat(x) float(x)
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
