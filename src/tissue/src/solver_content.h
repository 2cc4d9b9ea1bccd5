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

/// Nodes that one pass of the spring kernel works on side by side.
inline constexpr std::uint32_t kLanes = 8;

/// Half-springs in slices of kLanes nodes, each padded to its longest row (sliced ELLPACK): what the lanes read at one
/// step lies together. A padded entry points at its own node with no stiffness.
/// Source: Monakov, Lokhmotov, Avetisyan, "Automatically tuning sparse matrix-vector multiplication for GPU
/// architectures", HiPEAC 2010.
struct SlicedSprings {
  std::vector<std::uint32_t> starts;         // (slices + 1) in steps
  std::vector<std::uint32_t> others;         // (steps * kLanes)
  std::vector<double> stiffness;             // (steps * kLanes) k
  std::vector<double> stiffness_times_rest;  // (steps * kLanes) k l
};
SlicedSprings MakeSlicedSprings(const TissueModel& model);

/// Forces of the springs on the nodes of one slice.
struct SliceForce {
  double x[kLanes], y[kLanes], z[kLanes];
  double largest_squared[kLanes];  ///< tension of the strongest spring, squared
};
/// Chosen at run time for the machine; every version gives the same bits, because none contracts or reorders.
void GatherSlice(const SlicedSprings& springs, const Vec3* position, std::uint32_t node_count, std::uint32_t slice,
                 SliceForce& force) noexcept;

struct EquilibriumSolver::Content {
  const TissueModel* model = nullptr;
  int threads = 1;
  std::optional<tbb::global_control> more_workers;  // set when more threads are asked for than there are cores
  tbb::task_arena arena;

  // Chebyshev
  SlicedSprings springs;
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
