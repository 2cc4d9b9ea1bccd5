// SPDX-License-Identifier: Apache-2.0
/// \file surgeon_act.h  One act of an operation's plan, as a value: a motion, an exchange, a pedal, or a decision.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hold_planner.h"
#include "place.h"
#include "trocar/base/state_archive.h"
#include "trocar/instrument/tool.h"
#include "trocar/instrument/trocar_kinematics.h"
#include "trocar/scene/input.h"

namespace trocar::agent {

/// An act is begun once, then waited for. A decision plans further acts when it is reached, from what is seen then.
struct SurgeonAct {
  /// The order is part of a saved state.
  enum class Kind : std::uint8_t {
    kAssist,
    kReach,
    kJaw,
    kSetJaw,
    kWait,
    kExchange,
    kCloseBag,
    kTakeOut,
    kDraw,
    kEase,
    kBurn,
    kPressCutPedal,
    kLiftFoot,
    kLook,
    kLookFrom,
    kLineUp,
    kLineUpClip,
    kLineUpScissors,
    kDissect,
    kSpread,
    // decisions
    kChooseHold,
    kTakeHold,
    kCheckHold,
    kTake,
    kClearTriangle,
    kCheckTriangle,
    kFreeLowerThird,
    kShowCriticalView,
    kDivideExtraArtery,
    kFollowWithCamera,
    kLookFromSide,
    kLookPastShaft,
    kTimeOut,
    kCheckStumps,
    kFreeFromBed,
    kDivide,
    kGoOnDividing,
    kCheckClip,
    kCheckClosedClip,
    kCheckBlades,
    kCheckBeforeCut,
    kCheckDivision,
    kCheckPlacedClip,
    kStopBleeding,
    kCoagulate,
    kTurnNeck,
    kGoRoundDuct,
    kFundusFirst,
    // pedals of the suction-irrigator
    kRinse,
    kAspirate
  } kind = Kind::kWait;
  std::string doing;
  double time_limit = 0;  ///< after which it is left [s]
  std::int32_t hand = instrument::kRight;
  Place place;
  double hurry = 1;                ///< times the skill's speed
  double seconds = 0;              ///< [s]
  double share = 0;                ///< of a tube's length [-], or an arc of it [m]
  double amount = 0;               ///< opening as a share or in [rad], turn [rad], share of the jaws [-]
  double distance = 0;             ///< of the lens [m]
  math::Vec3 by;                   ///< [m]
  std::int32_t count = 0;          ///< rounds or tries that are left
  std::int32_t side = 0;           ///< +1 or -1
  std::uint32_t node = 0;          ///< that is held
  std::size_t tube = 0;            ///< or its place in Division::tubes
  std::vector<std::size_t> tubes;  ///< to be divided
  std::vector<std::uint32_t> strands;
  HoldFilter may;
  bool is_on = false;
  std::uint8_t tool = 0;  ///< of the hand's tray
  instrument::ToolKind tool_kind = instrument::ToolKind::kGrasper;
  scene::AssistantCommand command = scene::AssistantCommand::kWait;
  instrument::TrocarJoints camera;

  bool IsDecision() const { return kind >= Kind::kChooseHold && kind <= Kind::kFundusFirst; }
  void VisitState(base::StateArchive& archive);
};

}  // namespace trocar::agent
