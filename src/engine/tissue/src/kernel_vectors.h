// SPDX-License-Identifier: Apache-2.0
/// \file kernel_vectors.h  Sums and combinations of node vectors; see kernels.h. Included by kernels_*.cpp only.
#pragma once

#include "kernel_balance.h"

namespace trocar::tissue {
namespace {

/// Calls work(at) for the floats of the nodes, TROCAR_LANES at a time.
template <typename Work>
inline void ForEachLanes(std::uint32_t first, std::uint32_t last, const Work& work) {
  for (std::size_t at = std::size_t{4} * first; at < std::size_t{4} * last; at += TROCAR_LANES) work(at);
}

inline double SumLanes(const double (&sums)[kSliceNodes]) {
  double sum = 0;
  for (const double part : sums) sum += part;
  return sum;
}

/// Products are rounded to single precision, their sums are not.
double CalcDot(const Float4* a, const Float4* b, std::uint32_t first, std::uint32_t last) {
  const float* const left = &a->x;
  const float* const right = &b->x;
  constexpr std::uint32_t kParts = kSliceNodes / kDoubles;
  Doubles sums[kParts] = {};
  for (std::size_t at = std::size_t{4} * first; at < std::size_t{4} * last; at += kSliceNodes) {
    for (std::uint32_t part = 0; part < kParts; ++part) {
      const std::size_t here = at + part * kDoubles;
      HalfLanes x, y;
      __builtin_memcpy(&x, left + here, sizeof x);
      __builtin_memcpy(&y, right + here, sizeof y);
      sums[part] += __builtin_convertvector(x * y, Doubles);
    }
  }
  double parts[kSliceNodes];
  for (std::uint32_t part = 0; part < kParts; ++part) StoreDoubles(parts + part * kDoubles, sums[part]);
  return SumLanes(parts);
}

float FindLargest2(const Float4* v, std::uint32_t first, std::uint32_t last) {
  Lanes largest = {}, poison = {};
  for (std::uint32_t i = first; i < last; i += TROCAR_LANES) {
    const Lanes squared = AddSquaredNorm(LoadNodes(v + i), Lanes{});
    largest = Larger(squared, largest);
    poison = poison + All(0.0f) * squared;
  }
  float found = 0, sum = 0;
  for (int lane = 0; lane < TROCAR_LANES; ++lane) {
    found = largest[lane] > found ? largest[lane] : found;
    sum += poison[lane];
  }
  return found + sum;
}

void Advance(float alpha, const Float4* p, const Float4* q, Float4* step, Float4* r, std::uint32_t first,
             std::uint32_t last) {
  const Lanes by = All(alpha);
  ForEachLanes(first, last, [&](std::size_t at) {
    Store(&step->x + at, MulAdd(by, Load(&p->x + at), Load(&step->x + at)));
    Store(&r->x + at, MulAdd(-by, Load(&q->x + at), Load(&r->x + at)));
  });
}

void AddScaled(float factor, const Float4* v, Float4* to, std::uint32_t first, std::uint32_t last) {
  const Lanes by = All(factor);
  ForEachLanes(first, last,
               [&](std::size_t at) { Store(&to->x + at, MulAdd(by, Load(&v->x + at), Load(&to->x + at))); });
}

void ScaleAndAdd(float beta, const Float4* a, Float4* to, std::uint32_t first, std::uint32_t last) {
  const Lanes by = All(beta);
  ForEachLanes(first, last,
               [&](std::size_t at) { Store(&to->x + at, MulAdd(by, Load(&to->x + at), Load(&a->x + at))); });
}

}  // namespace
}  // namespace trocar::tissue
