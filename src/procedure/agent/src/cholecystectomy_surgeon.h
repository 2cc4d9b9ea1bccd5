// SPDX-License-Identifier: Apache-2.0
/// \file cholecystectomy_surgeon.h  Scripted surgeons of the cholecystectomy: one who does all of it, and careless ones.
///
/// They know the patient as a surgeon does, from what is seen: where ducts, gallbladder and fibres are now
/// (Snapshot), never what the simulation thinks of it but for what the window shows: the critical view.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "division_plan.h"
#include "heat_memory.h"
#include "operation_plan.h"
#include "spread_plan.h"
#include "task_surgeon.h"
#include "trocar/agent/surgeon.h"
#include "trocar/collision/segment_distance.h"
#include "trocar/collision/triangle_tree.h"
#include "trocar/roles/roles.h"
#include "trocar/simulation/model_description.h"

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

class CholecystectomySurgeon final : public Surgeon {
 public:
  CholecystectomySurgeon(std::shared_ptr<const scene::Scene> scene, const SurgeonSkill& skill,
                         OperationErrorScenario error_scenario, std::uint64_t seed);

  scene::Input Act(const simulation::Snapshot& seen) override;
  bool HasFinished() const override { return has_finished_; }
  std::string_view Doing() const override { return doing_; }
  std::string_view BailOutReason() const override { return bail_out_; }
  void VisitState(base::StateArchive& archive) override;
  void KnowFirstView(const instrument::TrocarJoints& laparoscope) override;

 private:
  static constexpr int kHoldTries = 3;
  static constexpr int kNeckTurns = 7;     // of the hold, to show the neck from another side
  static constexpr int kTriangleWays = 4;  // other ways to hold the neck, where fat cannot be reached
  static constexpr int kSharpRounds = 2;  // with scissors, where jaws and hook do not come to the last fibres
  static constexpr double kCleared = 0.91;  // of the triangle: a little more than the view asks [-]
  static constexpr std::uint64_t kNever = ~std::uint64_t{0};

  void Learn(simulation::ModelDescription model);
  void PlanOperation();
  void PlanErrorScenario(OperationErrorScenario error_scenario);
  void PullHard();
  void CutIntoLiver();
  void InsertBlind();
  void FreeGallbladder();

  // what is under way
  void Begin(const SurgeonAct& act, const simulation::Snapshot& seen);
  bool IsDone(const SurgeonAct& act, const simulation::Snapshot& seen);
  /// Plans on; what it adds is done next.
  void PlanOn(const SurgeonAct& act, const simulation::Snapshot& seen);
  SurgeonAct& Add(SurgeonAct::Kind kind, std::string doing, double time_limit);
  /// Adds an act that plans on when it is reached, from what is seen then.
  SurgeonAct& Decide(SurgeonAct::Kind kind, std::string doing) { return Add(kind, std::move(doing), 1.0); }
  math::Vec3 Find(const Place& place, const simulation::Snapshot& seen) const;
  math::Vec3 FindUnhooked(const Place& place, const simulation::Snapshot& seen) const;

  // verbs
  void Reach(int hand, const Place& tip, double hurry = 1);
  void Jaw(int hand, double share);
  void Wait(double seconds);
  void Exchange(int hand, instrument::ToolKind kind, bool over_field = true);
  void Grasp(int hand, const Place& at, double squeeze = 0);
  void Draw(int hand, const math::Vec3& by);
  void DrawGently(int hand, const math::Vec3& by, double roll = 0);
  void LetGo(int hand);
  void Ease(int hand);
  void LineUp(const std::string& what, std::size_t tube, double share, double jaw);
  void LineUpTool(const SurgeonAct& act, const simulation::Snapshot& seen);
  void PlaceClip(std::size_t tube, double share, double beyond = 0.5, int tries = 2);
  void CloseClip(std::size_t tube, double share);
  void CutTube(std::size_t tube, double share);
  void Burn(int hand, const Place& at, double seconds);
  void Rinse(const Place& at, double rinse_seconds, double aspirate_seconds);
  void SetJaw(std::string doing, double jaw);
  void Dissect(DissectionGoal goal);
  bool GoOnDissecting(Dissection& work, const simulation::Snapshot& seen);
  void WorkOnFibre(Dissection& work, const simulation::Snapshot& seen);
  double ChooseFibre(Dissection& work, const simulation::Snapshot& seen);
  Traction PlanTraction(const DissectionGoal& goal) const;
  bool TakeUpSlack(Traction& traction, const simulation::Snapshot& seen, double parted);
  void LeaveFibre(Dissection& work);
  void BackOff();
  void Swing(Dissection& work);
  void GoOnSwinging(Traction& traction, const simulation::Snapshot& seen);
  math::Vec3 HookStand(const simulation::Snapshot& seen, std::uint32_t strand, double spin) const;
  void Approach(HookTarget& target, const math::Vec3& tip);
  void LookAt(const Place& target, double turn, double distance);
  void HoldOn(const Place& near, int tries = kHoldTries, const HoldFilter& may = {});
  void Spread();
  bool GoOnSpreading(Spreading& work, const simulation::Snapshot& seen);
  SpreadField SeeSpreadField(const Spreading& work, const simulation::Snapshot& seen,
                             std::vector<std::uint32_t>& index);
  static const instrument::Tool* ToolOf(const Spreading& work);
  bool MayClose(const Spreading& work, const simulation::Snapshot& seen);
  void GoOn();
  bool GoOnOrHoldAnew(const simulation::Snapshot& seen);
  bool IsEnough(const DissectionGoal& goal, const simulation::Snapshot& seen) const;

  // the operation's parts
  void ChooseHold(const SurgeonAct& act, const simulation::Snapshot& seen);
  void TakeHold(const SurgeonAct& act, const simulation::Snapshot& seen);
  void CheckHold(const SurgeonAct& act, const simulation::Snapshot& seen);
  void ClearTriangle(int rounds, bool is_second_look = false);
  void PlanTriangle(const SurgeonAct& act, const simulation::Snapshot& seen);
  void CheckTriangle(const SurgeonAct& act, const simulation::Snapshot& seen);
  void SwingOutOfWay(const simulation::Snapshot& seen, DissectionGoal& goal);
  void OpenTriangle(const SurgeonAct& act, const simulation::Snapshot& seen);
  bool CutLastFibres(const SurgeonAct& act, const simulation::Snapshot& seen);
  void TurnNeck(const simulation::Snapshot& seen, int side, double by, double turn = 0);
  void GoRoundDuct(const simulation::Snapshot& seen, double angle);
  void FreeFromFundus(int rounds);
  void PlanFundusFirst(const SurgeonAct& act, const simulation::Snapshot& seen);
  void BailOut(std::string reason);
  bool WatchProgress(const SurgeonAct& act, const simulation::Snapshot& seen);
  std::string ExplainMissingView(const simulation::Snapshot& seen) const;
  void PlanLowerThird(const SurgeonAct& act, const simulation::Snapshot& seen);
  void PlanCriticalView(const SurgeonAct& act, const simulation::Snapshot& seen);
  void PlanLookFromSide(const SurgeonAct& act, const simulation::Snapshot& seen);
  void PlanBed(const SurgeonAct& act, const simulation::Snapshot& seen);
  void CheckPlacedClip(const SurgeonAct& act, const simulation::Snapshot& seen);
  void FreeLowerThird(int rounds);
  void ShowCriticalView(int rounds);
  void LookFromSide(int side, int tries = kNeckTurns, bool is_last_hold = false);
  void LookPastShaft(std::size_t which, double arc);
  void PlanLookPastShaft(const SurgeonAct& act, const simulation::Snapshot& seen);
  std::optional<instrument::TrocarJoints> FindSideView(const simulation::Snapshot& seen, int side,
                                                       double aside);
  void UpdateSight(const simulation::Snapshot& seen);
  bool Shows(const simulation::Snapshot& seen, const math::Pose& X_world_lens,
             std::span<const math::Vec3> points);
  std::optional<std::size_t> FindExtraArtery(const simulation::Snapshot& seen);
  void Divide(std::vector<std::size_t> tubes, int rounds = 3);
  void PlanDivision(const SurgeonAct& act, const simulation::Snapshot& seen);
  void GoOnDividing(const simulation::Snapshot& seen);
  void ClipAt(std::size_t which, double arc);
  void LineUpClip(const SurgeonAct& act, const simulation::Snapshot& seen);
  void LineUpScissors(const SurgeonAct& act, const simulation::Snapshot& seen);
  void CloseWhenBetween(std::size_t which, double arc, int tries);
  void CheckClip(const SurgeonAct& act, const simulation::Snapshot& seen);
  void CutAt(std::size_t which, double arc);
  void CheckBlades(const SurgeonAct& act, const simulation::Snapshot& seen);
  void CheckBeforeCut(const SurgeonAct& act, const simulation::Snapshot& seen);
  void PlanCoagulation(const SurgeonAct& act, const simulation::Snapshot& seen);
  void Withdraw();
  void StopBleeding(int rounds = 4);
  void Take(instrument::ToolKind kind);
  void FreeFromBed(int rounds);
  void Remove();

  // knowledge
  std::vector<std::uint32_t> CoveringStrands(const simulation::Snapshot& seen) const;
  std::vector<std::uint32_t> BedStrands(double share) const;
  double EndDistance(const simulation::Snapshot& seen, const collision::Segment& segment) const;
  double CalcAzimuth(std::span<const math::Vec3> positions, const math::Vec3& eye) const;
  bool AreTubesBare(const simulation::Snapshot& seen) const;
  bool IsTriangleClear(const simulation::Snapshot& seen) const;
  bool MayHold(const HoldFilter& may, std::uint32_t node) const;
  math::Vec3 BedAxis() const;  // from the infundibulum to the fundus, at rest
  std::vector<std::uint32_t> PeelStrands(const simulation::Snapshot& seen,
                                         const std::vector<std::uint32_t>& bed,
                                         bool is_from_fundus = false) const;
  std::vector<double> BedOrder(const std::vector<std::uint32_t>& bed, bool is_from_fundus = false) const;
  Place MiddleOf(std::vector<std::uint32_t> strands) const;
  bool HangsFree(const simulation::Snapshot& seen) const;
  double ShareLeft(const simulation::Snapshot& seen, const std::vector<std::uint32_t>& strands) const;
  TubeLine LineOf(const simulation::Snapshot& seen, std::size_t tube) const;
  std::vector<TubeLine> LinesOf(const simulation::Snapshot& seen) const;
  std::vector<double> ClipsOn(const simulation::Snapshot& seen, std::size_t tube) const;
  bool IsDivided(const simulation::Snapshot& seen, std::size_t tube) const;
  DivisionField FieldOf(const simulation::Snapshot& seen, std::size_t tube,
                        const std::vector<TubeLine>& lines, double care);
  double Clearance(const simulation::Snapshot& seen, const collision::Segment& segment);
  std::uint32_t FindHold(const simulation::Snapshot& seen, const math::Vec3& near,
                         const std::vector<std::uint32_t>& avoid, const HoldFilter& may);
  void FollowWithCamera(const simulation::Snapshot& seen);
  void AimCamera(const math::Vec3& p, const math::Vec3& facing, double distance);
  math::Vec3 TubePoint(const simulation::Snapshot& seen, std::size_t tube, double share) const;
  math::Vec3 TubeDirection(const simulation::Snapshot& seen, std::size_t tube, double share) const;
  std::uint32_t FindNode(std::int32_t organ, const math::Vec3& p) const;
  std::size_t FindTube(roles::TubeRole role) const;
  math::Vec3 HookTip(const math::Vec3& at) const;
  math::Vec3 HookToe(const math::Vec3& at, double spin) const;
  struct HookWay {
    double spin = 0;   ///< of the hook [rad]
    double clear = 0;  ///< that the shaft passes by organs [m]
  };
  HookWay FindHookWay(const simulation::Snapshot& seen, const math::Vec3& at);
  math::Vec3 HookPoint(const simulation::Snapshot& seen) const;
  collision::Segment HookWire(const simulation::Snapshot& seen) const;
  math::Vec3 HookedPoint(const simulation::Snapshot& seen, std::uint32_t strand) const;
  /// Nearest points of the hook's wire and of a fibre.
  collision::SegmentSegmentPoints HookGap(const simulation::Snapshot& seen, std::uint32_t strand) const;
  /// That far beyond a point of a tube, as seen from the right hand's trocar; negative: before it.
  math::Vec3 Aim(const simulation::Snapshot& seen, std::size_t tube, double share, double ahead) const;
  math::Vec3 WallBesideHold(const simulation::Snapshot& seen) const;
  HandMotion& HandOf(int hand) { return hands_[static_cast<std::size_t>(hand)]; }

  std::shared_ptr<const scene::Scene> scene_;
  std::array<HandMotion, instrument::kHandCount> hands_;
  std::array<scene::HandControls, instrument::kHandCount> controls_;
  scene::AssistantCommand assistant_ = scene::AssistantCommand::kWait;
  /// Camera work of this operator: the laparoscope's joints now and to come, and the part of the field that it shows.
  struct Picture {
    instrument::TrocarJoints camera, to;
    Place field;               // what it is about
    bool follows = false;      // the right hand's tool
    double first_azimuth = 0;  // of the lens, at the start [rad]
    double unseen_seconds = 0;
  };
  Picture picture_;

  /// Knowledge of the patient before the first cut; constant.
  struct Knowledge {
    std::vector<scene::StrandInfo> strands;
    std::vector<scene::SurfaceInfo> surfaces;
    std::int32_t gallbladder = -1, liver = -1;  // of surfaces
    std::vector<math::Vec3> rest;
    std::vector<std::vector<std::uint32_t>>
        tube_nodes;                             // (tubes) from the gallbladder's end, where one enters it
    std::vector<std::uint32_t> neck_nodes;      // around the infundibulum
    std::vector<std::size_t> entering;          // tubes that enter the gallbladder
    std::vector<std::uint32_t> end_strands;     // where they do
    std::vector<std::uint32_t> window_strands;  // fat over the hepatocystic triangle's window
    std::vector<std::uint32_t> main_nodes;      // of ducts and arteries that must stay
    std::vector<std::uint32_t> main_ducts;      // of the ducts among them
    std::vector<double> exposable;              // (tubes) what may be asked to lie bare [m]
    std::vector<std::uint32_t> careful_nodes;   // of those arteries, and of small ducts of the bed
    std::uint32_t neck = 0, hold = 0, fundus = 0, liver_node = 0;
    math::Vec3 bed_normal;  // from the liver towards the gallbladder, at rest
  };
  Knowledge known_;

  bool has_view_ = false;  // the critical view was achieved
  bool stops_ = false;     // bails out: it is not safe to go on
  bool operates_ = true;   // means to finish; constant
  std::string bail_out_;   // why it stopped
  int triangle_ways_left_ = kTriangleWays, sharp_rounds_left_ = kSharpRounds;
  bool has_begun_at_fundus_ = false;
  /// Whether the work gets on: fibres that are left, and since when none parted while it dissected.
  struct Progress {
    std::size_t fibres_left = 0;
    double stuck_seconds = 0, seconds = 0;  // the latter since it began [s]
  };
  Progress progress_;
  std::vector<collision::TriangleTree> trees_;  // (organs)
  std::uint64_t trees_tick_ = kNever;           // of the snapshot that they follow
  cholecystectomy::TriangleSight sight_;        // by the fat that was left when it was last asked
  std::deque<SurgeonAct> acts_,
      inserted_;           // the latter by the act that is under way, to be done next; empty between ticks
  Dissection dissection_;  // that is under way, or planned next
  Spreading spreading_;
  Division division_;
  bool has_begun_ = false, has_finished_ = false;
  double act_seconds_ = 0;
  double unheld_seconds_ = 0;
  std::vector<std::uint32_t> missed_holds_;
  HeatMemory heat_;
  double beyond_ = 0.5;  // share of the jaws that goes past the vessel [-]
  math::Vec3 offset_;    // by which the right hand aims beside what it wants to meet [m]
  std::string doing_;
};

/// Whether a scene is one that they can operate on.
bool IsCholecystectomy(const scene::Scene& scene);

}  // namespace trocar::agent
