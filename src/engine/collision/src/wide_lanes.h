// SPDX-License-Identifier: Apache-2.0
/// \file wide_lanes.h  Eight floats. Included by wide_kernels_*.cpp only, each with its own compiler options:
/// nothing here may have a name that the linker could share between them.
#pragma once

#define TROCAR_LANES 8
#include "trocar/math/float_lanes.h"
#include "wide_kernels.h"

namespace trocar::collision {
namespace {

static_assert(kTreeWidth == TROCAR_LANES);

using math::All;
using math::Lanes;
using math::Larger;
using math::Load;
using math::Smaller;
using math::Sqrt;
using math::Store;
using LaneBits = math::LaneMask;
using Vector = math::LaneVector;

/// Lane by lane a where the bits are set, else b.
inline Lanes Pick(LaneBits bits, Lanes a, Lanes b) {
  return (Lanes)((bits & (LaneBits)a) | (~bits & (LaneBits)b));
}

inline unsigned SignBits(LaneBits bits) {
#if defined(__AVX__)
  return static_cast<unsigned>(_mm256_movemask_ps((__m256)bits));
#elif defined(__SSE2__) || defined(__wasm_simd128__)
  unsigned found = 0;
  for (int part = 0; part < 2; ++part) {
#if defined(__SSE2__)
    __m128 quad;
    __builtin_memcpy(&quad, reinterpret_cast<const char*>(&bits) + 16 * part, sizeof quad);
    found |= static_cast<unsigned>(_mm_movemask_ps(quad)) << (4 * part);
#else
    v128_t quad;
    __builtin_memcpy(&quad, reinterpret_cast<const char*>(&bits) + 16 * part, sizeof quad);
    found |= static_cast<unsigned>(wasm_i32x4_bitmask(quad)) << (4 * part);
#endif
  }
  return found;
#else
  unsigned found = 0;
  for (int lane = 0; lane < kTreeWidth; ++lane) found |= (bits[lane] < 0 ? 1u : 0u) << lane;
  return found;
#endif
}

inline Lanes Absolute(Lanes v) {
  return (Lanes)((LaneBits)v & (LaneBits{} + 0x7fffffff));
}
inline Lanes Clamp01(Lanes v) {
  return Smaller(Larger(v, Lanes{}), All(1.0f));
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
inline Vector LoadPoints(const WidePoint* points, const std::uint32_t* index) {
  return math::LoadPoints(points, [index](int lane) { return index[lane]; });
}

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
