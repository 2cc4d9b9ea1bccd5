// SPDX-License-Identifier: Apache-2.0
/// \file gpu_or_cpu_solver.h  The equilibrium solver of a simulation that may use the GPU: it asks the GPU
/// where there is one, and after the GPU's first failure goes on with the processor, in the same call.
#pragma once

#include <optional>

#include "trocar/tissue_cuda/gpu_solver.h"

namespace trocar::tissue_cuda {

/// Has the face of tissue::EquilibriumSolver.
class GpuOrCpuSolver {
 public:
  /// \param model       must outlive the solver
  /// \param threads     of the processor, >= 1
  /// \param gpu         options of the GPU, or nothing: the processor alone
  GpuOrCpuSolver(const tissue::TissueModel& model, int threads, const std::optional<GpuOptions>& gpu);
  /// With a solver that the GPU was already opened for, or why it could not be.
  GpuOrCpuSolver(const tissue::TissueModel& model, int threads, core::Result<GpuSolver> gpu);

  /// As tissue::EquilibriumSolver::Solve. The Chebyshev iteration runs on the GPU, other solvers on the
  /// processor. When the GPU fails, the processor solves from the positions that the call began with. \note
  /// Allocates nothing, but once for the text of a failure.
  tissue::SolveReport Solve(const tissue::SolverSettings& settings, const tissue::TissueLoad& load,
                            tissue::TissueState& state) noexcept;

  /// As tissue::EquilibriumSolver::CalcReaction [N].
  math::Vec3 CalcReaction(const tissue::TissueLoad& load, const tissue::TissueState& state,
                          std::span<const std::uint32_t> nodes) const noexcept;

  /// The GPU in use; none once it failed.
  const GpuInformation* Gpu() const noexcept { return gpu_ ? &gpu_->Information() : nullptr; }
  /// Why the GPU is not used although it was asked for: one line for the person who runs the program.
  const std::optional<core::Error>& GpuError() const noexcept { return gpu_error_; }

 private:
  tissue::EquilibriumSolver cpu_;
  std::optional<GpuSolver> gpu_;
  std::optional<core::Error> gpu_error_;
};

}  // namespace trocar::tissue_cuda
