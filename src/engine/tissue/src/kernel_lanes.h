// SPDX-License-Identifier: Apache-2.0
/// \file kernel_lanes.h  A vector of TROCAR_LANES floats. Included by kernels_*.cpp only, each with its own
/// compiler options: nothing here may have a name that the linker could share between them.
#pragma once

#include "kernels.h"
#include "trocar/math/lane_arithmetic.h"

namespace trocar::tissue {
namespace {

using math::AddSquaredNorm;
using math::All;
using math::BeginTogether;
using math::KeepInRegister;
using math::kKeepsOrder;
using math::Lanes;
using math::Larger;
using math::Load;
using math::MulAdd;
using math::ShiftUp;
using math::Sqrt;
using math::Store;
using Vector = math::LaneVector;

/// TROCAR_LANES nodes side by side.
inline Vector LoadNodes(const Float4* nodes) {
#if TROCAR_LANES == 16
  // four loads of four nodes each, then x and y of eight nodes, then of sixteen
  const auto four = [&](int first) { return _mm512_loadu_ps(&nodes[first].x); };
  const __m512i of_xy = _mm512_setr_epi32(0, 4, 8, 12, 16, 20, 24, 28, 1, 5, 9, 13, 17, 21, 25, 29);
  const __m512i of_z = _mm512_setr_epi32(2, 6, 10, 14, 18, 22, 26, 30, 2, 6, 10, 14, 18, 22, 26, 30);
  const __m512 a = four(0), b = four(4), c = four(8), d = four(12);
  const __m512 ab = _mm512_permutex2var_ps(a, of_xy, b), cd = _mm512_permutex2var_ps(c, of_xy, d);
  const __m512 abz = _mm512_permutex2var_ps(a, of_z, b), cdz = _mm512_permutex2var_ps(c, of_z, d);
  return {(Lanes)_mm512_shuffle_f32x4(ab, cd, 0x44), (Lanes)_mm512_shuffle_f32x4(ab, cd, 0xee),
          (Lanes)_mm512_shuffle_f32x4(abz, cdz, 0x44)};
#else
  return math::LoadPoints(nodes, [](int lane) { return lane; });
#endif
}

inline Vector GatherNodes(const Float4* nodes, const std::uint32_t* indices) {
  return math::LoadPoints(nodes, [indices](int lane) { return indices[lane]; });
}

#if TROCAR_LANES == 16
/// A step's neighbours from the slices that they lie in.
inline Vector LookUp(const float* u, const SliceLookup& lookup) {
  const __m512i places =
      _mm512_cvtepu8_epi32(_mm_loadu_si128(reinterpret_cast<const __m128i*>(lookup.places)));
  const auto pick = [&](std::uint32_t pair, std::uint32_t axis) {
    const auto load = [&](std::uint32_t slice) {
      return _mm512_loadu_ps(u + (std::size_t{lookup.slices[slice]} * 3 + axis) * kSliceNodes);
    };
    // the lowest five bits of a place choose among two slices
    return _mm512_permutex2var_ps(load(2 * pair), places, load(2 * pair + 1));
  };
  __m512 x = pick(0, 0), y = pick(0, 1), z = pick(0, 2);
  for (std::uint32_t pair = 1; pair < lookup.pairs; ++pair) {
    const __mmask16 is_there =
        _mm512_cmpge_epu32_mask(places, _mm512_set1_epi32(static_cast<int>(2 * pair * kSliceNodes)));
    x = _mm512_mask_mov_ps(x, is_there, pick(pair, 0));
    y = _mm512_mask_mov_ps(y, is_there, pick(pair, 1));
    z = _mm512_mask_mov_ps(z, is_there, pick(pair, 2));
  }
  return {(Lanes)x, (Lanes)y, (Lanes)z};
}
#endif

/// TROCAR_LANES nodes side by side: a transpose, then one store of 16 bytes each.
inline void StoreNodes(Float4* nodes, const Vector& v) {
#if TROCAR_LANES == 16
  const __m512i lane = _mm512_setr_epi32(0, 16, 0, 0, 1, 17, 1, 1, 2, 18, 2, 2, 3, 19, 3, 3);
  for (int part = 0; part < 4; ++part) {
    const __m512i from = _mm512_add_epi32(lane, _mm512_set1_epi32(4 * part));
    const __m512 xy = _mm512_maskz_permutex2var_ps(0x3333, (__m512)v.x, from, (__m512)v.y);
    _mm512_storeu_ps(&nodes[4 * part].x, _mm512_mask_permutexvar_ps(xy, 0x4444, from, (__m512)v.z));
  }
#elif defined(__SSE2__)
  for (int part = 0; part < TROCAR_LANES; part += 4) {
    __m128 x, y, z, w = _mm_setzero_ps();
    __builtin_memcpy(&x, reinterpret_cast<const char*>(&v.x) + 4 * part, sizeof x);
    __builtin_memcpy(&y, reinterpret_cast<const char*>(&v.y) + 4 * part, sizeof y);
    __builtin_memcpy(&z, reinterpret_cast<const char*>(&v.z) + 4 * part, sizeof z);
    _MM_TRANSPOSE4_PS(x, y, z, w);
    _mm_store_ps(&nodes[part].x, x);
    _mm_store_ps(&nodes[part + 1].x, y);
    _mm_store_ps(&nodes[part + 2].x, z);
    _mm_store_ps(&nodes[part + 3].x, w);
  }
#elif TROCAR_LANES == 4
  const Lanes xy = __builtin_shufflevector(v.x, v.y, 0, 4, 1, 5),
              xy_after = __builtin_shufflevector(v.x, v.y, 2, 6, 3, 7);
  const Lanes z = __builtin_shufflevector(v.z, Lanes{}, 0, 4, 1, 4),
              z_after = __builtin_shufflevector(v.z, Lanes{}, 2, 4, 3, 4);
  Store(&nodes[0].x, __builtin_shufflevector(xy, z, 0, 1, 4, 5));
  Store(&nodes[1].x, __builtin_shufflevector(xy, z, 2, 3, 6, 7));
  Store(&nodes[2].x, __builtin_shufflevector(xy_after, z_after, 0, 1, 4, 5));
  Store(&nodes[3].x, __builtin_shufflevector(xy_after, z_after, 2, 3, 6, 7));
#else
  for (int lane = 0; lane < TROCAR_LANES; ++lane) nodes[lane] = {v.x[lane], v.y[lane], v.z[lane], 0.0f};
#endif
}

/// to + m v for symmetric 3 x 3 matrices that lie kSliceNodes apart: xx, xy, xz, yy, yz, zz.
inline Vector MulAddSymmetric(const float* m, const Vector& v, const Vector& to) {
  const Lanes xx = Load(m), yy = Load(m + 3 * kSliceNodes), zz = Load(m + 5 * kSliceNodes);
  Lanes xy = Load(m + kSliceNodes), xz = Load(m + 2 * kSliceNodes), yz = Load(m + 4 * kSliceNodes);
  KeepInRegister(xy), KeepInRegister(xz), KeepInRegister(yz);
  return {to.x + ((xx * v.x + xy * v.y) + xz * v.z), to.y + ((xy * v.x + yy * v.y) + yz * v.z),
          to.z + ((xz * v.x + yz * v.y) + zz * v.z)};
}

/// Length of a spring's extent.
inline Lanes CalcLength(const Vector& along) {
  // A spring shorter than the root of this has no direction [m^2]; its force is then nought because its
  // extent is. Longer ones do not feel it.
  constexpr float kNoLength2 = 1e-30f;
  return Sqrt(AddSquaredNorm(along, All(kNoLength2)));
}

/// Secant stiffness of a spring of this length, k - k l / length: its force on the near node is that times
/// the extent.
inline Lanes CalcSecant(Lanes k, Lanes k_times_rest, Lanes length) {
  return k - k_times_rest / length;
}

/// Largest squared residual of the free nodes; NaN where one is not finite.
struct LargestResidual {
  Lanes largest = {}, poison = {};

  void Add(Lanes step_length, const Vector& force) {
    const Lanes is_free = step_length > 0.0f ? All(1.0f) : All(0.0f);
    const Lanes squared = AddSquaredNorm(is_free * force, Lanes{});
    largest = Larger(squared, largest);
    poison = poison + All(0.0f) * squared;
  }
  float Find() const {
    float found = 0, sum = 0;
    for (int lane = 0; lane < TROCAR_LANES; ++lane) {
      found = largest[lane] > found ? largest[lane] : found;
      sum += poison[lane];
    }
    return found + sum;
  }
};

}  // namespace
}  // namespace trocar::tissue
