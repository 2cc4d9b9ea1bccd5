// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "bind_arguments.h"
#include "gpu_memory.h"
#include "gpu_solve.h"
#include "kernel_names.h"
#include "kernels/tiled_chebyshev.h"

namespace trocar::tissue_cuda {
namespace {

using base::Status;
using tissue::NodeCondition;

static_assert(sizeof(Triple<double>) == sizeof(math::Vec3) && alignof(Triple<double>) == alignof(math::Vec3));

/// Our layout: one launch a solve.
template <typename Real>
class TiledSolve final : public GpuSolve {
 public:
  TiledSolve(Gpu& gpu, const tissue::TissueModel& model, TiledArrays<Real> arrays)
      : gpu_(&gpu), model_(&model), renumbered_(std::move(arrays.renumbered)), memory_(gpu) {
    args_ = BindTiledArrays(arrays, memory_);
  }

  Status Start(const GpuOptions& options) {
    Reserve();
    if (!memory_.GetStatus()) return memory_.GetStatus();
    return ChooseKernel(options.forbid_resident);
  }

  base::Result<tissue::SolveReport> Run(const GpuSettings& settings, const tissue::TissueLoad& load,
                                        tissue::TissueState& state,
                                        tissue::ConstraintSet* constraints) override {
    SetTiledLoad(settings, load, args_);
    if (constraints == nullptr) {
      args_.before_positions = nullptr;
      args_.is_resumed = false;
      if (const Status status = Launch(load, state); !status) return status.error();
      TakePositions(host_positions_, state.position);
      return MakeReport();
    }
    // to the constraints and back: the state may already be changed when the GPU fails
    start_ = state.position;
    args_.before_positions = before_positions_;
    args_.is_resumed = false;
    for (int done = 0;; args_.is_resumed = true) {
      args_.settings.pause_at =
          static_cast<std::uint32_t>((done / constraints->Interval() + 1) * constraints->Interval());
      if (const Status status = Launch(load, state); !status) {
        state.position = start_;
        return status.error();
      }
      TakePositions(host_positions_, state.position);
      TakePositions(host_before_, before_);
      const tissue::SolveReport report = MakeReport();
      done = report.iterations;
      if (!report.converged && done % constraints->Interval() == 0) {
        constraints->Project(state, before_);
        PutPositions(before_, host_before_);
      }
      if (report.converged || done >= settings.max_iterations || std::isnan(report.residual)) return report;
    }
  }

  bool IsResident() const noexcept override { return is_resident_; }

 private:
  using Args = TiledArgs<Real, RawMemory>;

  /// One launch, with what goes up before it and comes down behind it.
  Status Launch(const tissue::TissueLoad& load, const tissue::TissueState& state) {
    const std::size_t n = model_->Size();
    Status status = args_.is_resumed ? Status() : gpu_->Mark(kMarkBegin);
    if (status) status = Upload(load, state);
    if (status) status = gpu_->Clear(reinterpret_cast<CudaAddress>(arrived_), sizeof *arrived_);
    if (status && !args_.is_resumed) status = gpu_->Mark(kMarkFirstLaunch);
    void* arguments[] = {&args_, &arrived_};
    if (status) status = gpu_->Launch(kernel_, shape_, arguments);
    if (status) status = gpu_->Mark(kMarkLastLaunch);
    if (status) status = Download(host_positions_, args_.positions, n);
    if (status && args_.before_positions != nullptr)
      status = Download(host_before_, args_.before_positions, n);
    if (status) status = Download(host_report_, args_.report, 1);
    if (status) status = gpu_->Mark(kMarkEnd);
    if (status) status = gpu_->Finish();
    return status;
  }

  static void TakePositions(const Triple<double>* from, std::vector<math::Vec3>& to) {
    std::memcpy(static_cast<void*>(to.data()), from, to.size() * sizeof(math::Vec3));
  }
  static void PutPositions(std::span<const math::Vec3> from, Triple<double>* to) {
    std::memcpy(static_cast<void*>(to), from.data(), from.size() * sizeof(math::Vec3));
  }

  tissue::SolveReport MakeReport() const {
    tissue::SolveReport report;
    report.iterations = static_cast<int>(host_report_->iterations);
    report.residual = host_report_->residual;
    report.force_scale = host_report_->force_scale;
    report.converged = host_report_->converged != 0;
    report.restarts = static_cast<int>(host_report_->restarts);
    return report;
  }

  /// For everything that a solve brings, so that no solve allocates.
  void Reserve() {
    const std::size_t n = model_->Size();
    constexpr std::size_t kMaxTouched = 3 * tissue::kMaxContacts;
    args_.positions = memory_.Array<Triple<double>>("positions", n);
    args_.prescribed = memory_.Array<std::uint8_t>("prescribed", n);
    external_force_ = memory_.Array<Triple<double>>("external_force", n);
    before_positions_ = memory_.Array<Triple<double>>("before_positions", n);
    args_.intact = memory_.Array<std::uint8_t>("intact", model_->strand_count);
    args_.contacts = memory_.Array<ContactEntry>("contacts", tissue::kMaxContacts);
    args_.touched_nodes = memory_.Array<std::uint32_t>("touched_nodes", kMaxTouched);
    args_.touch_starts = memory_.Array<std::uint32_t>("touch_starts", kMaxTouched + 1);
    args_.touch_entries = memory_.Array<std::uint32_t>("touch_entries", kMaxTouched);
    arrived_ = memory_.Array<unsigned>("arrived", 1);
    host_positions_ = memory_.HostArray<Triple<double>>(n);
    host_prescribed_ = memory_.HostArray<std::uint8_t>(n);
    host_external_force_ = memory_.HostArray<Triple<double>>(n);
    host_before_ = memory_.HostArray<Triple<double>>(n);
    start_.resize(n);
    before_.resize(n);
    host_report_ = memory_.HostArray<TiledReport>(1);
    contacts_.contacts.reserve(tissue::kMaxContacts);
    contacts_.touched_nodes.reserve(kMaxTouched);
    contacts_.touch_starts.reserve(kMaxTouched + 1);
    contacts_.touch_entries.reserve(kMaxTouched);
  }

  template <typename Kernel>
  std::uint32_t CountSharedBytes() const {
    SharedLayout layout(nullptr);
    (void)Kernel::MakeShared(layout, args_);
    return static_cast<std::uint32_t>(layout.Bytes());
  }

  /// Resident where every tile finds a place at once.
  Status ChooseKernel(bool forbid_resident) {
    constexpr bool kIsSingle = sizeof(Real) == 4;
    shape_.threads = kTileNodes;
    shape_.is_cooperative = true;
    for (const bool is_resident : {true, false}) {
      if (is_resident && forbid_resident) continue;
      const base::Result<CudaFunction> kernel =
          gpu_->FindKernel(KernelName(Layout::kTiled, kIsSingle, is_resident));
      if (!kernel) return kernel.error();
      shape_.shared_bytes = is_resident ? CountSharedBytes<TiledResident<Real, RawMemory>>()
                                        : CountSharedBytes<TiledStreaming<Real, RawMemory>>();
      const base::Result<std::uint32_t> at_once =
          gpu_->CountResidentBlocks(*kernel, shape_.threads, shape_.shared_bytes);
      if (!at_once) return at_once.error();
      if (is_resident && *at_once < args_.mesh.tiles) continue;
      if (*at_once == 0) {
        return base::Error{base::ErrorCode::kGpuFailed, "the GPU takes no block of the solver's kernel"};
      }
      kernel_ = *kernel;
      is_resident_ = is_resident;
      shape_.blocks = std::min(*at_once, args_.mesh.tiles);
      return {};
    }
    return base::Error{base::ErrorCode::kGpuFailed, "the GPU takes no block of the solver's kernel"};
  }

  template <typename T>
  Status Copy(T* to, const T* from, std::size_t count) {
    return gpu_->CopyToGpu(reinterpret_cast<CudaAddress>(to), from, count * sizeof(T));
  }
  template <typename T>
  Status Download(T* to, const T* from, std::size_t count) {
    return gpu_->CopyFromGpu(to, reinterpret_cast<CudaAddress>(from), count * sizeof(T));
  }

  Status Upload(const tissue::TissueLoad& load, const tissue::TissueState& state) {
    const std::size_t n = model_->Size();
    PutPositions(state.position, host_positions_);
    for (std::size_t i = 0; i < n; ++i)
      host_prescribed_[i] = state.condition[i] == NodeCondition::kPrescribed;
    Status status = Copy(args_.positions, host_positions_, n);
    if (status) status = Copy(args_.prescribed, host_prescribed_, n);
    if (status && args_.is_resumed) status = Copy(before_positions_, host_before_, n);
    args_.external_force = load.external_force.empty() ? nullptr : external_force_;
    if (status && !load.external_force.empty()) {
      PutPositions(load.external_force, host_external_force_);
      status = Copy(external_force_, host_external_force_, n);
    }
    if (status) status = Copy(args_.intact, state.strand_is_intact.data(), state.strand_is_intact.size());
    FillContacts(renumbered_, *model_, load.contacts, contacts_);
    args_.touched = static_cast<std::uint32_t>(contacts_.touched_nodes.size());
    if (args_.touched == 0) return status;
    if (status) status = Copy(args_.contacts, contacts_.contacts.data(), contacts_.contacts.size());
    if (status)
      status = Copy(args_.touched_nodes, contacts_.touched_nodes.data(), contacts_.touched_nodes.size());
    if (status)
      status = Copy(args_.touch_starts, contacts_.touch_starts.data(), contacts_.touch_starts.size());
    if (status)
      status = Copy(args_.touch_entries, contacts_.touch_entries.data(), contacts_.touch_entries.size());
    return status;
  }

  Gpu* gpu_;
  const tissue::TissueModel* model_;
  std::vector<std::uint32_t> renumbered_;
  GpuMemory memory_;
  Args args_;
  Triple<double>*external_force_ = nullptr, *before_positions_ = nullptr;
  unsigned* arrived_ = nullptr;
  Triple<double>*host_positions_ = nullptr, *host_external_force_ = nullptr, *host_before_ = nullptr;
  std::uint8_t* host_prescribed_ = nullptr;
  TiledReport* host_report_ = nullptr;
  TiledContacts contacts_;
  std::vector<math::Vec3> start_, before_;  // of a solve with constraints
  CudaFunction kernel_ = nullptr;
  LaunchShape shape_;
  bool is_resident_ = false;
};

template <typename Real>
base::Result<std::unique_ptr<GpuSolve>> Make(Gpu& gpu, const tissue::TissueModel& model,
                                             const GpuOptions& options) {
  base::Result<TiledArrays<Real>> arrays = MakeTiledArrays<Real>(model);
  if (!arrays) return arrays.error();
  auto solve = std::make_unique<TiledSolve<Real>>(gpu, model, std::move(arrays).value());
  if (Status status = solve->Start(options); !status) return status.error();
  return std::unique_ptr<GpuSolve>(std::move(solve));
}

}  // namespace

base::Result<std::unique_ptr<GpuSolve>> MakeTiledSolve(Gpu& gpu, const tissue::TissueModel& model,
                                                       const GpuOptions& options) {
  return options.precision == Precision::kSingle ? Make<float>(gpu, model, options)
                                                 : Make<double>(gpu, model, options);
}

}  // namespace trocar::tissue_cuda
