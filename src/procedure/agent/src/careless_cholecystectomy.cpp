// SPDX-License-Identifier: Apache-2.0
#include "careless_cholecystectomy.h"

#include <vector>

#include "cholecystectomy_goals.h"
#include "cholecystectomy_steps.h"
#include "trocar/math/elementary.h"

namespace trocar::agent {

using instrument::kLeft;
using instrument::kRight;
using instrument::ToolKind;
using math::Vec3;
using scene::AssistantCommand;

namespace {

constexpr double kBack = 0.020;         // of a tool from the vessel when it is done [m]
constexpr double kStandOff = 0.012;     // likewise before another try [m]
constexpr double kFromTips = 0.0018;    // of a vessel's axis, so that the clip reaches around it [m]
constexpr double kAnother = 0.05;       // of a vessel's length, to another place for a clip
constexpr double kBetweenLegs = 0.003;  // of a clip applier's middle line, where a vessel is to be [m]
constexpr double kBladesBeyond = 0.4;   // of the scissors, past the vessel [-]
constexpr double kSpillSeconds = 8.0;   // in which stones leave through a hole
constexpr double kRinseFrom = 0.022;    // before what bleeds [m]

/// What a careless plan is written from.
struct Writing {
  const PatientKnowledge& known;
  const Vec3& port;  // of the right hand [m]
  ActList& plan;

  void Exchange(ToolKind kind) const { plan.Exchange(kRight, kind); }
};

/// Along a tube's length, the tool across it.
void LineUp(ActList& plan, const char* doing, std::size_t tube, double share, double jaw) {
  SurgeonAct& act = plan.Add(SurgeonAct::Kind::kLineUp, doing, 5.0);
  act.tube = tube;
  act.share = share;
  act.amount = jaw;
}

/// \param beyond  how far from the tips, as a share of the jaws, the vessel lies in them
/// \param tries   how often it is lined up anew when the vessel is not between the legs
void PlaceClip(ActList& plan, std::size_t tube, double share, double beyond = 0.5, int tries = 2) {
  const instrument::Tool& applier = *instrument::FindTool("clip_applier");
  LineUp(plan, "line up the clip", tube, share, applier.max_jaw);
  plan.Reach(kRight, Place::Aim(tube, share, -beyond * applier.jaw_length), 0.4);
  plan.Wait(0.2);
  SurgeonAct& act = plan.Decide(SurgeonAct::Kind::kCheckPlacedClip, "look at the clip's tips");
  act.tube = tube;
  act.share = share;
  act.amount = beyond;
  act.count = tries;
}

void CutTube(ActList& plan, std::size_t tube, double share) {
  const instrument::Tool& scissors = *instrument::FindTool("scissors");
  LineUp(plan, "line up the scissors", tube, share, scissors.max_jaw);
  plan.Reach(kRight, Place::Aim(tube, share, -kBladesBeyond * scissors.jaw_length), 0.4);
  plan.SetJaw("cut", 0.0);
  plan.Reach(kRight, Place::Aim(tube, share, kBack), 0.6);
}

void ClipMainDuct(const Writing& on) {
  on.Exchange(ToolKind::kClipApplier);
  PlaceClip(on.plan, on.known.hepatic_duct, 0.5);
}

void CutMainDuct(const Writing& on) {
  on.Exchange(ToolKind::kScissors);
  CutTube(on.plan, on.known.hepatic_duct, 0.75);
}

void BurnMainDuct(const Writing& on) {
  on.plan.Burn(kRight, Place::OnTube(on.known.hepatic_duct, 0.6).ForHook(), 20.0);
}

void CutUnclipped(const Writing& on) {
  on.Exchange(ToolKind::kScissors);
  CutTube(on.plan, on.known.cystic_duct, 0.4);
}

void ClipEarly(const Writing& on) {
  on.Exchange(ToolKind::kClipApplier);
  PlaceClip(on.plan, on.known.cystic_duct, 0.5);
}

void ClipTooLittle(const Writing& on) {
  on.Exchange(ToolKind::kClipApplier);
  PlaceClip(on.plan, on.known.cystic_duct, 0.6);
  on.Exchange(ToolKind::kScissors);
  CutTube(on.plan, on.known.cystic_duct, 0.36);
}

void CrossClips(const Writing& on) {
  on.Exchange(ToolKind::kClipApplier);
  for (int clip = 0; clip < 2; ++clip) PlaceClip(on.plan, on.known.cystic_duct, 0.5);
}

void ClipPartly(const Writing& on) {
  on.Exchange(ToolKind::kClipApplier);
  PlaceClip(on.plan, on.known.cystic_duct, 0.5, 0.1);
}

void CutArteryAndLook(const Writing& on) {
  on.Exchange(ToolKind::kScissors);
  CutTube(on.plan, on.known.cystic_artery, 0.65);
  on.plan.LookAt(Place::OnTube(on.known.cystic_artery, 0.65), 0.0, 0.080);
}

void Bleed(const Writing& on) {
  CutArteryAndLook(on);
  on.plan.Wait(60.0);
}

void SlipClip(const Writing& on) {
  on.Exchange(ToolKind::kClipApplier);
  PlaceClip(on.plan, on.known.cystic_artery, 0.75, 0.0);
  on.Exchange(ToolKind::kScissors);
  CutTube(on.plan, on.known.cystic_artery, 0.5);
  on.plan.Wait(10.0);
}

void Perforate(const Writing& on) {
  on.plan.Burn(kRight, Place::AtNode(on.known.neck).ForHook(), 10.0);
}

/// A hole in the gallbladder that is off its bed, through which stones leave before it is brought out.
void LeaveStones(const Writing& on) {
  const auto goals = CholecystectomyGoals();
  std::vector<OperationGoal> all(goals.begin(), goals.end());
  OperationGoal open;
  open.doing = "open the gallbladder";
  open.write = [](const OperationGoal&, const PatientKnowledge&, ActList& plan) {
    plan.Burn(kRight, Place::Of(Place::Kind::kBesideHold).ForHook(), 6.0);
    plan.Wait(kSpillSeconds);
  };
  all.insert(all.end() - 1, open);
  WritePlan(all, on.known, on.plan);
}

void BurnLiver(const Writing& on) {
  on.plan.Burn(kRight, Place::AtNode(on.known.liver_node).ForHook(), 15.0);
}

void BurnNearDuct(const Writing& on) {
  on.plan.Burn(kRight, Place::OnTube(on.known.hepatic_duct, 0.6).ForHook(), 0.5);
}

void BurnUnseen(const Writing& on) {
  on.plan.Burn(kRight, Place::At(on.port + 0.035 * Vec3{0.2, 0.1, -1.0}), 0.5);
}

void BurnAir(const Writing& on) {
  Place above_neck = Place::Of(Place::Kind::kAboveNode);
  above_neck.node = on.known.neck;
  above_neck.back = 0.05;
  on.plan.Burn(kRight, above_neck, 0.5);
}

void DropClip(const Writing& on) {
  on.Exchange(ToolKind::kClipApplier);
  on.plan.Jaw(kRight, 1.0);
  on.plan.Jaw(kRight, 0.0);
}

void GraspLiver(const Writing& on) {
  on.plan.Grasp(kLeft, Place::AtNode(on.known.liver_node));
}

/// A light grip, and a strong pull.
void PullHard(const Writing& on) {
  on.plan.Grasp(kLeft, Place::AtNode(on.known.hold), 0.17);
  on.plan.Draw(kLeft, {0.0, -0.09, 0.06});
  on.plan.Wait(1.0);
}

void CutIntoLiver(const Writing& on) {
  Place in_liver = Place::Of(Place::Kind::kInLiver);
  in_liver.back = -0.006;
  on.plan.Reach(kRight, in_liver, 0.5);
  on.plan.Add(SurgeonAct::Kind::kPressCutPedal, "press the pedal", 1.0);
  in_liver.back = 0.010;
  on.plan.Reach(kRight, in_liver, 0.1);
  on.plan.Add(SurgeonAct::Kind::kLiftFoot, "let go of the pedal", 1.0);
}

/// Exchanges a tool far from the picture, and does not look for it.
void InsertBlind(const Writing& on) {
  on.Exchange(ToolKind::kScissors);
  on.plan.Reach(kRight, Place::At(on.port + 0.10 * Vec3{0.6, -0.3, -0.7}));
  on.plan.Exchange(kRight, ToolKind::kHook, false);
  on.plan.Wait(3.0);
}

void RinseWhileItBleeds(const Writing& on) {
  on.plan.Assist(AssistantCommand::kRetract);
  CutArteryAndLook(on);
  on.Exchange(ToolKind::kSuctionIrrigator);
  for (int round = 0; round < 4; ++round)
    on.plan.Rinse(Place::Aim(on.known.cystic_artery, 0.65, kRinseFrom), 3.0, 4.0);
}

constexpr struct {
  OperationErrorScenario scenario;
  void (*write)(const Writing&);
} kErrorPlans[] = {
    {OperationErrorScenario::kClipsMainDuct, ClipMainDuct},
    {OperationErrorScenario::kCutsMainDuct, CutMainDuct},
    {OperationErrorScenario::kBurnsMainDuct, BurnMainDuct},
    {OperationErrorScenario::kCutsUnclipped, CutUnclipped},
    {OperationErrorScenario::kClipsEarly, ClipEarly},
    {OperationErrorScenario::kTooFewClips, ClipTooLittle},
    {OperationErrorScenario::kCrossesClips, CrossClips},
    {OperationErrorScenario::kClipsPartly, ClipPartly},
    {OperationErrorScenario::kBleeds, Bleed},
    {OperationErrorScenario::kSlipsClip, SlipClip},
    {OperationErrorScenario::kPerforates, Perforate},
    {OperationErrorScenario::kLeavesStones, LeaveStones},
    {OperationErrorScenario::kBurnsLiver, BurnLiver},
    {OperationErrorScenario::kBurnsNearDuct, BurnNearDuct},
    {OperationErrorScenario::kBurnsUnseen, BurnUnseen},
    {OperationErrorScenario::kBurnsAir, BurnAir},
    {OperationErrorScenario::kDropsClip, DropClip},
    {OperationErrorScenario::kGraspsLiver, GraspLiver},
    {OperationErrorScenario::kPullsHard, PullHard},
    {OperationErrorScenario::kCutsLiver, CutIntoLiver},
    {OperationErrorScenario::kInsertsBlind, InsertBlind},
    {OperationErrorScenario::kRinses, RinseWhileItBleeds},
};

}  // namespace

bool IsWholeOperation(OperationErrorScenario scenario) noexcept {
  return scenario == OperationErrorScenario::kNone || scenario == OperationErrorScenario::kLeavesStones;
}

void WriteErrorPlan(OperationErrorScenario scenario, const PatientKnowledge& known, const Vec3& p_world_port,
                    ActList& plan) {
  if (scenario == OperationErrorScenario::kNone) return WritePlan(CholecystectomyGoals(), known, plan);
  for (const auto& one : kErrorPlans)
    if (one.scenario == scenario) one.write({known, p_world_port, plan});
  plan.Wait(0.5);
}

/// Where the vessel is not between the legs, it is lined up anew: a little farther along, then a little nearer.
void CheckPlacedClip(Planning& on, const SurgeonAct& act) {
  const double length = instrument::FindTool("clip_applier")->jaw_length;
  const math::Pose& X_world_tool = on.view.Tool(kRight).X_world_tool;
  const Vec3 in = math::Inverse(X_world_tool) * on.view.TubePoint(act.tube, act.share);
  const bool is_between =
      math::Hypot(in.x, in.y) < kBetweenLegs && in.z > kFromTips && in.z < length - kFromTips;
  if (is_between || act.count == 0) {
    on.plan.SetJaw("close the clip", 0.0);
    // open enough to leave the clip, not so far that the next one comes
    on.plan.Jaw(kRight, 0.4);
    on.plan.Reach(kRight, Place::Aim(act.tube, act.share, kBack), 0.6);
    return;
  }
  on.plan.Reach(kRight, Place::Aim(act.tube, act.share, kStandOff));
  PlaceClip(on.plan, act.tube, act.share + (act.count % 2 == 0 ? kAnother : -2 * kAnother), act.amount,
            act.count - 1);
}

}  // namespace trocar::agent
