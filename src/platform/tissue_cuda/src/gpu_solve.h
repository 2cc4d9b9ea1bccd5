// SPDX-License-Identifier: Apache-2.0
/// \file gpu_solve.h  Implementation of GpuSolver: one class for the paper's layouts, one for ours.
#pragma once

#include <memory>

#include "driver.h"
#include "trocar/tissue_cuda/gpu_solver.h"

namespace trocar::tissue_cuda {

/// A model on the GPU in one layout. Chosen once per solver, called once per tick.
class GpuSolve {
 public:
  virtual ~GpuSolve() = default;
  /// \return an error, and the state's positions as they were
  virtual base::Result<tissue::SolveReport> Run(const GpuSettings& settings, const tissue::TissueLoad& load,
                                                tissue::TissueState& state,
                                                tissue::ConstraintSet* constraints) = 0;
  virtual bool IsResident() const noexcept { return false; }
};

base::Result<std::unique_ptr<GpuSolve>> MakePaperSolve(Gpu& gpu, const tissue::TissueModel& model,
                                                       const GpuOptions& options);
base::Result<std::unique_ptr<GpuSolve>> MakeTiledSolve(Gpu& gpu, const tissue::TissueModel& model,
                                                       const GpuOptions& options);

/// FindGpu and GpuSolver::Make with a driver and code of the caller's.
base::Result<GpuSolver> MakeGpuSolver(const tissue::TissueModel& model, const GpuOptions& options,
                                      const DriverSource& source);

// marks on the GPU's clock
inline constexpr int kMarkBegin = 0, kMarkFirstLaunch = 1, kMarkLastLaunch = 2, kMarkEnd = 3;

}  // namespace trocar::tissue_cuda
