// SPDX-License-Identifier: Apache-2.0
/// \file operation_memory.h  What a surgeon remembers of an operation from tick to tick: hands, camera, and the work under way.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "camera_planner.h"
#include "division_planner.h"
#include "heat_memory.h"
#include "hook_planner.h"
#include "spread_planner.h"
#include "trocar/agent/hand_motion.h"
#include "trocar/scene/input.h"

namespace trocar::agent {

/// Whether the work gets on: fibres that are left, and since when none parted while it dissected.
struct Progress {
  std::size_t fibres_left = 0;
  double stuck_seconds = 0, seconds = 0;  ///< the latter since it began [s]
};

/// Other ways that are left where the first one did not lead to the goal.
struct WaysLeft {
  static constexpr int kTriangleWays = 4;  // to hold the neck, where fat cannot be reached
  static constexpr int kSharpRounds = 2;  // with scissors, where jaws and hook do not come to the last fibres
  int triangle = kTriangleWays, sharp = kSharpRounds;
  bool has_begun_at_fundus = false;
};

struct OperationMemory {
  std::array<HandMotion, instrument::kHandCount> hands;
  std::array<scene::HandControls, instrument::kHandCount> controls{};
  scene::AssistantCommand assistant = scene::AssistantCommand::kWait;
  CameraWork camera{};
  bool has_view = false;   ///< the critical view was achieved
  bool stops = false;      ///< bails out: it is not safe to go on
  std::string bail_out{};  ///< why it stopped
  WaysLeft ways{};
  Progress progress{};
  Dissection dissection{};  ///< that is under way, or planned next
  Spreading spreading{};
  Division division{};
  JawAim aim{};
  double unheld_seconds = 0;  ///< since the left hand lost its hold, while it dissects [s]
  std::vector<std::uint32_t> missed_holds{};
  HeatMemory heat{};

  HandMotion& Hand(int hand) { return hands[static_cast<std::size_t>(hand)]; }
  /// Ends the operation here: what is done is safe, and a person would convert it or ask for help.
  void BailOut(std::string reason);
};

}  // namespace trocar::agent
