// SPDX-License-Identifier: Apache-2.0
/// \file kernel_balance.h  Forces, energy and stiffness of springs in double precision; see kernels.h.
/// Included by kernels_*.cpp only.
///
/// Source: Hooke's law; stiffness of a spring of extent d u: (k - b) I + b u u^T with b = k l / d.
#pragma once

#include "kernel_lanes.h"

namespace trocar::tissue {
namespace {

constexpr std::uint32_t kDoubles = TROCAR_LANES / 2;
typedef double Doubles __attribute__((vector_size(4 * TROCAR_LANES)));
typedef float HalfLanes __attribute__((vector_size(2 * TROCAR_LANES)));

inline Doubles LoadDoubles(const double* from) {
  Doubles v;
  __builtin_memcpy(&v, from, sizeof v);
  return v;
}
inline void StoreDoubles(double* to, Doubles v) {
  __builtin_memcpy(to, &v, sizeof v);
}
inline Doubles LoadFloats(const float* from) {
  HalfLanes v;
  __builtin_memcpy(&v, from, sizeof v);
  return __builtin_convertvector(v, Doubles);
}
inline void StoreHalf(float* to, HalfLanes v) {
  __builtin_memcpy(to, &v, sizeof v);
}
inline void StoreFloats(float* to, Doubles v) {
  StoreHalf(to, __builtin_convertvector(v, HalfLanes));
}
inline HalfLanes ToFloats(Doubles v) {
  return __builtin_convertvector(v, HalfLanes);
}
inline Doubles ToDoubles(HalfLanes v) {
  return __builtin_convertvector(v, Doubles);
}
inline Doubles AllDoubles(double value) {
  return value - Doubles{};
}
inline Doubles Larger(Doubles a, Doubles b) {
  return a > b ? a : b;
}
inline Doubles Absolute(Doubles v) {
  return Larger(v, -v);
}

/// a b + c, rounded twice, as MulAdd of floats.
inline Doubles MulAdd(Doubles a, Doubles b, Doubles c) {
  return a * b + c;
}
inline Doubles Sqrt(Doubles v) {
#if TROCAR_LANES == 16
  return (Doubles)_mm512_sqrt_pd((__m512d)v);
#elif TROCAR_LANES == 8
  return (Doubles)_mm256_sqrt_pd((__m256d)v);
#elif defined(__SSE2__)
  return (Doubles)_mm_sqrt_pd((__m128d)v);
#else
  for (std::uint32_t lane = 0; lane < kDoubles; ++lane) v[lane] = __builtin_sqrt(v[lane]);
  return v;
#endif
}

inline HalfLanes Sqrt(HalfLanes v) {
#if TROCAR_LANES == 16
  return (HalfLanes)_mm256_sqrt_ps((__m256)v);
#elif TROCAR_LANES == 8
  return (HalfLanes)_mm_sqrt_ps((__m128)v);
#else
  for (std::uint32_t lane = 0; lane < kDoubles; ++lane) v[lane] = __builtin_sqrtf(v[lane]);
  return v;
#endif
}

struct DoubleVector {
  Doubles x, y, z;
};
inline DoubleVector operator-(const DoubleVector& a, const DoubleVector& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline DoubleVector MulAdd(Doubles s, const DoubleVector& v, const DoubleVector& to) {
  return {MulAdd(s, v.x, to.x), MulAdd(s, v.y, to.y), MulAdd(s, v.z, to.z)};
}
inline Doubles Dot(const DoubleVector& a, const DoubleVector& b) {
  return MulAdd(a.z, b.z, MulAdd(a.y, b.y, a.x * b.x));
}
inline DoubleVector LoadDoubleVector(const double* from) {
  return {LoadDoubles(from), LoadDoubles(from + kSliceNodes), LoadDoubles(from + 2 * kSliceNodes)};
}

/// kDoubles nodes: loads of a node each, then a transpose in registers.
template <typename At>
inline DoubleVector LoadNodes(const Double4* nodes, const At& at) {
#if TROCAR_LANES == 16
  const auto pair = [&](std::uint32_t a, std::uint32_t b) {
    return _mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_load_pd(&nodes[at(a)].x)),
                              _mm256_load_pd(&nodes[at(b)].x), 1);
  };
  const __m512d a = pair(0, 2), b = pair(1, 3), c = pair(4, 6), d = pair(5, 7);
  const __m512d ab = _mm512_unpacklo_pd(a, b), cd = _mm512_unpacklo_pd(c, d);
  const __m512d aby = _mm512_unpackhi_pd(a, b), cdy = _mm512_unpackhi_pd(c, d);
  return {(Doubles)_mm512_shuffle_f64x2(ab, cd, 0x88), (Doubles)_mm512_shuffle_f64x2(aby, cdy, 0x88),
          (Doubles)_mm512_shuffle_f64x2(ab, cd, 0xdd)};
#elif TROCAR_LANES == 8
  const auto pair = [&](std::uint32_t a, std::uint32_t b, int half) {
    return _mm256_insertf128_pd(_mm256_castpd128_pd256(_mm_load_pd(&nodes[at(a)].x + 2 * half)),
                                _mm_load_pd(&nodes[at(b)].x + 2 * half), 1);
  };
  const __m256d a = pair(0, 2, 0), b = pair(1, 3, 0);
  return {(Doubles)_mm256_unpacklo_pd(a, b), (Doubles)_mm256_unpackhi_pd(a, b),
          (Doubles)_mm256_unpacklo_pd(pair(0, 2, 1), pair(1, 3, 1))};
#else
  DoubleVector v;
  for (std::uint32_t lane = 0; lane < kDoubles; ++lane) {
    const Double4& node = nodes[at(lane)];
    v.x[lane] = node.x, v.y[lane] = node.y, v.z[lane] = node.z;
  }
  return v;
#endif
}

/// Symmetric 3 x 3 matrices.
struct DoubleSymmetric {
  Doubles xx, xy, xz, yy, yz, zz;
};
inline DoubleSymmetric LoadSymmetric(const float* m) {
  return {LoadFloats(m),
          LoadFloats(m + kSliceNodes),
          LoadFloats(m + 2 * kSliceNodes),
          LoadFloats(m + 3 * kSliceNodes),
          LoadFloats(m + 4 * kSliceNodes),
          LoadFloats(m + 5 * kSliceNodes)};
}
inline void StoreSymmetric(float* to, const DoubleSymmetric& m) {
  StoreFloats(to, m.xx), StoreFloats(to + kSliceNodes, m.xy), StoreFloats(to + 2 * kSliceNodes, m.xz);
  StoreFloats(to + 3 * kSliceNodes, m.yy), StoreFloats(to + 4 * kSliceNodes, m.yz);
  StoreFloats(to + 5 * kSliceNodes, m.zz);
}

/// Inverse of positive definite matrices; 0 where `is_free` is, and for a node that nothing holds.
inline DoubleSymmetric Invert(const DoubleSymmetric& m, Doubles is_free) {
  const Doubles c00 = m.yy * m.zz - m.yz * m.yz, c01 = m.xz * m.yz - m.xy * m.zz,
                c02 = m.xy * m.yz - m.xz * m.yy;
  const Doubles determinant = (m.xx * c00 + m.xy * c01) + m.xz * c02;
  const Doubles s = determinant > 0.0 ? is_free / determinant : AllDoubles(0.0);
  return {s * c00,
          s * c01,
          s * c02,
          s * (m.xx * m.zz - m.xz * m.xz),
          s * (m.xy * m.xz - m.xx * m.yz),
          s * (m.xx * m.yy - m.xy * m.xy)};
}

/// Sums of the lanes of a slice, whatever the width of a vector.
struct LaneSums {
  double energy[kSliceNodes] = {}, residual2[kSliceNodes] = {}, force[kSliceNodes] = {},
         distance2[kSliceNodes] = {}, poison[kSliceNodes] = {};
};
inline void AddTo(double* to, Doubles v) {
  StoreDoubles(to, LoadDoubles(to) + v);
}
inline void RaiseTo(double* to, Doubles v) {
  StoreDoubles(to, Larger(LoadDoubles(to), v));
}

template <bool kHasStiffness>
void CalcGroupBalance(const BalancePass& pass, std::uint32_t slice, std::uint32_t lane, LaneSums& sums) {
  const std::uint32_t i = slice * kSliceNodes + lane;
  const double* const node = pass.nodes + std::size_t{slice} * kBalanceValues * kSliceNodes + lane;
  const auto value = [node](BalanceValue which) { return LoadDoubles(node + which * kSliceNodes); };
  const DoubleVector here = LoadNodes(pass.position, [i](std::uint32_t at) { return i + at; });
  const Doubles scale = AllDoubles(pass.stiffness_scale), none = {};
  DoubleVector force = LoadDoubleVector(node + kOuterX * kSliceNodes);
  const DoubleVector offset = LoadDoubleVector(node) - here;
  const Doubles shape = value(kShape), distance2 = Dot(offset, offset);
  Doubles energy = MulAdd(AllDoubles(0.5) * shape, distance2, Dot(force, offset));
  Doubles largest = Larger(shape * Sqrt(distance2), value(kOuterSize));
  force = MulAdd(shape, offset, force);
  struct {
    HalfLanes xx = {}, xy = {}, xz = {}, yy = {}, yz = {}, zz = {};
  } block;  // of the springs
  Doubles stored = {};
  for (std::uint32_t step = pass.table.starts[slice]; step < pass.table.starts[slice + 1]; ++step) {
    const std::size_t entry = std::size_t{step} * kSliceNodes + lane;
    const std::uint32_t* const others = pass.table.others + entry;
    const DoubleVector along =
        LoadNodes(pass.position, [others](std::uint32_t at) { return others[at]; }) - here;
    const Doubles k = scale * LoadDoubles(pass.stiffness + entry),
                  rest = LoadDoubles(pass.rest_length + entry);
    const Doubles length2 = Dot(along, along), length = Sqrt(length2);
    const Doubles inverse = length2 > 0.0 ? AllDoubles(1.0) / length : none;
    const Doubles b = k * rest * inverse, across = k - b;
    force = MulAdd(across, along, force);
    const Doubles stretch = Absolute(length - rest), tension = k * stretch;
    largest = Larger(tension, largest);
    stored = MulAdd(tension, stretch, stored);
    if constexpr (kHasStiffness) {
      // b u u^T = v v^T; single precision is what is kept of it
      const HalfLanes root = Sqrt(ToFloats(b)), a = ToFloats(across);
      const HalfLanes x = root * ToFloats(inverse * along.x), y = root * ToFloats(inverse * along.y),
                      z = root * ToFloats(inverse * along.z);
      float* const link = pass.links + std::size_t{step} * kSpringLinkFloats * kSliceNodes + lane;
      StoreHalf(link, a), StoreHalf(link + kSliceNodes, x);
      StoreHalf(link + 2 * kSliceNodes, y), StoreHalf(link + 3 * kSliceNodes, z);
      const HalfLanes firm = a > 0.0f ? a : HalfLanes{};
      block.xx += firm + x * x, block.xy += x * y, block.xz += x * z;
      block.yy += firm + y * y, block.yz += y * z, block.zz += firm + z * z;
    }
  }
  energy = MulAdd(AllDoubles(0.25), stored, energy);
  const Doubles is_free = value(kFree), squared = Dot(force, force);
  if constexpr (kHasStiffness) {
    DoubleSymmetric own = LoadSymmetric(pass.diagonal_excess + std::size_t{slice} * 6 * kSliceNodes + lane);
    const Doubles strands = value(kStrands);
    own.xx += strands + ToDoubles(block.xx), own.xy += ToDoubles(block.xy), own.xz += ToDoubles(block.xz);
    own.yy += strands + ToDoubles(block.yy), own.yz += ToDoubles(block.yz),
        own.zz += strands + ToDoubles(block.zz);
    StoreSymmetric(pass.inverse + std::size_t{slice} * 6 * kSliceNodes + lane, Invert(own, is_free));
  }
  AddTo(sums.energy + lane, energy);
  AddTo(sums.poison + lane, none * squared);
  RaiseTo(sums.residual2 + lane, is_free * squared);
  RaiseTo(sums.force + lane, is_free * largest);
  RaiseTo(sums.distance2 + lane, distance2);
  const HalfLanes x = __builtin_convertvector(is_free * force.x, HalfLanes),
                  y = __builtin_convertvector(is_free * force.y, HalfLanes),
                  z = __builtin_convertvector(is_free * force.z, HalfLanes);
  for (std::uint32_t at = 0; at < kDoubles; ++at) pass.residual[i + at] = {x[at], y[at], z[at], 0.0f};
}

void CalcFollowerStiffness(const FollowerPass& pass, std::uint32_t first_slice, std::uint32_t last_slice) {
  for (std::uint32_t slice = first_slice; slice < last_slice; ++slice) {
    for (std::uint32_t lane = 0; lane < kSliceNodes; lane += kDoubles) {
      const Doubles factor = LoadDoubles(pass.factor + std::size_t{slice} * kSliceNodes + lane);
      for (std::uint32_t step = pass.table.starts[slice]; step < pass.table.starts[slice + 1]; ++step) {
        const std::uint32_t* const left = pass.left + std::size_t{step} * kSliceNodes + lane;
        const std::uint32_t* const right = pass.right + std::size_t{step} * kSliceNodes + lane;
        const DoubleVector across = LoadNodes(pass.position, [left](std::uint32_t at) { return left[at]; }) -
                                    LoadNodes(pass.position, [right](std::uint32_t at) { return right[at]; });
        float* const to = pass.follower + std::size_t{step} * 3 * kSliceNodes + lane;
        StoreFloats(to, factor * across.x), StoreFloats(to + kSliceNodes, factor * across.y);
        StoreFloats(to + 2 * kSliceNodes, factor * across.z);
      }
    }
  }
}

BalanceSums CalcBalance(const BalancePass& pass, std::uint32_t first_slice, std::uint32_t last_slice) {
  LaneSums lanes;
  for (std::uint32_t slice = first_slice; slice < last_slice; ++slice) {
    for (std::uint32_t lane = 0; lane < kSliceNodes; lane += kDoubles) {
      pass.has_stiffness ? CalcGroupBalance<true>(pass, slice, lane, lanes)
                         : CalcGroupBalance<false>(pass, slice, lane, lanes);
    }
  }
  BalanceSums sums;
  double poison = 0;
  for (std::uint32_t lane = 0; lane < kSliceNodes; ++lane) {
    sums.energy += lanes.energy[lane];
    poison += lanes.poison[lane];
    sums.residual2 = lanes.residual2[lane] > sums.residual2 ? lanes.residual2[lane] : sums.residual2;
    sums.force = lanes.force[lane] > sums.force ? lanes.force[lane] : sums.force;
    sums.distance2 = lanes.distance2[lane] > sums.distance2 ? lanes.distance2[lane] : sums.distance2;
  }
  sums.is_finite = poison == 0.0;
  return sums;
}

void InvertBlocks(const LinkMatrix& m, float* inverse, std::uint32_t first_slice, std::uint32_t last_slice) {
  for (std::uint32_t slice = first_slice; slice < last_slice; ++slice) {
    for (std::uint32_t lane = 0; lane < kSliceNodes; lane += kDoubles) {
      const std::size_t at = std::size_t{slice} * 6 * kSliceNodes + lane;
      DoubleSymmetric block = LoadSymmetric(m.diagonal_excess + at);
      for (std::uint32_t step = m.table.starts[slice]; step < m.table.starts[slice + 1]; ++step) {
        const DoubleSymmetric link =
            LoadSymmetric(m.links + std::size_t{step} * kBlockFloats * kSliceNodes + lane);
        block.xx += link.xx, block.xy += link.xy, block.xz += link.xz;
        block.yy += link.yy, block.yz += link.yz, block.zz += link.zz;
      }
      const Doubles is_free = LoadFloats(m.is_free + std::size_t{slice} * kSliceNodes + lane);
      StoreSymmetric(inverse + at, Invert(block, is_free));
    }
  }
}

}  // namespace
}  // namespace trocar::tissue
