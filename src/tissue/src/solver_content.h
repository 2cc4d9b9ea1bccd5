// SPDX-License-Identifier: Apache-2.0
/// \file solver_content.h  What the solvers share.
#pragma once

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>

#include <array>
#include <optional>
#include <vector>

#include "trocar/tissue/equilibrium.h"

namespace trocar::tissue {

/// Symmetric 3 x 3 matrix: xx, xy, xz, yy, yz, zz.
using Symmetric3 = std::array<double, 6>;

struct EquilibriumSolver::Content {
  const TissueModel* model = nullptr;
  int threads = 1;
  std::optional<tbb::global_control> more_workers;  // set when more threads are asked for than there are cores
  tbb::task_arena arena;

  // Chebyshev
  std::vector<Vec3> previous;              // (n) positions of the iteration before
  std::vector<Symmetric3> inverse_blocks;  // (n) inverse of the node's own stiffness
  std::vector<Vec3> contact_force;         // (n) zero where no contact acts
  std::vector<double> chunk_residual;      // largest of each chunk
  std::vector<double> chunk_scale;
  std::vector<std::uint8_t> chunk_is_cut_short;
};

SolveReport SolveRelaxationPaper(EquilibriumSolver::Content& content, const SolverSettings& settings,
                                 const TissueLoad& load, TissueState& state) noexcept;
SolveReport SolveChebyshevJacobiWang2015(EquilibriumSolver::Content& content, const SolverSettings& settings,
                                         const TissueLoad& load, TissueState& state) noexcept;

/// Nodes a task works on; fixed, so that results do not depend on the number of threads.
inline constexpr std::uint32_t kChunk = 256;

}  // namespace trocar::tissue
