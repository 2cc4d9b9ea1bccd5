// SPDX-License-Identifier: Apache-2.0
/// \file spread_planner.h  Dissection where no current may flow: jaws open among fibres, or blades take the last ones one by one.
///
/// Each spread is chosen (spread_plan.h), approached with jaws that are nearly closed, entered, and opened.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "spread_plan.h"
#include "trocar/agent/hand_motion.h"
#include "trocar/base/state_archive.h"
#include "trocar/instrument/tool.h"
#include "trocar/math/pose.h"

namespace trocar::agent {

/// Fibres that are parted bluntly, by opening jaws among them, or cut one by one.
struct Spreading {
  std::vector<std::uint32_t> strands;
  std::vector<double> weights;  ///< (strands) what parting one is worth [-]
  bool is_sharp = false;        ///< with scissors
  std::vector<std::uint8_t> tries;
  enum class Stage : std::uint8_t { kChoose, kApproach, kEnter, kOpen } stage = Stage::kChoose;
  SpreadPose pose;
  std::size_t left_before = 0;
  std::uint32_t aim = 0;  ///< among strands
  int fruitless = 0;

  void VisitState(base::StateArchive& archive);
};

/// What lies before the jaws, and which of the work's strands each fibre of the field is.
struct SeenSpread {
  SpreadField field;
  std::vector<std::uint32_t> index;  ///< (fibres)
};

/// What is seen in this tick.
struct SpreadSight {
  std::span<const std::uint8_t> is_intact;  ///< (strands of the scene)
  /// Before the jaws; asked when a pose is chosen or checked.
  std::function<SeenSpread(const Spreading&)> look;
  std::function<bool()> is_clear;  ///< nothing more is to be parted
  math::Pose X_world_tool;         ///< of the tool that is seen
};

/// "maryland", or "scissors" where the work is sharp.
const instrument::Tool& FindSpreadTool(const Spreading& work);

/// One tick of it.
/// \param[in,out] seconds  since the act began; begins anew while jaws open [s]
/// \return whether it is over: nothing is left, or nothing more can be parted
bool StepSpreading(const SpreadSight& sight, Spreading& work, double& seconds, HandMotion& hand);

}  // namespace trocar::agent
