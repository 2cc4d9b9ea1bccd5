// SPDX-License-Identifier: Apache-2.0
/// \file simulation.h  The tick: fixed, deterministic, staged and timed.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "trocar/core/result.h"
#include "trocar/haptics/local_patch.h"
#include "trocar/session/model_description.h"
#include "trocar/session/operation_result.h"
#include "trocar/session/scene.h"
#include "trocar/session/snapshot.h"

namespace trocar::session {

/// Where equilibrium is found.
enum class SolveOn {
  kProcessor,
  kGpu  ///< where there is one, else on the processor; other bits than the processor's, in single precision
};

/// One running surgery. The same scene and the same inputs give the same bits, for any number of threads.
class Simulation {
 public:
  /// \param threads  used by the solver, >= 1
  /// \return kSceneInvalid or kPatientInvalid
  static core::Result<Simulation> Make(std::shared_ptr<const Scene> scene, int threads,
                                       SolveOn solve_on = SolveOn::kProcessor);

  Simulation(Simulation&&) noexcept;
  Simulation& operator=(Simulation&&) noexcept;
  ~Simulation();

  /// One tick.
  /// \note No lock or file. Allocates only in a tick in which a blade parts an organ, a duct or a vessel.
  void Step(const Input& input) noexcept;
  /// Back to the first tick.
  void Reset();

  const Scene& GetScene() const;
  /// Organs, then tubes; constant.
  std::span<const SurfaceInfo> Surfaces() const;
  /// What dissection divides, constant; empty where the scene is no operation.
  std::span<const StrandInfo> Strands() const;
  /// How the operation stands; nothing where the scene is none.
  /// \note Allocates.
  std::optional<OperationResult> GetOperationResult() const;
  /// State after the last Step(); valid until the next.
  const Snapshot& GetSnapshot() const;
  /// Cuts out the tissue around one tool for the haptic loop, after a Step.
  /// \note Real-time safe: no allocation, lock or throw.
  void CutPatch(Hand hand, haptics::LocalPatch& patch) noexcept;
  /// How far the tissue was from equilibrium when the last tick's solve ended: the largest distance of a node
  /// to the equilibrium that an exact solver reaches from there under the same load and with the same volumes,
  /// over the largest distance of any node from rest [-]. NaN where that solver does not come to rest.
  /// \note For tests and benchmarks: takes many times as long as a tick, and allocates.
  double CalcEquilibriumError() const;
  /// Name of the GPU that solves; empty when the processor does.
  std::string_view GpuName() const;
  /// Why the GPU that was asked for does not solve, from the tick in which it failed; else nullptr.
  const core::Error* GpuError() const;
  /// Fingerprint of the whole state.
  std::uint64_t Hash() const;

 private:
  struct Content;
  explicit Simulation(std::unique_ptr<Content> content);
  std::unique_ptr<Content> content_;
};

}  // namespace trocar::session
