// SPDX-License-Identifier: Apache-2.0
/// \file lane_arithmetic.h  Sums of products of lanes, and what keeps a compiler from undoing the order of a loop that waits for
/// loads. As float_lanes.h: for files that are compiled once for each level of vector instructions.
#pragma once

#include "trocar/math/float_lanes.h"

namespace trocar::math {
namespace {

/// a b + c, rounded twice: what rounds once is not there on every processor.
inline Lanes MulAdd(Lanes a, Lanes b, Lanes c) {
  return a * b + c;
}

#if TROCAR_LANES == 16
#define TROCAR_LANE_INDICES(OFFSET)                                                                       \
  OFFSET, OFFSET + 1, OFFSET + 2, OFFSET + 3, OFFSET + 4, OFFSET + 5, OFFSET + 6, OFFSET + 7, OFFSET + 8, \
      OFFSET + 9, OFFSET + 10, OFFSET + 11, OFFSET + 12, OFFSET + 13, OFFSET + 14, OFFSET + 15
#elif TROCAR_LANES == 8
#define TROCAR_LANE_INDICES(OFFSET) \
  OFFSET, OFFSET + 1, OFFSET + 2, OFFSET + 3, OFFSET + 4, OFFSET + 5, OFFSET + 6, OFFSET + 7
#else
#define TROCAR_LANE_INDICES(OFFSET) OFFSET, OFFSET + 1, OFFSET + 2, OFFSET + 3
#endif

/// Lane i of the result is lane i - 1 of `v`; lane 0 is the last of `before`.
inline Lanes ShiftUp(Lanes before, Lanes v) {
  return __builtin_shufflevector(before, v, TROCAR_LANE_INDICES(TROCAR_LANES - 1));
}

/// Makes the compiler load once what it would take from memory at each use: the kernels wait for loads.
inline void KeepInRegister([[maybe_unused]] Lanes& v) {
#if TROCAR_LANES == 16
  __asm__("" : "+v"(v));
#elif defined(__SSE2__)
  __asm__("" : "+x"(v));
#endif
}

/// Whether the compiler leaves instructions about as they are written, and in registers what it is told to keep
/// there. clang 14 does not: it spills more than it saves.
#if defined(__clang__) || !defined(__SSE2__)
inline constexpr bool kKeepsOrder = false;
#else
inline constexpr bool kKeepsOrder = true;
#endif

inline void KeepInRegister(LaneVector& v) {
  if constexpr (kKeepsOrder) KeepInRegister(v.x), KeepInRegister(v.y), KeepInRegister(v.z);
}
/// Begins nothing that uses one of these before it has begun them all.
inline void BeginTogether([[maybe_unused]] Lanes& a, [[maybe_unused]] Lanes& b) {
#if !defined(__clang__) && TROCAR_LANES == 16
  __asm__("" : "+v"(a), "+v"(b));
#elif !defined(__clang__) && defined(__SSE2__)
  __asm__("" : "+x"(a), "+x"(b));
#endif
}
inline void BeginTogether([[maybe_unused]] Lanes& a, [[maybe_unused]] Lanes& b, [[maybe_unused]] Lanes& c) {
#if !defined(__clang__) && TROCAR_LANES == 16
  __asm__("" : "+v"(a), "+v"(b), "+v"(c));
#elif !defined(__clang__) && defined(__SSE2__)
  __asm__("" : "+x"(a), "+x"(b), "+x"(c));
#endif
}

inline LaneVector MulAdd(Lanes s, const LaneVector& v, const LaneVector& to) {
  return {MulAdd(s, v.x, to.x), MulAdd(s, v.y, to.y), MulAdd(s, v.z, to.z)};
}
/// |v|^2 + to
inline Lanes AddSquaredNorm(const LaneVector& v, Lanes to) {
  return MulAdd(v.z, v.z, MulAdd(v.y, v.y, MulAdd(v.x, v.x, to)));
}

}  // namespace
}  // namespace trocar::math
