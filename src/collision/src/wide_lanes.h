// SPDX-License-Identifier: Apache-2.0
/// \file wide_lanes.h  Eight floats. Included by wide_kernels_*.cpp only, each with its own compiler options:
/// nothing here may have a name that the linker could share between them.
#pragma once

#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include "wide_kernels.h"

namespace trocar::collision {
namespace {

typedef float Lanes __attribute__((vector_size(32)));
typedef std::int32_t LaneBits __attribute__((vector_size(32)));

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
/// Lane by lane a where the bits are set, else b.
inline Lanes Pick(LaneBits bits, Lanes a, Lanes b) {
  return (Lanes)((bits & (LaneBits)a) | (~bits & (LaneBits)b));
}

// b where either is not a number
#if defined(__AVX__)
inline Lanes Smaller(Lanes a, Lanes b) {
  return (Lanes)_mm256_min_ps((__m256)a, (__m256)b);
}
inline Lanes Larger(Lanes a, Lanes b) {
  return (Lanes)_mm256_max_ps((__m256)a, (__m256)b);
}
inline Lanes Sqrt(Lanes v) {
  return (Lanes)_mm256_sqrt_ps((__m256)v);
}
inline unsigned SignBits(LaneBits bits) {
  return static_cast<unsigned>(_mm256_movemask_ps((__m256)bits));
}
#else
inline Lanes Smaller(Lanes a, Lanes b) {
  return Pick(a < b, a, b);
}
inline Lanes Larger(Lanes a, Lanes b) {
  return Pick(a > b, a, b);
}
inline Lanes Sqrt(Lanes v) {
  for (int lane = 0; lane < kTreeWidth; ++lane) v[lane] = __builtin_sqrtf(v[lane]);
  return v;
}
inline unsigned SignBits(LaneBits bits) {
  unsigned found = 0;
  for (int lane = 0; lane < kTreeWidth; ++lane) found |= (bits[lane] < 0 ? 1u : 0u) << lane;
  return found;
}
#endif

inline Lanes Absolute(Lanes v) {
  return (Lanes)((LaneBits)v & (LaneBits{} + 0x7fffffff));
}
inline Lanes Clamp01(Lanes v) {
  return Smaller(Larger(v, Lanes{}), All(1.0f));
}

struct Vector {
  Lanes x, y, z;
};
inline Vector operator+(const Vector& a, const Vector& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Vector operator-(const Vector& a, const Vector& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Vector operator*(Lanes s, const Vector& a) {
  return {s * a.x, s * a.y, s * a.z};
}
inline Lanes Dot(const Vector& a, const Vector& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Vector AllOf(const float* p) {
  return {All(p[0]), All(p[1]), All(p[2])};
}
inline Vector Pick(LaneBits bits, const Vector& a, const Vector& b) {
  return {Pick(bits, a.x, b.x), Pick(bits, a.y, b.y), Pick(bits, a.z, b.z)};
}
inline Lanes LargestCoordinate(const Vector& a) {
  return Larger(Larger(Absolute(a.x), Absolute(a.y)), Absolute(a.z));
}

/// Eight points by their indices.
#if defined(__AVX__)
inline Vector LoadPoints(const WidePoint* points, const std::uint32_t* index) {
  const auto column = [&](int i) {
    return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_load_ps(&points[index[i]].x)),
                                _mm_load_ps(&points[index[i + 4]].x), 1);
  };
  const __m256 a = column(0), b = column(1), c = column(2), d = column(3);
  const __m256d ab = (__m256d)_mm256_unpacklo_ps(a, b), cd = (__m256d)_mm256_unpacklo_ps(c, d);
  const __m256d abz = (__m256d)_mm256_unpackhi_ps(a, b), cdz = (__m256d)_mm256_unpackhi_ps(c, d);
  return {(Lanes)_mm256_unpacklo_pd(ab, cd), (Lanes)_mm256_unpackhi_pd(ab, cd),
          (Lanes)_mm256_unpacklo_pd(abz, cdz)};
}
#else
inline Vector LoadPoints(const WidePoint* points, const std::uint32_t* index) {
  Vector v;
  for (int lane = 0; lane < kTreeWidth; ++lane) {
    v.x[lane] = points[index[lane]].x, v.y[lane] = points[index[lane]].y, v.z[lane] = points[index[lane]].z;
  }
  return v;
}
#endif

/// Four floats of one point.
typedef float Quad __attribute__((vector_size(16)));
inline Quad LoadQuad(const WidePoint& point) {
  Quad v;
  __builtin_memcpy(&v, &point, sizeof v);
  return v;
}
#if defined(__SSE2__)
inline Quad Smaller(Quad a, Quad b) {
  return (Quad)_mm_min_ps((__m128)a, (__m128)b);
}
inline Quad Larger(Quad a, Quad b) {
  return (Quad)_mm_max_ps((__m128)a, (__m128)b);
}
#else
inline Quad Smaller(Quad a, Quad b) {
  return a < b ? a : b;
}
inline Quad Larger(Quad a, Quad b) {
  return a > b ? a : b;
}
#endif

}  // namespace
}  // namespace trocar::collision
