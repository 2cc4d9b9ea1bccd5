// SPDX-License-Identifier: Apache-2.0
#include "trocar/tissue_cuda/gpu_or_cpu_solver.h"

#include <utility>

namespace trocar::tissue_cuda {

GpuOrCpuSolver::GpuOrCpuSolver(const tissue::TissueModel& model, int threads,
                               const std::optional<GpuOptions>& gpu)
    : cpu_(model, threads) {
  if (!gpu) return;
  core::Result<GpuSolver> solver = GpuSolver::Make(model, *gpu);
  if (solver) {
    gpu_ = std::move(solver).value();
  } else {
    gpu_error_ = solver.error();
  }
}

GpuOrCpuSolver::GpuOrCpuSolver(const tissue::TissueModel& model, int threads, core::Result<GpuSolver> gpu)
    : cpu_(model, threads) {
  if (gpu) {
    gpu_ = std::move(gpu).value();
  } else {
    gpu_error_ = gpu.error();
  }
}

tissue::SolveReport GpuOrCpuSolver::Solve(const tissue::SolverSettings& settings,
                                          const tissue::TissueLoad& load,
                                          tissue::TissueState& state) noexcept {
  if (gpu_ && settings.kind == tissue::SolverKind::kChebyshevJacobi2015) {
    const core::Result<tissue::SolveReport> report = gpu_->Solve(settings, load, state);
    if (report) return *report;
    gpu_error_ = report.error();
    gpu_.reset();
  }
  return cpu_.Solve(settings, load, state);
}

math::Vec3 GpuOrCpuSolver::CalcReaction(const tissue::TissueLoad& load, const tissue::TissueState& state,
                                        std::span<const std::uint32_t> nodes) const noexcept {
  return cpu_.CalcReaction(load, state, nodes);
}

}  // namespace trocar::tissue_cuda
