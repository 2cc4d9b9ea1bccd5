// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <span>

#include "cholecystectomy_surgeon.h"
#include "trocar/math/elementary.h"

namespace trocar::agent {

using instrument::kLeft;
using instrument::kRight;
using math::Pose;
using math::Vec3;
using roles::TubeRole;
using simulation::Snapshot;

namespace {

constexpr double kStandOff = 0.012;   // of a tool's tip from the vessel while it is lined up [m]
constexpr double kBack = 0.020;       // from there when it is done [m]
constexpr double kFromTips = 0.0018;  // of a vessel's axis, so that the clip reaches around it [m]
constexpr double kAnother = 0.05;     // of a vessel's length, to another place for a clip
constexpr double kBesideHold = 0.015, kBesideWeight = 4.0;  // of a place in the wall from the hold [m], [-]
constexpr double kSpillSeconds = 8.0;                       // in which stones leave through a hole
constexpr double kRinseFrom = 0.022;                        // before what bleeds [m]
constexpr double kBetweenLegs = 0.003;  // of a clip applier's middle line, where a vessel is to be [m]

}  // namespace

Vec3 CholecystectomySurgeon::Aim(const Snapshot& seen, std::size_t tube, double share, double ahead) const {
  const Vec3 p = TubePoint(seen, tube, share);
  return p + ahead * math::Normalized(p - hands_[kRight].Port());
}

void CholecystectomySurgeon::LineUp(const std::string& what, std::size_t tube, double share, double jaw) {
  SurgeonAct& act = Add(SurgeonAct::Kind::kLineUp, "line up the " + what, 5.0);
  act.tube = tube;
  act.share = share;
  act.amount = jaw;
}

void CholecystectomySurgeon::LineUpTool(const SurgeonAct& act, const Snapshot& seen) {
  HandMotion& hand = HandOf(kRight);
  const Vec3 p = TubePoint(seen, act.tube, act.share);
  const Vec3 shaft = math::Normalized(p - hand.Port());
  hand.Turn(FindSpin(hand.Port(), p, math::Cross(shaft, TubeDirection(seen, act.tube, act.share))));
  hand.SetJaw(act.amount);
  hand.MoveTo(Aim(seen, act.tube, act.share, -kStandOff));
}

/// \param beyond  how far from the tips, as a share of the jaws, the vessel lies in them
/// \param tries   how often it is lined up anew when the vessel is not between the legs
void CholecystectomySurgeon::PlaceClip(std::size_t tube, double share, double beyond, int tries) {
  const instrument::Tool& applier = *instrument::FindTool("clip_applier");
  LineUp("clip", tube, share, applier.max_jaw);
  Reach(kRight, Place::Aim(tube, share, -beyond * applier.jaw_length), 0.4);
  Wait(0.2);
  SurgeonAct& act = Decide(SurgeonAct::Kind::kCheckPlacedClip, "look at the clip's tips");
  act.tube = tube;
  act.share = share;
  act.amount = beyond;
  act.count = tries;
}

void CholecystectomySurgeon::CheckPlacedClip(const SurgeonAct& act, const Snapshot& seen) {
  const double length = instrument::FindTool("clip_applier")->jaw_length;
  const Pose& X = seen.instruments[kRight].X_world_tool;
  const Vec3 in = math::Inverse(X) * TubePoint(seen, act.tube, act.share);
  const bool is_between =
      math::Hypot(in.x, in.y) < kBetweenLegs && in.z > kFromTips && in.z < length - kFromTips;
  if (is_between || act.count == 0) return CloseClip(act.tube, act.share);
  Reach(kRight, Place::Aim(act.tube, act.share, kStandOff));
  // a little farther along, then a little nearer
  PlaceClip(act.tube, act.share + (act.count % 2 == 0 ? kAnother : -2 * kAnother), act.amount, act.count - 1);
}

void CholecystectomySurgeon::CloseClip(std::size_t tube, double share) {
  SetJaw("close the clip", 0.0);
  // open enough to leave the clip, not so far that the next one comes
  Jaw(kRight, 0.4);
  Reach(kRight, Place::Aim(tube, share, kBack), 0.6);
}

void CholecystectomySurgeon::CutTube(std::size_t tube, double share) {
  const instrument::Tool& scissors = *instrument::FindTool("scissors");
  LineUp("scissors", tube, share, scissors.max_jaw);
  Reach(kRight, Place::Aim(tube, share, -0.4 * scissors.jaw_length), 0.4);
  SetJaw("cut", 0.0);
  Reach(kRight, Place::Aim(tube, share, kBack), 0.6);
}

/// Of the gallbladder, near what the left hand holds, so that it does not give way; towards the right hand's trocar.
Vec3 CholecystectomySurgeon::WallBesideHold(const Snapshot& seen) const {
  const scene::SurfaceInfo& wall = known_.surfaces[static_cast<std::size_t>(known_.gallbladder)];
  const auto positions = std::span(seen.positions).subspan(wall.first_node, wall.node_count);
  const auto cost = [&](const Vec3& p) {
    const double away = math::Distance(p, hands_[kLeft].Tip());
    return math::Distance(p, hands_[kRight].Port()) + kBesideWeight * std::fabs(away - kBesideHold);
  };
  return *std::min_element(positions.begin(), positions.end(),
                           [&](const Vec3& a, const Vec3& b) { return cost(a) < cost(b); });
}

/// A light grip, and a strong pull.
void CholecystectomySurgeon::PullHard() {
  Grasp(kLeft, Place::AtNode(known_.hold), 0.17);
  Draw(kLeft, {0.0, -0.09, 0.06});
  Wait(1.0);
}

void CholecystectomySurgeon::CutIntoLiver() {
  Place in_liver = Place::Of(Place::Kind::kInLiver);
  in_liver.back = -0.006;
  Reach(kRight, in_liver, 0.5);
  Add(SurgeonAct::Kind::kPressCutPedal, "press the pedal", 1.0);
  in_liver.back = 0.010;
  Reach(kRight, in_liver, 0.1);
  Add(SurgeonAct::Kind::kLiftFoot, "let go of the pedal", 1.0);
}

/// Exchanges a tool far from the picture, and does not look for it.
void CholecystectomySurgeon::InsertBlind() {
  Exchange(kRight, instrument::ToolKind::kScissors);
  Reach(kRight, Place::At(HandOf(kRight).Port() + 0.10 * Vec3{0.6, -0.3, -0.7}));
  Exchange(kRight, instrument::ToolKind::kHook, false);
  Wait(3.0);
}

void CholecystectomySurgeon::PlanErrorScenario(OperationErrorScenario error_scenario) {
  using instrument::ToolKind;
  const std::size_t duct = FindTube(TubeRole::kCysticDuct), artery = FindTube(TubeRole::kCysticArtery),
                    main = FindTube(TubeRole::kCommonHepaticDuct);
  const Place liver = Place::AtNode(known_.liver_node);
  Place above_neck = Place::Of(Place::Kind::kAboveNode);
  above_neck.node = known_.neck;
  above_neck.back = 0.05;
  const auto clip = [this] { Exchange(kRight, ToolKind::kClipApplier); };
  const auto scissors = [this] { Exchange(kRight, ToolKind::kScissors); };
  switch (error_scenario) {
    case OperationErrorScenario::kNone:
      break;
    case OperationErrorScenario::kClipsMainDuct:
      clip();
      PlaceClip(main, 0.5);
      break;
    case OperationErrorScenario::kCutsMainDuct:
      scissors();
      CutTube(main, 0.75);
      break;
    case OperationErrorScenario::kBurnsMainDuct:
      Burn(kRight, Place::OnTube(main, 0.6).ForHook(), 20.0);
      break;
    case OperationErrorScenario::kCutsUnclipped:
      scissors();
      CutTube(duct, 0.4);
      break;
    case OperationErrorScenario::kClipsEarly:
      clip();
      PlaceClip(duct, 0.5);
      break;
    case OperationErrorScenario::kTooFewClips:
      clip();
      PlaceClip(duct, 0.6);
      scissors();
      CutTube(duct, 0.36);
      break;
    case OperationErrorScenario::kCrossesClips:
      clip();
      PlaceClip(duct, 0.5);
      PlaceClip(duct, 0.5);
      break;
    case OperationErrorScenario::kClipsPartly:
      clip();
      PlaceClip(duct, 0.5, 0.1);
      break;
    case OperationErrorScenario::kBleeds:
      scissors();
      CutTube(artery, 0.65);
      LookAt(Place::OnTube(artery, 0.65), 0.0, 0.080);
      Wait(60.0);
      break;
    case OperationErrorScenario::kSlipsClip:
      clip();
      PlaceClip(artery, 0.75, 0.0);
      scissors();
      CutTube(artery, 0.5);
      Wait(10.0);
      break;
    case OperationErrorScenario::kPerforates:
      Burn(kRight, Place::AtNode(known_.neck).ForHook(), 10.0);
      break;
    case OperationErrorScenario::kLeavesStones:
      FreeGallbladder();
      Burn(kRight, Place::Of(Place::Kind::kBesideHold).ForHook(), 6.0);
      Wait(kSpillSeconds);
      Remove();
      break;
    case OperationErrorScenario::kBurnsLiver:
      Burn(kRight, liver.ForHook(), 15.0);
      break;
    case OperationErrorScenario::kBurnsNearDuct:
      Burn(kRight, Place::OnTube(main, 0.6).ForHook(), 0.5);
      break;
    case OperationErrorScenario::kBurnsUnseen:
      Burn(kRight, Place::At(HandOf(kRight).Port() + 0.035 * Vec3{0.2, 0.1, -1.0}), 0.5);
      break;
    case OperationErrorScenario::kBurnsAir:
      Burn(kRight, above_neck, 0.5);
      break;
    case OperationErrorScenario::kDropsClip:
      clip();
      Jaw(kRight, 1.0);
      Jaw(kRight, 0.0);
      break;
    case OperationErrorScenario::kGraspsLiver:
      Grasp(kLeft, liver);
      break;
    case OperationErrorScenario::kPullsHard:
      PullHard();
      break;
    case OperationErrorScenario::kCutsLiver:
      CutIntoLiver();
      break;
    case OperationErrorScenario::kInsertsBlind:
      InsertBlind();
      break;
    case OperationErrorScenario::kRinses:
      Add(SurgeonAct::Kind::kAssist, "assistant: retract", 8.0).command = scene::AssistantCommand::kRetract;
      scissors();
      CutTube(artery, 0.65);
      LookAt(Place::OnTube(artery, 0.65), 0.0, 0.080);
      Exchange(kRight, ToolKind::kSuctionIrrigator);
      for (int round = 0; round < 4; ++round) Rinse(Place::Aim(artery, 0.65, kRinseFrom), 3.0, 4.0);
      break;
  }
  Wait(0.5);
}

}  // namespace trocar::agent
