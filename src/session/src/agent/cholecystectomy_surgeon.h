// SPDX-License-Identifier: Apache-2.0
/// \file cholecystectomy_surgeon.h  Scripted surgeons of the cholecystectomy: one who does all of it, and careless ones.
///
/// They know the patient as a surgeon does, from what is seen: where ducts, gallbladder and fibres are now
/// (Snapshot), never what the simulation thinks of it but for what the window shows: the critical view.
#pragma once

#include <array>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "division_plan.h"
#include "heat_memory.h"
#include "patient_tissue.h"
#include "spread_plan.h"
#include "task_surgeon.h"
#include "trocar/collision/segment_distance.h"
#include "trocar/collision/triangle_tree.h"
#include "trocar/session/simulation.h"
#include "trocar/session/surgeon.h"

namespace trocar::session {

/// The one thing that a careless surgeon does wrong; kNone: the whole operation, well done.
enum class OperationFlaw {
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
  kInsertsBlind
};

class CholecystectomySurgeon final : public Surgeon {
 public:
  CholecystectomySurgeon(std::shared_ptr<const Scene> scene, const SurgeonSkill& skill, OperationFlaw flaw,
                         std::uint64_t seed);

  Input Act(const Snapshot& seen) override;
  bool HasFinished() const override { return has_finished_; }
  std::string_view Doing() const override { return doing_; }

 private:
  using Place = std::function<Vec3(const Snapshot&)>;
  static constexpr int kHoldTries = 3;
  using Nodes = std::function<bool(std::uint32_t)>;
  /// The other hand's part: it draws on what it holds, so that the fibres are stretched and lie open.
  struct Traction {
    double most = 0;         ///< way in all; 0: it rests [m]
    double most_pull = 0;    ///< above which it gives way [N]
    double enough_pull = 0;  ///< below which it draws on [N]
    std::vector<Vec3> ways;  ///< unit vectors, in turn when no fibre lies open any more
    std::size_t way = 0;
    Vec3 p_hold;       ///< of the tip, when it began [m]
    double drawn = 0;  ///< [m]
    bool is_swinging = false;
    int swings_left = 0;
    double seconds = 0;             ///< since the last swing, or since it was worth its while [s]
    std::size_t fibres_before = 0;  ///< that were left then
  };
  /// The fibre that the hook goes to, or has on its toe.
  struct HookTarget {
    std::int32_t fibre = -1;                    ///< among the dissection's
    double spin = 0;                            ///< of the hook [rad]
    std::deque<Vec3> path;                      ///< of the tip, after where it goes now [m]
    Vec3 aside;                                 ///< by which the tip is led to the fibre [m]
    double seconds = 0, apart = 0, heated = 0;  ///< in all, beside it, with current [s]
  };
  /// What is dissected with the hook, until none is left that can be reached.
  struct DissectionGoal {
    std::string what;
    std::vector<std::uint32_t> strands;
    std::vector<double> order;  ///< (strands) what comes first [m]
    double enough = 1.0;        ///< share that is to be parted [-]
    std::function<bool(const Snapshot&)> is_enough = {};
    double traction = 0;  ///< see Traction::most
    Vec3 way = {};        ///< of it, unit vector
    Nodes may_hold = {};  ///< what is free already: it bears a stronger pull
  };
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
  };
  /// Fibres that are parted bluntly, by opening jaws among them.
  struct Spreading {
    std::vector<std::uint32_t> strands;
    std::vector<double> weights;  ///< (strands)
    std::vector<std::uint8_t> tries;
    std::function<bool(const Snapshot&)> is_enough;
    enum class Stage { kChoose, kApproach, kEnter, kOpen } stage = Stage::kChoose;
    SpreadPose pose;
    std::size_t left_before = 0;
    std::uint32_t aim = 0;  ///< among strands
    int fruitless = 0;
    std::string what;
  };
  /// Clips and cuts of tubes, until each is divided.
  struct Division {
    std::vector<std::size_t> tubes;
    std::vector<std::vector<double>> avoid;  ///< (tubes) arcs at which it has failed [m]
    int acts_left = 0;
    double care = 1.0;  ///< see DivisionField
  };

  void Learn(PatientTissue tissue);
  void PlanOperation();
  void PlanFlaw(OperationFlaw flaw);
  void FreeGallbladder();

  // verbs
  void Add(std::string doing, std::function<void(const Snapshot&)> begin,
           std::function<bool(const Snapshot&)> is_done, double patience);
  void Reach(int hand, Place tip, double hurry = 1);
  void Jaw(int hand, double share);
  void Wait(double seconds);
  void Exchange(int hand, instrument::ToolKind kind, bool over_field = true);
  void Grasp(int hand, const Place& at, double squeeze = 0);
  void Draw(int hand, const Vec3& by);
  void DrawGently(int hand, const Vec3& by);
  void LetGo(int hand);
  void Ease(int hand);
  void LineUp(const std::string& what, std::size_t tube, double share, double jaw);
  void PlaceClip(std::size_t tube, double share, double beyond = 0.5, int tries = 2);
  void CloseClip(std::size_t tube, double share);
  void CutTube(std::size_t tube, double share);
  void Burn(int hand, const Place& at, double seconds);
  void Dissect(DissectionGoal goal);
  bool GoOnDissecting(Dissection& work, const Snapshot& seen);
  void WorkOnFibre(Dissection& work, const Snapshot& seen);
  double ChooseFibre(Dissection& work, const Snapshot& seen);
  Traction PlanTraction(const DissectionGoal& goal) const;
  bool TakeUpSlack(Traction& traction, const Snapshot& seen, double parted);
  void LeaveFibre(Dissection& work);
  void BackOff();
  void Swing(Dissection& work);
  void GoOnSwinging(Traction& traction, const Snapshot& seen);
  Vec3 HookStand(const Snapshot& seen, std::uint32_t strand, double spin) const;
  void Approach(HookTarget& target, const Vec3& tip);
  void LookAt(Place target, double turn, double distance);
  /// Plans on when it is reached, from what is seen then.
  void Decide(std::string doing, std::function<void(const Snapshot&)> plan);
  /// \param may  nodes that may be held; none: any
  void HoldOn(const Place& near, int tries = kHoldTries, const Nodes& may = {});
  void Spread(std::shared_ptr<Spreading> work);
  bool GoOnSpreading(Spreading& work, const Snapshot& seen);
  void GoOn(std::shared_ptr<Dissection> work);

  // the operation's parts
  void ClearTriangle(int rounds);
  void FreeLowerThird(int rounds);
  void ShowCriticalView(int rounds);
  void LookFromSide(int side, int tries);
  std::optional<instrument::TrocarJoints> FindSideView(const Snapshot& seen, int side);
  std::optional<std::size_t> FindExtraArtery(const Snapshot& seen);
  void Divide(std::vector<std::size_t> tubes, int rounds = 3);
  void GoOnDividing(const std::shared_ptr<Division>& work, const Snapshot& seen);
  void ClipAt(const std::shared_ptr<Division>& work, std::size_t which, double arc);
  void CloseWhenBetween(const std::shared_ptr<Division>& work, std::size_t which, double arc, int tries);
  void CutAt(const std::shared_ptr<Division>& work, std::size_t which, double arc);
  void Withdraw();
  void StopBleeding(int rounds = 4);
  void Take(instrument::ToolKind kind);
  void FreeFromBed(int rounds);
  void Remove();

  // knowledge
  std::vector<std::uint32_t> TriangleStrands() const;
  std::vector<std::uint32_t> CoveringStrands() const;
  std::vector<std::uint32_t> BedStrands(double share) const;
  bool IsNearMain(const Vec3& p, double distance) const;
  double EndDistance(const Snapshot& seen, const collision::Segment& segment) const;
  double CalcAzimuth(const Snapshot& seen, const Vec3& eye) const;
  bool AreTubesBare(const Snapshot& seen) const;
  std::vector<std::uint32_t> PeelStrands(const Snapshot& seen, const std::vector<std::uint32_t>& bed) const;
  Place MiddleOf(std::vector<std::uint32_t> strands) const;
  double ShareLeft(const Snapshot& seen, const std::vector<std::uint32_t>& strands) const;
  TubeLine LineOf(const Snapshot& seen, std::size_t tube) const;
  std::vector<TubeLine> LinesOf(const Snapshot& seen) const;
  std::vector<double> ClipsOn(const Snapshot& seen, std::size_t tube) const;
  bool IsDivided(const Snapshot& seen, std::size_t tube) const;
  DivisionField FieldOf(const Snapshot& seen, std::size_t tube, const std::vector<TubeLine>& lines,
                        double care);
  double Clearance(const Snapshot& seen, const collision::Segment& segment);
  std::uint32_t FindHold(const Snapshot& seen, const Vec3& near, const std::vector<std::uint32_t>& avoid,
                         const Nodes& may);
  void FollowWithCamera(const Snapshot& seen);
  void AimCamera(const Vec3& p, const Vec3& facing, double distance);
  Vec3 TubePoint(const Snapshot& seen, std::size_t tube, double share) const;
  Vec3 TubeDirection(const Snapshot& seen, std::size_t tube, double share) const;
  std::uint32_t FindNode(std::int32_t organ, const Vec3& p) const;
  std::size_t FindTube(std::string_view name) const;
  Vec3 HookTip(const Vec3& at) const;
  Vec3 HookToe(const Vec3& at, double spin) const;
  struct HookWay {
    double spin = 0;   ///< of the hook [rad]
    double clear = 0;  ///< that the shaft passes by organs [m]
  };
  HookWay FindHookWay(const Snapshot& seen, const Vec3& at);
  Vec3 HookPoint(const Snapshot& seen) const;
  collision::Segment HookWire(const Snapshot& seen) const;
  Vec3 HookedPoint(const Snapshot& seen, std::uint32_t strand) const;
  /// Nearest points of the hook's wire and of a fibre.
  collision::SegmentSegmentPoints HookGap(const Snapshot& seen, std::uint32_t strand) const;
  /// That far beyond a point of a tube, as seen from the right hand's trocar; negative: before it.
  Vec3 Aim(const Snapshot& seen, std::size_t tube, double share, double ahead) const;
  Vec3 WallBesideHold(const Snapshot& seen) const;
  HandMotion& HandOf(int hand) { return hands_[static_cast<std::size_t>(hand)]; }

  std::shared_ptr<const Scene> scene_;
  std::array<HandMotion, kHandCount> hands_;
  std::array<HandControls, kHandCount> controls_;
  AssistantCommand assistant_ = AssistantCommand::kWait;
  instrument::TrocarJoints camera_, camera_to_;

  std::vector<StrandInfo> strands_;
  std::vector<SurfaceInfo> surfaces_;
  std::vector<Vec3> rest_;
  std::vector<std::vector<std::uint32_t>>
      tube_nodes_;                         // (tubes) from the gallbladder's end, where one enters it
  std::vector<std::uint32_t> neck_nodes_;  // around the infundibulum
  double first_azimuth_ = 0;               // of the lens, at the start [rad]
  bool has_looked_ = false;
  bool has_view_ = false;                       // the critical view was achieved
  bool stops_ = false;                          // bails out: it is not safe to go on
  std::vector<std::size_t> entering_;           // tubes that enter the gallbladder
  std::vector<std::uint32_t> end_strands_;      // where they do
  std::vector<std::uint32_t> main_nodes_;       // of ducts and arteries that must stay
  std::vector<std::uint32_t> main_ducts_;       // of the ducts among them
  std::vector<std::uint32_t> careful_nodes_;    // of those arteries, and of small ducts of the bed
  std::vector<collision::TriangleTree> trees_;  // (organs)
  std::uint64_t trees_tick_ = 0;                // of the snapshot that they follow
  std::uint32_t neck_ = 0, hold_ = 0, fundus_ = 0, liver_node_ = 0;
  Vec3 bed_normal_;                          // from the liver towards the gallbladder, at rest
  std::deque<SurgicalAct> acts_, inserted_;  // the latter by the act that is under way, to be done next
  bool has_begun_ = false, has_finished_ = false;
  double act_seconds_ = 0;
  Place field_;                  // what the picture is about
  bool camera_follows_ = false;  // the right hand's tool
  double unseen_seconds_ = 0;
  double unheld_seconds_ = 0;
  std::vector<std::uint32_t> missed_holds_;
  HeatMemory heat_;
  double beyond_ = 0.5;  // share of the jaws that goes past the vessel [-]
  Vec3 offset_;          // by which the right hand aims beside what it wants to meet [m]
  std::string doing_;
};

/// Whether a scene is one that they can operate on.
bool IsCholecystectomy(const Scene& scene);

}  // namespace trocar::session
