// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <utility>
#include <vector>

#include "bind_arguments.h"
#include "gpu_memory.h"
#include "gpu_solve.h"
#include "kernel_names.h"

namespace trocar::tissue_cuda {
namespace {

using base::Status;

/// Steps between two looks at the residual, each of which waits for the GPU.
constexpr int kStepsBetweenLooks = 50;

/// The paper's layouts: one launch a step.
template <typename Real>
class PaperSolve final : public GpuSolve {
 public:
  PaperSolve(Gpu& gpu, const tissue::TissueModel& model, PaperArrays<Real> arrays)
      : gpu_(&gpu), model_(&model), arrays_(std::move(arrays)), memory_(gpu) {}

  Status Start() {
    args_ = BindPaperArrays(arrays_, memory_);
    tissue::TissueState rest = tissue::MakeRestState(*model_);
    FillPoints(arrays_, *model_, rest, {}, positions_, forces_);
    for (auto& buffer : buffers_) buffer = memory_.template Array<Real>("positions", positions_.size());
    external_force_ = memory_.template Array<Real>("external_force",
                                                   static_cast<std::size_t>(arrays_.pitch) * kForceFields);
    largest_ = memory_.template Array<Key>("largest", 2);
    if (!memory_.GetStatus()) return memory_.GetStatus();
    const base::Result<CudaFunction> kernel =
        gpu_->FindKernel(KernelName(arrays_.layout, sizeof(Real) == 4, false));
    if (!kernel) return kernel.error();
    kernel_ = *kernel;
    shape_.blocks = CountPaperBlocks(arrays_);
    shape_.threads = kPaperThreads;
    shape_.shared_bytes = CountSharedBytes();
    return {};
  }

  base::Result<tissue::SolveReport> Run(const GpuSettings& settings, const tissue::TissueLoad& load,
                                        tissue::TissueState& state,
                                        tissue::ConstraintSet* constraints) override {
    if (!load.contacts.empty() || constraints != nullptr) {
      return base::Error{base::ErrorCode::kGpuLayout,
                         "the layout \"" + std::string(LayoutName(arrays_.layout)) +
                             "\" has no place for contacts and constraints, which the paper does not have; "
                             "use the layout \"tiled\""};
    }
    FillPoints(arrays_, *model_, state, load, positions_, forces_);
    // half of the bound damps every mode of the linear system without oscillation
    SetPaperLoad(load, settings.alpha > 0.0 ? settings.alpha : 0.5 * CalcLargestStep(load), args_);
    args_.external_force = forces_.empty() ? nullptr : external_force_;
    Status status = gpu_->Mark(kMarkBegin);
    if (status) status = Upload(buffers_[0], positions_);
    if (status) status = Upload(external_force_, forces_);
    if (status) status = gpu_->Mark(kMarkFirstLaunch);
    tissue::SolveReport report;
    while (status && report.iterations < settings.max_iterations && !report.converged) {
      status = RunSteps(std::min(kStepsBetweenLooks, settings.max_iterations - report.iterations), report);
      report.converged = report.residual <= settings.tolerance;
    }
    if (status) status = Download(positions_, buffers_[report.iterations % 2]);
    if (status) status = gpu_->Mark(kMarkEnd);
    if (status) status = gpu_->Finish();
    if (!status) return status.error();
    ReadPoints(arrays_, positions_, state);
    return report;
  }

 private:
  using Args = PaperArgs<Real, RawMemory>;

  std::uint32_t CountSharedBytes() const {
    SharedLayout layout(nullptr);
    if (IsShared(arrays_.layout)) (void)PaperShared<Real, RawMemory, false>::MakeShared(layout, args_);
    return static_cast<std::uint32_t>(layout.Bytes());
  }

  /// Largest stable alpha when all nodes move at once, by Gershgorin's theorem, as tissue::CalcLargestAlpha
  /// [m/N].
  double CalcLargestStep(const tissue::TissueLoad& load) const {
    double bound = 0;
    for (std::size_t i = 0; i < model_->Size(); ++i) {
      double links = 0;
      for (auto h = model_->spring_starts[i]; h < model_->spring_starts[i + 1]; ++h) {
        links += model_->half_springs[h].stiffness;
      }
      bound =
          std::max(bound, 2.0 * load.stiffness_scale * links + load.shape_scale * model_->shape_stiffness[i]);
    }
    return bound > 0.0 ? 2.0 / bound : 0.0;
  }

  Status Upload(Real* to, const std::vector<Real>& from) {
    return gpu_->CopyToGpu(reinterpret_cast<CudaAddress>(to), from.data(), from.size() * sizeof(Real));
  }
  Status Download(std::vector<Real>& to, const Real* from) {
    return gpu_->CopyFromGpu(to.data(), reinterpret_cast<CudaAddress>(from), to.size() * sizeof(Real));
  }

  /// Some steps; the last of them finds the residual.
  Status RunSteps(int steps, tissue::SolveReport& report) {
    const auto largest = reinterpret_cast<CudaAddress>(largest_);
    if (Status status = gpu_->Clear(largest, 2 * sizeof(Key)); !status) return status;
    for (int step = 0; step < steps; ++step) {
      args_.positions = buffers_[report.iterations % 2];
      args_.next_positions = buffers_[1 - report.iterations % 2];
      args_.largest = step == steps - 1 ? largest_ : nullptr;
      unsigned* const no_barrier = nullptr;
      void* arguments[] = {&args_, const_cast<unsigned**>(&no_barrier)};
      if (Status status = gpu_->Launch(kernel_, shape_, arguments); !status) return status;
      ++report.iterations;
    }
    Key found[2] = {};
    Status status = gpu_->Mark(kMarkLastLaunch);
    if (status) status = gpu_->CopyFromGpu(found, largest, sizeof found);
    if (status) status = gpu_->Finish();
    if (!status) return status;
    report.force_scale = std::sqrt(static_cast<double>(FromKey<Real>(found[1])));
    const double residual = std::sqrt(static_cast<double>(FromKey<Real>(found[0])));
    report.residual = report.force_scale > 0.0 ? residual / report.force_scale : 0.0;
    return {};
  }

  Gpu* gpu_;
  const tissue::TissueModel* model_;
  PaperArrays<Real> arrays_;
  GpuMemory memory_;
  Args args_;
  std::vector<Real> positions_, forces_;
  Real* buffers_[2] = {};
  Real* external_force_ = nullptr;
  Key* largest_ = nullptr;
  CudaFunction kernel_ = nullptr;
  LaunchShape shape_;
};

template <typename Real>
base::Result<std::unique_ptr<GpuSolve>> Make(Gpu& gpu, const tissue::TissueModel& model,
                                             const GpuOptions& options) {
  base::Result<PaperArrays<Real>> arrays = MakePaperArrays<Real>(model, options.layout);
  if (!arrays) return arrays.error();
  auto solve = std::make_unique<PaperSolve<Real>>(gpu, model, std::move(arrays).value());
  if (Status status = solve->Start(); !status) return status.error();
  return std::unique_ptr<GpuSolve>(std::move(solve));
}

}  // namespace

base::Result<std::unique_ptr<GpuSolve>> MakePaperSolve(Gpu& gpu, const tissue::TissueModel& model,
                                                       const GpuOptions& options) {
  return options.precision == Precision::kSingle ? Make<float>(gpu, model, options)
                                                 : Make<double>(gpu, model, options);
}

}  // namespace trocar::tissue_cuda
