// SPDX-License-Identifier: Apache-2.0
/// \file reward.h  Effects of an action, as features of a reward.
#pragma once

#include <array>
#include <cstdint>

#include "trocar/environment/settings.h"
#include "trocar/simulation/simulation.h"

namespace trocar::environment {

/// State of a task at a moment; features are differences between two of them.
struct Standing {
  double goals = 0, steps = 0;  ///< shares of all that are done [-]
  bool is_completed = false;
  std::uint64_t errors = 0, critical_errors = 0;
  double cleared = 0, detached = 0;  ///< [-]
  int critical_view = 0;             ///< points
  double blood = 0;                  ///< [m^3]
  /// The first open goal, its step, and how far what that step wants still is [m].
  int goal = -1, step = -1;
  double distance = 0;
};
Standing CalcStanding(const simulation::Simulation& simulation);

/// Adds up over the ticks of an action.
class RewardMeter {
 public:
  void Begin(const simulation::Simulation& simulation);
  void AfterTick(const simulation::Simulation& simulation) noexcept;
  Features End(const simulation::Simulation& simulation);

 private:
  Standing before_;
  std::array<math::Vec3, instrument::kHandCount> tips_{};
  double force_ = 0, path_ = 0, time_ = 0;  // [N s], [m], [s]
};

}  // namespace trocar::environment
