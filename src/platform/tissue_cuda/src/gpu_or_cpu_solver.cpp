// SPDX-License-Identifier: Apache-2.0
#include "trocar/tissue_cuda/gpu_or_cpu_solver.h"

#include <algorithm>
#include <utility>

#include "trocar/tissue/element_kinds.h"

namespace trocar::tissue_cuda {
namespace {

/// The GPU's own solver, by its name or where the choice is left open.
bool RunsOnGpu(tissue::SolverKind kind) noexcept {
  return kind == tissue::SolverKind::kChebyshevJacobi2015 || kind == tissue::SolverKind::kAdaptive;
}

/// The GPU's copy of the springs is Hooke's and whole.
bool HasPlainSprings(const tissue::TissueState& state) noexcept {
  return std::all_of(state.spring_factor.begin(), state.spring_factor.end(),
                     [](double factor) { return factor == 1.0; });
}

}  // namespace

GpuOrCpuSolver::GpuOrCpuSolver(const tissue::TissueModel& model, const base::Threads& threads,
                               base::Result<GpuSolver> gpu)
    : DeviceSolver(model, tissue::SolverOptions{.threads = threads}) {
  if (gpu) {
    gpu_ = std::move(gpu).value();
  } else {
    gpu_error_ = gpu.error();
  }
}

GpuOrCpuSolver::~GpuOrCpuSolver() = default;

void GpuOrCpuSolver::UpdateTopology(const tissue::TissueModel& model) {
  gpu_.reset();
  EquilibriumSolver::UpdateTopology(model);
}

tissue::SolveReport GpuOrCpuSolver::Solve(const tissue::SolverSettings& settings,
                                          const tissue::TissueLoad& load, tissue::TissueState& state,
                                          tissue::ConstraintSet* constraints,
                                          std::span<const math::Vec3> extrapolation) noexcept {
  if (gpu_ && RunsOnGpu(settings.kind) && HasPlainSprings(state) && !tissue::HasElements(load)) {
    const base::Result<tissue::SolveReport> report =
        gpu_->Solve(MakeGpuSettings(settings), load, state, constraints);
    if (report) return *report;
    gpu_error_ = report.error();
    gpu_.reset();
  }
  return EquilibriumSolver::Solve(settings, load, state, constraints, extrapolation);
}

std::unique_ptr<tissue::DeviceSolver> MakeGpuOrCpuSolver(const tissue::TissueModel& model,
                                                         const base::Threads& threads) {
  return std::make_unique<GpuOrCpuSolver>(model, threads, GpuSolver::Make(model));
}

}  // namespace trocar::tissue_cuda
