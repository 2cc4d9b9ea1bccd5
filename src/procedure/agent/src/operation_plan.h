// SPDX-License-Identifier: Apache-2.0
/// \file operation_plan.h  Plan of the surgeon of a cholecystectomy, as values: acts, places, work under way.
///
/// Nothing here refers to the surgeon or to a snapshot, so that a plan can be saved in the middle of an operation.
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "spread_plan.h"
#include "trocar/base/state_archive.h"
#include "trocar/instrument/tool.h"
#include "trocar/instrument/trocar_kinematics.h"
#include "trocar/scene/input.h"

namespace trocar::agent {

/// Where something is, to be found in a snapshot when it is needed.
struct Place {
  enum class Kind : std::uint8_t {
    kNone,
    kPoint,        ///< `p`
    kNode,         ///< of the tissue; `back` from there towards the hand's trocar
    kAboveNode,    ///< `back` from there towards the middle between both trocars
    kTube,         ///< at a share of a tube's length
    kAim,          ///< `back` before it, as seen from the right hand's trocar
    kBetweenJaws,  ///< of the tip, when the tube lies between jaws of length `back`; `share` is the arc [m]
    kStrands,      ///< the middle of the gallbladder's ends of strands
    kGallbladder,  ///< its middle
    kBesideHold,   ///< in the gallbladder's wall, beside what the left hand holds
    kInLiver,      ///< under its surface, `back` along it
    kRightTip,     ///< of the tool that is seen
    kBehindTip,    ///< `back` along the shaft of `hand`
    kFromTip,      ///< of `hand`, by `p`
    kOverField,    ///< over what the picture is about, in the picture
    kPool          ///< where liquid gathers, `back` towards the trocar
  } kind = Kind::kNone;
  std::int32_t hand = instrument::kRight;
  bool is_for_hook = false;  ///< where the tip stands when the middle of the hook's toe is there
  std::uint32_t node = 0;
  std::size_t tube = 0;
  double share = 0;  ///< [-]
  double back = 0;   ///< [m]
  math::Vec3 p;      ///< [m]
  std::vector<std::uint32_t> strands;

  static Place At(const math::Vec3& p);
  static Place AtNode(std::uint32_t node);
  static Place OnTube(std::size_t tube, double share);
  static Place Aim(std::size_t tube, double share, double back);
  static Place BehindTip(int hand, double back);
  static Place Of(Kind kind);
  Place ForHook() const;
  void VisitState(base::StateArchive& archive);
};

/// Which nodes of the gallbladder may be held.
struct HoldFilter {
  enum class Kind : std::uint8_t {
    kAny,
    kInfundibulum,
    kFree,   ///< the flap that has been freed, before `peels`
    kFundus  ///< the fundus, or the flap that has been freed beyond `peels`
  } kind = Kind::kAny;
  double peels = 0;  ///< where the gallbladder peels off its bed, from the infundibulum on [m]

  void VisitState(base::StateArchive& archive);
};

/// One thing to do: begun once, then waited for. The decisions plan on when they are reached, from what is seen then.
struct SurgeonAct {
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

/// The other hand's part: it draws on what it holds, so that the fibres are stretched and lie open.
struct Traction {
  double most = 0;               ///< way in all; 0: it rests [m]
  double most_pull = 0;          ///< above which it gives way [N]
  double enough_pull = 0;        ///< below which it draws on [N]
  std::vector<math::Vec3> ways;  ///< unit vectors, in turn when no fibre lies open any more
  std::size_t way = 0;
  math::Vec3 p_hold;  ///< of the tip, when it began [m]
  double drawn = 0;   ///< [m]
  bool is_swinging = false;
  int swings_left = 0;
  double seconds = 0;             ///< since the last swing, or since it was worth its while [s]
  std::size_t fibres_before = 0;  ///< that were left then

  void VisitState(base::StateArchive& archive);
};

/// The fibre that the hook goes to, or has on its toe.
struct HookTarget {
  std::int32_t fibre = -1;                    ///< among the dissection's
  double spin = 0;                            ///< of the hook [rad]
  std::deque<math::Vec3> path;                ///< of the tip, after where it goes now [m]
  math::Vec3 aside;                           ///< by which the tip is led to the fibre [m]
  double seconds = 0, apart = 0, heated = 0;  ///< in all, beside it, with current [s]

  void VisitState(base::StateArchive& archive);
};

struct DissectionGoal {
  enum class Until : std::uint8_t {
    kParted,         ///< the share alone
    kTriangleClear,  ///< as the critical view asks
    kLowerThirdFree,
    kBedStep  ///< a step of the bed is done, after which the hold is chosen anew
  };
  std::string what;
  std::vector<std::uint32_t> strands;
  std::vector<double> order;  ///< (strands) what comes first [m]
  double enough = 1.0;        ///< share that is to be parted [-]
  Until until = Until::kParted;
  double traction = 0;     ///< see Traction::most
  math::Vec3 way = {};     ///< of it, unit vector
  HoldFilter may = {};     ///< what is free already: it bears a stronger pull
  double left_before = 0;  ///< share of the strands, when it was planned [-]

  bool IsFlapHeld() const { return may.kind != HoldFilter::Kind::kAny; }
  void VisitState(base::StateArchive& archive);
};

/// Dissection of fibres with the hook, until none is left that can be reached.
struct Dissection {
  DissectionGoal goal;
  std::vector<std::uint8_t> attempts;  ///< (strands)
  std::size_t left = 0;                ///< fibres
  double parted_at_reset = 0;
  HookTarget target;
  Traction traction;
  bool waits = false;      ///< for a place to cool
  bool is_bold = false;    ///< pushes on to fibres that do not lie open
  double backing_off = 0;  ///< [s]
  int holds_left = 4;      ///< new holds of a slipped left hand

  void VisitState(base::StateArchive& archive);
};

/// Fibres that are parted bluntly, by opening jaws among them, or cut one by one.
struct Spreading {
  std::vector<std::uint32_t> strands;
  std::vector<double> weights;  ///< (strands)
  bool is_sharp = false;        ///< with scissors
  std::vector<std::uint8_t> tries;
  enum class Stage : std::uint8_t { kChoose, kApproach, kEnter, kOpen } stage = Stage::kChoose;
  SpreadPose pose;
  std::size_t left_before = 0;
  std::uint32_t aim = 0;  ///< among strands
  int fruitless = 0;

  void VisitState(base::StateArchive& archive);
};

/// Clips and cuts of tubes, until each is divided.
struct Division {
  std::vector<std::size_t> tubes;
  std::vector<std::vector<double>> avoid;  ///< (tubes) arcs at which it has failed [m]
  int acts_left = 0;
  double care = 1.0;  ///< see DivisionField

  void VisitState(base::StateArchive& archive);
};

}  // namespace trocar::agent
