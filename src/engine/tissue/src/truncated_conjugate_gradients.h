// SPDX-License-Identifier: Apache-2.0
/// \file truncated_conjugate_gradients.h  Conjugate gradients for one Newton step, within a range.
///
/// Source: Steihaug, "The conjugate gradient method and trust regions in large scale optimization", SIAM J. Numer.
/// Anal. 20, 1983.
#pragma once

#include <algorithm>
#include <cmath>

#include "node_vectors.h"
#include "trocar/math/smallest_ritz.h"

namespace trocar::tissue {

/// r . z, of single precision, ends the iterations where it has fallen to this part of its start [-]: from a state at
/// rest the tolerance is zero, and what follows is rounding.
inline constexpr double kLinearRounding = 1e-12;

/// Vectors of a solve, all of one length, (padded).
struct LinearVectors {
  math::AlignedVector<Float4>&step, &r, &z, &p, &q;
};
struct TruncatedReport {
  int iterations = 0;
  bool met_negative_curvature = false;
  bool reached_radius = false;
  double smallest_ritz = INFINITY;  ///< see math::SmallestRitz
};

/// Solves K step = r.
///
/// \param v  r, and z = P r; the iterations leave in r what remains
/// \param radius        longest move of a node [m]
/// \param multiply      q = K p
/// \param precondition  z = P r; may change r by what P leaves out; returns r . z and the length of the longest of z
/// \param is_done       bool(longest of z [m], smallest Ritz value so far [-])
/// \note Real-time safe if what it calls is.
template <typename Multiply, typename Precondition, typename IsDone>
TruncatedReport SolveTruncated(const Kernels& kernels, Workers& workers, int max_iterations, double radius,
                               const LinearVectors& v, const Multiply& multiply,
                               const Precondition& precondition, const IsDone& is_done) noexcept {
  TruncatedReport report;
  const std::size_t n = v.step.size();
  std::fill(v.step.begin(), v.step.end(), Float4{});
  std::copy(v.z.begin(), v.z.end(), v.p.begin());
  double reached = 0;  // bound of the longest move so far
  double beta = 0;
  math::SmallestRitz ritz;
  double rz = CalcDot(kernels, workers, v.r, v.z);
  const double rounding = kLinearRounding * rz;
  while (report.iterations < max_iterations && rz > rounding) {
    multiply();
    const auto [pq, longest] = CalcDotAndLongest(kernels, workers, v.q, v.p);
    report.met_negative_curvature = !(pq > 0.0);
    if (pq > 0.0) ritz.Add(rz / pq, beta);
    report.smallest_ritz = ritz.Value();
    // along a direction of negative curvature the energy only falls: as far as the range reaches
    double length = report.met_negative_curvature ? INFINITY : rz / pq;
    report.reached_radius = reached + length * longest > radius;
    if (report.reached_radius) length = math::Max(0.0, radius - reached) / longest;
    reached += length * longest;
    const auto alpha = static_cast<float>(length);
    ForEachNodeChunk(workers, n, [&](std::uint32_t first, std::uint32_t last, std::uint32_t) {
      kernels.vectors.advance(alpha, v.p.data(), v.q.data(), v.step.data(), v.r.data(), first, last);
    });
    ++report.iterations;
    if (report.reached_radius) break;
    const auto [next, left] = precondition();
    if (is_done(left, ritz.Value())) break;
    beta = next / rz;
    rz = next;
    ForEachNodeChunk(workers, n, [&](std::uint32_t first, std::uint32_t last, std::uint32_t) {
      kernels.vectors.scale_and_add(static_cast<float>(beta), v.z.data(), v.p.data(), first, last);
    });
  }
  return report;
}

}  // namespace trocar::tissue
