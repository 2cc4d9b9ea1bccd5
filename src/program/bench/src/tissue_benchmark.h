// SPDX-License-Identifier: Apache-2.0
/// \file tissue_benchmark.h  The parts of the suite "tissue".
#pragma once

#include "trocar/bench/benchmark.h"
#include "trocar/tissue/equilibrium.h"

namespace trocar::bench {

/// A grid of the paper's size whose border is held, and what loads it.
struct GridCase {
  tissue::TissueModel model;
  tissue::TissueState start;               ///< flat
  std::vector<math::Vec3> external_force;  ///< (n) [N]

  tissue::TissueLoad Load() const { return {.external_force = external_force}; }
};

/// The problem: n x n nodes, unit spacing, one diagonal per cell, k = 1, border fixed, 0.001 on every node
/// and 0.5 on the centre node the other way, across the grid.
GridCase MakeGridCase(int n, double virtual_stiffness);

/// The paper's relaxation as scalar double code and nothing else: no residual, no checks. x_i <- x_i + alpha
/// R_i with alpha k = 0.1.
void RelaxAsPrinted(const GridCase& grid, int iterations, std::vector<math::Vec3>& position) noexcept;

/// Equilibrium to ten digits on the branch that `state` is on, checked by tissue::CalcResidual, which no
/// solver shares.
base::Result<tissue::TissueState> FindTruth(const std::string& name, const GridCase& grid,
                                            const tissue::TissueState& state);

/// Largest distance of a node between two states [m].
double CalcDistance(const tissue::TissueState& a, const tissue::TissueState& b);

base::Status RunIterationCases(const BenchmarkOptions& options, BenchmarkResult& result);
base::Status RunEquilibriumCases(const BenchmarkOptions& options, BenchmarkResult& result);
base::Status RunPatientCases(const BenchmarkOptions& options, BenchmarkResult& result);

}  // namespace trocar::bench
