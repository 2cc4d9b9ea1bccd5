// SPDX-License-Identifier: Apache-2.0
/// \file surgery_snapshot.h  Visible state of clips, ducts, arteries, bleeding and gallstones: plain values, complete for
/// drawing, tasks and metrics.
#pragma once

#include <cstdint>

#include "trocar/math/pose.h"
#include "trocar/surgery/flow_network.h"

namespace trocar::surgery {

/// A clip, open or closed. Frame: origin in its middle, +x along its legs towards their tips, +z along what it closes.
struct ClipSnapshot {
  math::Pose X_world_clip;
  double gap = 0;           ///< between its legs [m]
  bool is_lost = false;     ///< lies in the abdomen
  bool is_crossed = false;  ///< lies over another clip
  double closure = 0;       ///< share of the vessel that it holds, 0 to 1 [-]
  math::Vec3 p_rest;  ///< where on its vessel, as that was at rest, world frame [m]; of a lost clip nothing

  /// Closed around the whole of a vessel, and over no other.
  bool IsGood() const { return !is_lost && !is_crossed && closure > 0.999; }
};

/// Leak from a cut or a hole.
struct LeakSnapshot {
  math::Vec3 position;   ///< world frame [m]
  math::Vec3 direction;  ///< unit, out of the opening
  Fluid fluid = Fluid::kBlood;
  double rate = 0;  ///< [m^3/s]
};

/// A piece of a duct or vessel between two of its nodes; pieces that end alone are stumps.
struct TubePiece {
  std::uint32_t a = 0, b = 0;         ///< nodes of the system
  double radius_a = 0, radius_b = 0;  ///< [m]
  std::uint32_t surface = 0;          ///< of the scene: its organs come first, then its tubes
};

/// Where liver bleeds from what was torn off it without heat.
struct OozeSnapshot {
  math::Vec3 position;  ///< world frame [m]
  double rate = 0;      ///< [m^3/s]
};

/// Where a gallstone is.
enum class StonePlace : std::uint8_t {
  kInside,   ///< of the hollow organ
  kSpilled,  ///< in the abdomen
  kHeld,     ///< between the jaws of `hand`
  kInBag,    ///< of its own; what is in the organ goes with that
  kAspirated,
  kTakenOut  ///< through a trocar
};

struct StoneSnapshot {
  math::Vec3 position;  ///< of its centre, world frame [m]; of a spilled or held one
  double radius = 0;    ///< [m]
  StonePlace place = StonePlace::kInside;
  std::int32_t hand = -1;  ///< that holds it
};

/// Numbers of the patient's gallstones by where they are.
struct StoneCount {
  int all = 0;
  int inside = 0;   ///< of the hollow organ
  int spilled = 0;  ///< in the abdomen, those between jaws among them
  int in_bag = 0;   ///< of its own, beside the organ
  int aspirated = 0;
  int taken_out = 0;  ///< through a trocar
};

}  // namespace trocar::surgery
