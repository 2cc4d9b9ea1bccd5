// SPDX-License-Identifier: Apache-2.0
/// \file input.h  Everything that reaches a tick from outside. A recording is a scene and a row of these.
#pragma once

#include <array>
#include <cstdint>

#include "trocar/instrument/hand.h"
#include "trocar/instrument/trocar_kinematics.h"
#include "trocar/tissue/solver_settings.h"

namespace trocar::scene {

/// Controls of a hand and its foot besides the motion of the tool.
struct HandControls {
  std::uint8_t tool = 0;  ///< wanted, by its place in InstrumentSetup::tray; exchanged when the shaft is free
  bool cut = false;       ///< yellow pedal
  bool coagulate = false;  ///< blue pedal
  bool rinse = false;      ///< of a suction-irrigator
  bool aspirate = false;

  friend bool operator==(const HandControls&, const HandControls&) = default;
};

/// Command to the assistant, who holds the third grasper, at the fundus.
enum class AssistantCommand : std::uint8_t {
  kWait,     ///< out of the way
  kRetract,  ///< take the fundus and lift it over the liver's edge towards the right shoulder
  kRelax,    ///< hold it, without pulling
  kRelease   ///< let go and withdraw
};

/// Settings that the person or the instructor may change while the simulation runs. They act in the next tick.
struct LiveSettings {
  double stiffness_scale = 1;  ///< on every structural and attachment spring [-], 0.05 to 20
  double shape_scale = 1;      ///< on every virtual (shape) spring [-], 0 to 20
  double gravity = 9.81;       ///< [m/s^2], 0 to 30
  double head_up = 0;          ///< reverse Trendelenburg [rad], -0.6 to 0.6
  double right_up = 0;         ///< patient's right side up [rad], -0.6 to 0.6
  /// The automatic holder moves the laparoscope: it keeps both tips in the picture, and Input::laparoscope is not used.
  bool holds_camera = false;
  tissue::SolverSettings solver;

  friend bool operator==(const LiveSettings&, const LiveSettings&) = default;
};

/// Clamps every setting to its range; NaN becomes the default.
LiveSettings ClampSettings(const LiveSettings& settings) noexcept;

struct Input {
  std::array<instrument::TrocarJoints, instrument::kHandCount> hands;
  std::array<HandControls, instrument::kHandCount> controls;
  AssistantCommand assistant = AssistantCommand::kWait;
  /// jaw is not used; spin turns the angled tip (the light post), the horizon of the picture stays
  instrument::TrocarJoints laparoscope;
  LiveSettings settings;

  friend bool operator==(const Input&, const Input&) = default;
};

}  // namespace trocar::scene
