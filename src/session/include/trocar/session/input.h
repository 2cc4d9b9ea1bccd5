// SPDX-License-Identifier: Apache-2.0
/// \file input.h  Everything that reaches a tick from outside. A recording is a scene and a row of these.
#pragma once

#include <array>

#include "trocar/instrument/trocar_kinematics.h"
#include "trocar/tissue/solver_settings.h"

namespace trocar::session {

/// Index of a hand in every per-hand array.
enum Hand { kLeft = 0, kRight = 1 };
inline constexpr int kHandCount = 2;

/// What the person or the instructor may change while the simulation runs; acts in the next tick.
struct LiveSettings {
  double stiffness_scale = 1;  ///< on every structural and attachment spring [-], 0.05 to 20
  double shape_scale = 1;      ///< on every virtual (shape) spring [-], 0 to 20
  double gravity = 9.81;       ///< [m/s^2], 0 to 30
  double head_up = 0;          ///< reverse Trendelenburg [rad], -0.6 to 0.6
  double right_up = 0;         ///< patient's right side up [rad], -0.6 to 0.6
  tissue::SolverSettings solver;

  friend bool operator==(const LiveSettings&, const LiveSettings&) = default;
};

/// Clamps every setting to its range; NaN becomes the default.
LiveSettings ClampSettings(const LiveSettings& settings) noexcept;

struct Input {
  std::array<instrument::TrocarJoints, kHandCount> hands;
  /// jaw is not used; spin turns the angled tip (the light post), the horizon of the picture stays
  instrument::TrocarJoints laparoscope;
  LiveSettings settings;

  friend bool operator==(const Input&, const Input&) = default;
};

}  // namespace trocar::session
