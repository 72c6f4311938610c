#pragma once
// Four floats at once: SSE on x86-64 (part of its baseline), plain code elsewhere with the same results.
#include <cstdint>
#include <cstring>
#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace sightline {

#if defined(__SSE2__)
struct Float4 {
  __m128 v;
};
struct Int4 {
  alignas(16) int32_t v[4];
};
inline Float4 load4(const float* p) {
  return {_mm_loadu_ps(p)};
}
inline void store4(float* p, Float4 a) {
  _mm_storeu_ps(p, a.v);
}
inline Float4 splat4(float s) {
  return {_mm_set1_ps(s)};
}
inline Float4 operator+(Float4 a, Float4 b) {
  return {_mm_add_ps(a.v, b.v)};
}
inline Float4 operator-(Float4 a, Float4 b) {
  return {_mm_sub_ps(a.v, b.v)};
}
inline Float4 operator*(Float4 a, Float4 b) {
  return {_mm_mul_ps(a.v, b.v)};
}
inline Float4 min4(Float4 a, Float4 b) {
  return {_mm_min_ps(a.v, b.v)};
}
inline Float4 max4(Float4 a, Float4 b) {
  return {_mm_max_ps(a.v, b.v)};
}
/// Sets the fourth lane to zero, whatever bits it had.
inline Float4 clearFourth(Float4 a) {
  return {_mm_and_ps(a.v, _mm_castsi128_ps(_mm_set_epi32(0, -1, -1, -1)))};
}
/// Whether a <= b in the first three lanes.
inline bool lessEqual3(Float4 a, Float4 b) {
  return (_mm_movemask_ps(_mm_cmple_ps(a.v, b.v)) & 7) == 7;
}
/// Replaces lane i by s.
inline void setLane(Float4& a, int i, float s) {
  const __m128 mask = _mm_castsi128_ps(_mm_cmpeq_epi32(_mm_set_epi32(3, 2, 1, 0), _mm_set1_epi32(i)));
  a.v = _mm_or_ps(_mm_and_ps(mask, _mm_set1_ps(s)), _mm_andnot_ps(mask, a.v));
}
/// Rounds towards zero; the values must fit in 31 bits.
inline Int4 truncate4(Float4 a) {
  Int4 r;
  _mm_store_si128(reinterpret_cast<__m128i*>(r.v), _mm_cvttps_epi32(a.v));
  return r;
}
#else
struct Float4 {
  float v[4];
};
struct Int4 {
  int32_t v[4];
};
inline Float4 load4(const float* p) {
  return {{p[0], p[1], p[2], p[3]}};
}
inline void store4(float* p, Float4 a) {
  std::memcpy(p, a.v, sizeof a.v);
}
inline Float4 splat4(float s) {
  return {{s, s, s, s}};
}
template <typename F>
Float4 lanes4(Float4 a, Float4 b, F f) {
  return {{f(a.v[0], b.v[0]), f(a.v[1], b.v[1]), f(a.v[2], b.v[2]), f(a.v[3], b.v[3])}};
}
inline Float4 operator+(Float4 a, Float4 b) {
  return lanes4(a, b, [](float x, float y) { return x + y; });
}
inline Float4 operator-(Float4 a, Float4 b) {
  return lanes4(a, b, [](float x, float y) { return x - y; });
}
inline Float4 operator*(Float4 a, Float4 b) {
  return lanes4(a, b, [](float x, float y) { return x * y; });
}
inline Float4 min4(Float4 a, Float4 b) {
  return lanes4(a, b, [](float x, float y) { return x < y ? x : y; });
}
inline Float4 max4(Float4 a, Float4 b) {
  return lanes4(a, b, [](float x, float y) { return x > y ? x : y; });
}
inline bool lessEqual3(Float4 a, Float4 b) {
  return a.v[0] <= b.v[0] && a.v[1] <= b.v[1] && a.v[2] <= b.v[2];
}
inline void setLane(Float4& a, int i, float s) {
  a.v[i] = s;
}
inline Float4 clearFourth(Float4 a) {
  return {{a.v[0], a.v[1], a.v[2], 0.0f}};
}
inline Int4 truncate4(Float4 a) {
  return {{static_cast<int32_t>(a.v[0]), static_cast<int32_t>(a.v[1]), static_cast<int32_t>(a.v[2]), 0}};
}
#endif

/// Lane i, 0..3.
inline float lane(Float4 a, int i) {
  alignas(16) float f[4];
  store4(f, a);
  return f[i];
}

}  // namespace sightline
