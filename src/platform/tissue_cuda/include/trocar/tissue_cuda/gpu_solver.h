// SPDX-License-Identifier: Apache-2.0
/// \file gpu_solver.h  The tissue model's equilibrium on an NVIDIA GPU: the paper's four memory layouts and
/// ours.
/// Source: "General algorithms for laparoscopic surgical simulators", section 3.2.4.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "trocar/base/result.h"
#include "trocar/tissue/equilibrium.h"

namespace trocar::tissue_cuda {

/// Where the mesh lies in the GPU's memory.
enum class Layout {
  kPaperGlobal,           ///< a point's fields behind one another, in global memory
  kPaperCoalesced,        ///< each field of all points together
  kPaperShared,           ///< structured meshes: neighbours from a tile in shared memory
  kPaperSharedCoalesced,  ///< both
  kTiled                  ///< ours: any mesh, one launch a solve
};
/// "global", "coalesced", "shared", "shared-coalesced", "tiled"
std::string_view LayoutName(Layout layout) noexcept;
/// All of them, in the order above.
std::span<const Layout> AllLayouts() noexcept;

enum class Precision {
  kSingle,
  kDouble  ///< for checking, and for systems that single precision cannot resolve
};
/// "single", "double"
std::string_view PrecisionName(Precision precision) noexcept;

struct GpuOptions {
  Layout layout = Layout::kTiled;
  Precision precision = Precision::kSingle;
  bool forbid_resident = false;  ///< kTiled: stream from global memory even where all tiles would fit at once
};

/// Bounds of a solve on the GPU. There is one method for each layout, so that there is none to choose.
struct GpuSettings {
  int max_iterations = 40;  ///< per solve, >= 1
  double tolerance =
      1e-4;          ///< ends where the largest residual is below this fraction of the largest force [-]
  double alpha = 0;  ///< step of the paper's layouts [m/N]; 0 takes half of the stability bound
};
/// The part of a simulation's settings that the GPU uses.
GpuSettings MakeGpuSettings(const tissue::SolverSettings& settings) noexcept;

/// The GPU that would be used.
struct GpuInformation {
  std::string name;
  int compute_capability = 0;  ///< 10 major + minor, such as 90
  int driver_version = 0;      ///< CUDA version of the driver, 1000 major + 10 minor
  int multiprocessors = 0;
  std::size_t memory_bytes = 0;
  double memory_bandwidth = 0;  ///< by the clock and width that the driver names [B/s]; 0 where it names none
};

/// Looks for an NVIDIA GPU that this build can use.
/// \return kGpuMissing (no driver, no GPU, or a build without GPU code), kGpuTooOld, kGpuFailed
base::Result<GpuInformation> FindGpu();

/// Time of one solve by the GPU's clock [s].
struct GpuTimes {
  double kernels = 0;  ///< from the first launch to the end of the last
  double whole = 0;    ///< with the copies to and fro
};

/// Solver of one model on the GPU.
class GpuSolver {
 public:
  /// Copies the model to the GPU.
  ///
  /// \param model  must outlive the solver
  /// \return the errors of FindGpu, kGpuMemory, or kGpuLayout when the layout cannot hold the model,
  /// as none holds springs that stiffen
  static base::Result<GpuSolver> Make(const tissue::TissueModel& model, const GpuOptions& options = {});
  ~GpuSolver();
  GpuSolver(GpuSolver&&) noexcept;
  GpuSolver& operator=(GpuSolver&&) noexcept;

  /// As tissue::EquilibriumSolver::Solve. kTiled takes the steps of the Chebyshev iteration, the paper's
  /// layouts those of the relaxation with all nodes moving at once. With a constraints, positions travel to the host
  /// and back at each call of it.
  ///
  /// \return kGpuFailed after an error of the GPU or its driver, kGpuLayout for a load or a constraints that the
  /// layout cannot serve, and for springs that are cut or weakened; the state is then as it was before the call
  /// \note Allocates and throws nothing of ours unless it fails.
  base::Result<tissue::SolveReport> Solve(const GpuSettings& settings, const tissue::TissueLoad& load,
                                          tissue::TissueState& state,
                                          tissue::ConstraintSet* constraints = nullptr) noexcept;

  const GpuInformation& Information() const noexcept;
  GpuTimes LastTimes() const noexcept;
  /// kTiled: whether all tiles stay on the GPU's multiprocessors.
  bool IsResident() const noexcept;

  struct Content;
  explicit GpuSolver(std::unique_ptr<Content> content);

 private:
  std::unique_ptr<Content> content_;
};

}  // namespace trocar::tissue_cuda
