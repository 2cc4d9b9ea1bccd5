// SPDX-License-Identifier: Apache-2.0
/// \file careless_cholecystectomy.h  Plans of surgeons who do one thing wrong, so that it can be asked whether they are caught.
#pragma once

#include <cstdint>

#include "act_list.h"
#include "patient_knowledge.h"
#include "trocar/math/vector.h"

namespace trocar::agent {

/// The one thing that a careless surgeon does wrong; kNone: the whole operation, well done.
enum class OperationErrorScenario : std::uint8_t {
  kNone,
  kClipsMainDuct,
  kCutsMainDuct,
  kBurnsMainDuct,
  kCutsUnclipped,
  kClipsEarly,
  kTooFewClips,
  kCrossesClips,
  kClipsPartly,
  kBleeds,
  kSlipsClip,
  kPerforates,
  kLeavesStones,
  kBurnsLiver,
  kBurnsNearDuct,
  kBurnsUnseen,
  kBurnsAir,
  kDropsClip,
  kGraspsLiver,
  kPullsHard,
  kCutsLiver,
  kInsertsBlind,
  kRinses
};

/// Writes the plan of a scenario. kNone is the table of cholecystectomy_goals.h as it is; kLeavesStones has one row more.
/// \param p_world_port  of the right hand [m]
void WriteErrorPlan(OperationErrorScenario scenario, const PatientKnowledge& known,
                    const math::Vec3& p_world_port, ActList& plan);

/// Whether the scenario goes through the whole operation, with a camera that follows the right hand.
bool IsWholeOperation(OperationErrorScenario scenario) noexcept;

}  // namespace trocar::agent
