// SPDX-License-Identifier: Apache-2.0
/// \file gpu_or_cpu_solver.h  The equilibrium solver of a simulation that may use the GPU: it asks the GPU
/// where there is one, and after the GPU's first failure goes on with the processor, in the same call.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string_view>

#include "trocar/tissue_cuda/gpu_solver.h"

namespace trocar::tissue_cuda {

class GpuOrCpuSolver final : public tissue::DeviceSolver {
 public:
  /// \param model    must outlive the solver
  /// \param threads  of the processor
  /// \param gpu      a solver of the same model, or why there is none
  GpuOrCpuSolver(const tissue::TissueModel& model, const base::Threads& threads, base::Result<GpuSolver> gpu);
  ~GpuOrCpuSolver() override;

  /// The Chebyshev iteration runs on the GPU, also where the choice is left open (kAdaptive); other solvers
  /// run on the processor, and so does a state whose springs are cut or weakened. When the GPU fails, the processor solves from the positions that the call began
  /// with.
  /// \note Allocates nothing, but once for the text of a failure.
  tissue::SolveReport Solve(const tissue::SolverSettings& settings, const tissue::TissueLoad& load,
                            tissue::TissueState& state, tissue::ConstraintSet* constraints = nullptr,
                            std::span<const math::Vec3> extrapolation = {}) noexcept override;

  /// After a cut the processor goes on: the GPU's copy of the springs is of the whole tissue.
  void UpdateTopology(const tissue::TissueModel& model) override;

  /// The GPU in use; none once it failed, and after a cut.
  const GpuInformation* Gpu() const noexcept { return gpu_ ? &gpu_->Information() : nullptr; }
  /// Why the GPU is not used although it was asked for: one line for the person who runs the program.
  const std::optional<base::Error>& GpuError() const noexcept { return gpu_error_; }

  std::string_view DeviceName() const noexcept override {
    return gpu_ ? std::string_view(gpu_->Information().name) : std::string_view();
  }
  const base::Error* DeviceError() const noexcept override { return gpu_error_ ? &*gpu_error_ : nullptr; }

 private:
  std::optional<GpuSolver> gpu_;
  std::optional<base::Error> gpu_error_;
};

/// Of the first GPU; where there is none, the processor solves and DeviceError() says so.
std::unique_ptr<tissue::DeviceSolver> MakeGpuOrCpuSolver(const tissue::TissueModel& model,
                                                         const base::Threads& threads);

}  // namespace trocar::tissue_cuda
