// SPDX-License-Identifier: Apache-2.0
/// \file preparation_forecast.h  How far the scripted expert is on the way to a moment of an operation, and how long it still takes.
#pragma once

#include <optional>

#include "trocar/assessment/milestone.h"

namespace trocar::assessment {

/// Simulated time at which the scripted expert reaches a milestone of the built-in patient [s]. Other patients take from four fifths of
/// it to three times as long, the three levels were not compared.
double TypicalTime(Milestone milestone) noexcept;

/// Follows one preparation. It reads no clock itself.
class PreparationForecast {
 public:
  /// \param reached  where the expert begins
  /// \param target   after it
  /// \param seconds  simulated time at which the expert begins [s]
  /// \param clock    of a steady clock [s]
  PreparationForecast(Milestone reached, Milestone target, double seconds, double clock) noexcept;

  /// \param seconds, clock  not less than before
  void See(Milestone reached, double seconds, double clock) noexcept;
  /// Part of the way that is done [-]: never less than before, 1 only where the target is reached.
  double Share() const noexcept { return share_; }
  /// Estimate of what is left by the clock [s]. Nothing before the pace is known, and where it takes longer than foreseen.
  std::optional<double> SecondsLeft() const noexcept { return left_; }
  bool IsLate() const noexcept { return is_late_; }

 private:
  Milestone reached_, target_;
  double begin_, begin_clock_;  // [s]
  double end_;                  // foreseen simulated time of the target [s]
  double share_ = 0;
  std::optional<double> left_;
  bool is_late_ = false;
};

}  // namespace trocar::assessment
