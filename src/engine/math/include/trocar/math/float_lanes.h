// SPDX-License-Identifier: Apache-2.0
/// \file float_lanes.h  A vector of TROCAR_LANES floats (4, 8 or 16), and three of them as points side by side.
///
/// For files that are compiled once for each level of vector instructions, each with its own compiler options: everything here
/// has internal linkage, so that the linker cannot hand a wide version to a processor that lacks it. The file that includes it
/// says TROCAR_LANES first. No function reorders or approximates.
#pragma once

#if defined(__SSE2__)
#include <immintrin.h>
#elif defined(__aarch64__)
#include <arm_neon.h>
#elif defined(__wasm_simd128__)
#include <wasm_simd128.h>
#endif

#include <cstdint>

#ifndef TROCAR_LANES
#define TROCAR_LANES 4
#endif

namespace trocar::math {
namespace {

typedef float Lanes __attribute__((vector_size(4 * TROCAR_LANES)));
typedef std::int32_t LaneMask __attribute__((vector_size(4 * TROCAR_LANES)));

inline Lanes Load(const float* from) {
  Lanes v;
  __builtin_memcpy(&v, from, sizeof v);
  return v;
}
inline void Store(float* to, Lanes v) {
  __builtin_memcpy(to, &v, sizeof v);
}
inline Lanes All(float value) {
  return value - Lanes{};
}

// b where either is not a number
#if TROCAR_LANES == 8 && defined(__AVX__)
inline Lanes Smaller(Lanes a, Lanes b) {
  return (Lanes)_mm256_min_ps((__m256)a, (__m256)b);
}
inline Lanes Larger(Lanes a, Lanes b) {
  return (Lanes)_mm256_max_ps((__m256)a, (__m256)b);
}
#else
inline Lanes Smaller(Lanes a, Lanes b) {
  return a < b ? a : b;
}
inline Lanes Larger(Lanes a, Lanes b) {
  return a > b ? a : b;
}
#endif

#if TROCAR_LANES == 16 && defined(__AVX512F__)
inline Lanes Sqrt(Lanes v) {
  return (Lanes)_mm512_sqrt_ps((__m512)v);
}
#elif TROCAR_LANES == 8 && defined(__AVX__)
inline Lanes Sqrt(Lanes v) {
  return (Lanes)_mm256_sqrt_ps((__m256)v);
}
#else
/// Four floats: what SSE2, NEON and WebAssembly's SIMD128 have.
typedef float LaneQuad __attribute__((vector_size(16)));
inline LaneQuad SqrtQuad(LaneQuad v) {
#if defined(__SSE2__)
  return (LaneQuad)_mm_sqrt_ps((__m128)v);
#elif defined(__aarch64__)
  return (LaneQuad)vsqrtq_f32((float32x4_t)v);
#elif defined(__wasm_simd128__)
  return (LaneQuad)wasm_f32x4_sqrt((v128_t)v);
#else
  for (int lane = 0; lane < 4; ++lane) v[lane] = __builtin_sqrtf(v[lane]);
  return v;
#endif
}
inline Lanes Sqrt(Lanes v) {
  for (int part = 0; part < TROCAR_LANES / 4; ++part) {
    LaneQuad quad;
    __builtin_memcpy(&quad, reinterpret_cast<const char*>(&v) + 16 * part, sizeof quad);
    quad = SqrtQuad(quad);
    __builtin_memcpy(reinterpret_cast<char*>(&v) + 16 * part, &quad, sizeof quad);
  }
  return v;
}
#endif

/// TROCAR_LANES points.
struct LaneVector {
  Lanes x, y, z;
};
inline LaneVector operator+(const LaneVector& a, const LaneVector& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline LaneVector operator-(const LaneVector& a, const LaneVector& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline LaneVector operator*(Lanes s, const LaneVector& v) {
  return {s * v.x, s * v.y, s * v.z};
}
inline LaneVector operator-(const LaneVector& v) {
  return {-v.x, -v.y, -v.z};
}

/// Points of 16 bytes, x first: one load each, then a transpose in registers.
/// \param at  index of the point of a lane
#if (TROCAR_LANES == 16 && defined(__AVX512DQ__)) || (TROCAR_LANES == 8 && defined(__AVX__)) || \
    (TROCAR_LANES == 4 && defined(__SSE2__))
template <typename Point, typename At>
inline LaneVector LoadPoints(const Point* points, const At& at) {
  static_assert(sizeof(Point) == 16 && alignof(Point) == 16);
  const auto point = [&](int lane) { return _mm_load_ps(&points[at(lane)].x); };
#if TROCAR_LANES == 16
  const auto column = [&](int i) {
    const __m256 low = _mm256_insertf128_ps(_mm256_castps128_ps256(point(i)), point(i + 4), 1);
    const __m256 high = _mm256_insertf128_ps(_mm256_castps128_ps256(point(i + 8)), point(i + 12), 1);
    return _mm512_insertf32x8(_mm512_castps256_ps512(low), high, 1);
  };
  const __m512 a = column(0), b = column(1), c = column(2), d = column(3);
  const __m512d ab = (__m512d)_mm512_unpacklo_ps(a, b), cd = (__m512d)_mm512_unpacklo_ps(c, d);
  const __m512d abz = (__m512d)_mm512_unpackhi_ps(a, b), cdz = (__m512d)_mm512_unpackhi_ps(c, d);
  return {(Lanes)_mm512_unpacklo_pd(ab, cd), (Lanes)_mm512_unpackhi_pd(ab, cd),
          (Lanes)_mm512_unpacklo_pd(abz, cdz)};
#elif TROCAR_LANES == 8
  const auto column = [&](int i) {
    return _mm256_insertf128_ps(_mm256_castps128_ps256(point(i)), point(i + 4), 1);
  };
  const __m256 a = column(0), b = column(1), c = column(2), d = column(3);
  const __m256d ab = (__m256d)_mm256_unpacklo_ps(a, b), cd = (__m256d)_mm256_unpacklo_ps(c, d);
  const __m256d abz = (__m256d)_mm256_unpackhi_ps(a, b), cdz = (__m256d)_mm256_unpackhi_ps(c, d);
  return {(Lanes)_mm256_unpacklo_pd(ab, cd), (Lanes)_mm256_unpackhi_pd(ab, cd),
          (Lanes)_mm256_unpacklo_pd(abz, cdz)};
#else
  const __m128 a = point(0), b = point(1), c = point(2), d = point(3);
  const __m128d ab = (__m128d)_mm_unpacklo_ps(a, b), cd = (__m128d)_mm_unpacklo_ps(c, d);
  const __m128d abz = (__m128d)_mm_unpackhi_ps(a, b), cdz = (__m128d)_mm_unpackhi_ps(c, d);
  return {(Lanes)_mm_unpacklo_pd(ab, cd), (Lanes)_mm_unpackhi_pd(ab, cd), (Lanes)_mm_unpacklo_pd(abz, cdz)};
#endif
}
#elif TROCAR_LANES == 4
template <typename Point, typename At>
inline LaneVector LoadPoints(const Point* points, const At& at) {
  static_assert(sizeof(Point) == 16 && alignof(Point) == 16);
  const auto point = [&](int lane) { return Load(&points[at(lane)].x); };
  const Lanes a = point(0), b = point(1), c = point(2), d = point(3);
  const Lanes ab = __builtin_shufflevector(a, b, 0, 4, 1, 5), cd = __builtin_shufflevector(c, d, 0, 4, 1, 5);
  const Lanes abz = __builtin_shufflevector(a, b, 2, 6, 3, 7),
              cdz = __builtin_shufflevector(c, d, 2, 6, 3, 7);
  return {__builtin_shufflevector(ab, cd, 0, 1, 4, 5), __builtin_shufflevector(ab, cd, 2, 3, 6, 7),
          __builtin_shufflevector(abz, cdz, 0, 1, 4, 5)};
}
#else
template <typename Point, typename At>
inline LaneVector LoadPoints(const Point* points, const At& at) {
  LaneVector v;
  for (int lane = 0; lane < TROCAR_LANES; ++lane) {
    const Point& point = points[at(lane)];
    v.x[lane] = point.x, v.y[lane] = point.y, v.z[lane] = point.z;
  }
  return v;
}
#endif

}  // namespace
}  // namespace trocar::math
