// SPDX-License-Identifier: Apache-2.0
#include "trocar/tissue_cuda/gpu_solver.h"

#include <optional>
#include <utility>

#include "gpu_solve.h"
#include "trocar/base/assert.h"
#include "trocar/tissue/element_kinds.h"

namespace trocar::tissue_cuda {

namespace {

base::Error NotHookes() {
  return {base::ErrorCode::kGpuLayout,
          "the GPU's springs follow Hooke's law and are whole; cut, weakened and stiffening springs are "
          "solved on "
          "the processor"};
}

base::Error HasNoElements() {
  return {
      base::ErrorCode::kGpuLayout,
      "the GPU solves springs, strands and contacts of tools; other elements are solved on the processor"};
}

}  // namespace

struct GpuSolver::Content {
  std::size_t nodes = 0;
  std::unique_ptr<Gpu> gpu;
  std::unique_ptr<GpuSolve> solve;    // freed before the GPU is closed
  std::optional<base::Error> failed;  // a GPU that failed once is not asked again
};

GpuSolver::GpuSolver(std::unique_ptr<Content> content) : content_(std::move(content)) {}
GpuSolver::~GpuSolver() = default;
GpuSolver::GpuSolver(GpuSolver&&) noexcept = default;
GpuSolver& GpuSolver::operator=(GpuSolver&&) noexcept = default;

base::Result<GpuSolver> MakeGpuSolver(const tissue::TissueModel& model, const GpuOptions& options,
                                      const DriverSource& source) {
  for (const std::uint32_t law : model.spring_law) {
    if (model.laws[law].stiffening > 0.0) return NotHookes();
  }
  base::Result<std::unique_ptr<Gpu>> gpu = Gpu::Open(source);
  if (!gpu) return gpu.error();
  base::Result<std::unique_ptr<GpuSolve>> solve = options.layout == Layout::kTiled
                                                      ? MakeTiledSolve(**gpu, model, options)
                                                      : MakePaperSolve(**gpu, model, options);
  if (!solve) return solve.error();
  auto content = std::make_unique<GpuSolver::Content>();
  content->nodes = model.Size();
  content->gpu = std::move(gpu).value();
  content->solve = std::move(solve).value();
  return GpuSolver(std::move(content));
}

base::Result<GpuSolver> GpuSolver::Make(const tissue::TissueModel& model, const GpuOptions& options) {
  return MakeGpuSolver(model, options, BuiltInSource());
}

GpuSettings MakeGpuSettings(const tissue::SolverSettings& settings) noexcept {
  return {settings.max_iterations, settings.tolerance, settings.relaxation.alpha};
}

base::Result<tissue::SolveReport> GpuSolver::Solve(const GpuSettings& settings,
                                                   const tissue::TissueLoad& load, tissue::TissueState& state,
                                                   tissue::ConstraintSet* constraints) noexcept {
  TROCAR_ASSERT(state.position.size() == content_->nodes && state.condition.size() == content_->nodes);
  TROCAR_ASSERT(load.contacts.size() <= tissue::kMaxContacts && settings.max_iterations >= 1);
  if (content_->failed) return *content_->failed;
  for (const double factor : state.spring_factor) {
    if (factor != 1.0) return NotHookes();
  }
  if (tissue::HasElements(load)) return HasNoElements();
  if (base::Status status = content_->gpu->Enter(); !status) {
    content_->failed = status.error();
    return status.error();
  }
  base::Result<tissue::SolveReport> report = content_->solve->Run(settings, load, state, constraints);
  if (!report && report.error().code != base::ErrorCode::kGpuLayout) content_->failed = report.error();
  return report;
}

const GpuInformation& GpuSolver::Information() const noexcept {
  return content_->gpu->Information();
}

GpuTimes GpuSolver::LastTimes() const noexcept {
  const Gpu& gpu = *content_->gpu;
  return {gpu.SecondsBetween(kMarkFirstLaunch, kMarkLastLaunch), gpu.SecondsBetween(kMarkBegin, kMarkEnd)};
}

bool GpuSolver::IsResident() const noexcept {
  return content_->solve->IsResident();
}

}  // namespace trocar::tissue_cuda
