// SPDX-License-Identifier: Apache-2.0
/// \file state_guard.h  Finds a state that went wrong in the tick in which it did, and goes back (faults S1
/// and S3).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "trocar/tissue/tissue_model.h"

namespace trocar::tissue {

enum class GuardVerdict {
  kGood,
  kRestored,  ///< bad state replaced by the last good one; try again in the next tick
  kFrozen     ///< bad several times in a row: every node is held until Release()
};

/// Keeps the last good positions. A state is bad when a coordinate is not finite or a node is farther from
/// rest than any organ could be.
class StateGuard {
 public:
  /// \param max_displacement  from rest [m]; 0.5 m is more than the abdomen
  explicit StateGuard(const TissueModel& model, double max_displacement = 0.5);

  /// Checks, restores where needed, and remembers a good state.
  /// \param is_solve_finite  SolveReport::is_finite: what a tick takes from elsewhere may be bad although the
  /// positions
  ///                         are not
  /// \note Real-time safe.
  GuardVerdict Check(TissueState& state, bool is_solve_finite = true) noexcept;
  /// Goes on with a model that a cut has changed, in a state that is good.
  /// \pre as many nodes as before; the model outlives this
  void UpdateTopology(const TissueModel& model, const TissueState& state) noexcept;
  bool IsFrozen() const noexcept { return bad_in_a_row_ >= kMaxRetries; }
  /// Verdict of the last Check(), also of one before the state was saved and restored.
  GuardVerdict LastVerdict() const noexcept {
    if (bad_in_a_row_ == 0) return GuardVerdict::kGood;
    return IsFrozen() ? GuardVerdict::kFrozen : GuardVerdict::kRestored;
  }
  /// Takes the state as good and lets the nodes move again.
  void Release(const TissueState& state) noexcept;

  /// The last good positions and how often the state was bad since.
  void VisitState(base::StateArchive& archive);

  static constexpr int kMaxRetries = 3;

 private:
  const TissueModel* model_;
  double max_displacement_;
  std::vector<math::Vec3> good_;
  int bad_in_a_row_ = 0;
};

}  // namespace trocar::tissue
