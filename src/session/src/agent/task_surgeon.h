// SPDX-License-Identifier: Apache-2.0
/// \file task_surgeon.h  A surgeon who reads a task's goals and does them with a few verbs; and one who errs.
#pragma once

#include <array>
#include <deque>
#include <functional>
#include <memory>
#include <string>

#include "trocar/math/random.h"
#include "trocar/session/hand_motion.h"
#include "trocar/session/surgeon.h"

namespace trocar::session {

/// How a surgeon works.
struct SurgeonSkill {
  HandSkill hand;
  double pause = 0.05;         ///< before each act, at most [s]
  double miss_share = 0;       ///< of grasps that first close beside the thing [-]
  double camera_speed = 0.09;  ///< of the lens [m/s]
};

/// The one thing that a careless surgeon does wrong, once.
enum class Flaw {
  kNone,
  kDrops,          ///< opens the jaws in the air
  kLoses,          ///< carries a thing out of the picture and drops it there
  kTouchesWire,    ///< strays from the path of a thing that must touch nothing
  kPressesBoard,   ///< pushes a tip into what lies under it
  kLeavesView,     ///< takes a tip out of the picture
  kClashes,        ///< runs one tool into the other
  kPullsApart,     ///< pulls with both hands at one thing
  kSmearsLens,     ///< takes the lens too near
  kClipsAstray,    ///< closes a clip off its mark
  kCrossesClips,   ///< closes a clip over another
  kClipsPartly,    ///< closes a clip around a part of the duct
  kDropsClip,      ///< closes a clip around nothing
  kCutsAstray,     ///< cuts the duct in the wrong place
  kCutsUnclipped,  ///< cuts the duct before the clips are on
  kBurnsSpared,    ///< burns a band that is to be spared
  kCutsAside,      ///< cuts a sheet beside its line
  kBurnsAir,       ///< presses the pedal in the air
  kBurnsUnseen,    ///< presses it out of the picture
  kDawdles         ///< does not get on before the time is over
};

/// One thing to do: begun once, then waited for.
struct SurgicalAct {
  std::string doing;
  std::function<void(const Snapshot&)> begin;
  std::function<bool(const Snapshot&)> is_done;
  double patience = 6.0;  ///< then the whole plan is made anew [s]
};

class TaskSurgeon final : public Surgeon {
 public:
  TaskSurgeon(std::shared_ptr<const Scene> scene, const SurgeonSkill& skill, Flaw flaw, std::uint64_t seed);

  Input Act(const Snapshot& seen) override;
  bool HasFinished() const override { return has_finished_; }
  std::string_view Doing() const override { return doing_; }

 private:
  // plans: task_surgeon.cpp
  void Plan(const Snapshot& seen);
  void PlanStep(const Snapshot& seen, const Goal& goal, std::uint32_t step);
  void PlanPlace(const Snapshot& seen, int object, const std::vector<int>& regions);
  void PlanHandOver(const Snapshot& seen, int object, int from, int to, bool in_place);
  bool IsLost(const Snapshot& seen, const Goal& goal) const;
  int ChooseHand(const Snapshot& seen, int object, int wanted) const;
  // verbs: task_verbs.cpp
  void Add(std::string doing, std::function<void(const Snapshot&)> begin,
           std::function<bool(const Snapshot&)> is_done, double patience = 6.0);
  void Reach(int hand, const std::function<Vec3(const Snapshot&)>& p_world_tip, double hurry = 1);
  void ReachPoint(int hand, const Vec3& p_world_tip, double hurry = 1);
  void PickUp(int hand, int object, int grip);
  void Carry(int hand, int object, const Vec3& p_world_object, double hurry = 1);
  void Rise(int hand, double height);
  void LetGo(int hand);
  void WithDraw(int hand);
  void Look(const Region& region, double distance);
  void Wait(double seconds);
  // verbs and plans for tissue: task_tissue_verbs.cpp
  /// A place on a duct or a band, by the rows of Snapshot::positions between which it was at rest.
  struct TissueSpot {
    std::uint32_t a = 0, b = 0;
    double t = 0;
    Vec3 At(const Snapshot& seen) const { return math::Lerp(seen.positions[a], seen.positions[b], t); }
    Vec3 Along(const Snapshot& seen) const { return math::Normalized(seen.positions[b] - seen.positions[a]); }
  };
  TissueSpot FindOnTube(const Vec3& p_rest) const;
  void PlanTissue(const Snapshot& seen, const Condition& wanted);
  int TakeTool(const Snapshot& seen, instrument::ToolKind kind);
  void LineUp(int hand, const TissueSpot& spot, double jaw);
  void Advance(int hand, const TissueSpot& spot, double ahead);
  void CloseClip(const Snapshot& seen, const Vec3& p_rest, double depth_share);
  void CutTube(const Snapshot& seen, const Vec3& p_rest);
  double FindClearPlace(const Snapshot& seen, int band) const;
  void BurnBand(const Snapshot& seen, int band);
  void PressPedal(int hand, double seconds);
  void CutCircle(const Snapshot& seen, int sheet, double aside, double turns);
  void FollowSheet(int hand, const Vec3& p_sheet, double hurry);
  Vec3 FindTip(const Snapshot& seen, int hand, int object, const Vec3& p_world_object) const;
  Vec3 GripTip(const Snapshot& seen, int hand, int object, int grip, double back) const;
  // errors: task_flaws.cpp
  bool AddFlaw(const Snapshot& seen, int hand, int object, bool on_path = false);
  bool AddIdleFlaw(const Snapshot& seen);
  bool AddTissueFlaw(const Snapshot& seen, const Condition& wanted);  // task_tissue_flaws.cpp
  Vec3 FindAstray(const Vec3& p_rest) const;

  void MoveCamera(const instrument::TrocarJoints& to);
  void StepCamera(double dt);
  HandMotion& HandOf(int hand) { return hands_[static_cast<std::size_t>(hand)]; }

  std::shared_ptr<const Scene> scene_;
  SurgeonSkill skill_;
  Flaw flaw_;
  math::Random random_;
  std::array<HandMotion, kHandCount> hands_;
  std::array<HandControls, kHandCount> controls_;
  std::vector<Vec3> start_;              // Snapshot::positions when it began
  std::vector<TubePiece> start_pieces_;  // and its ducts
  instrument::TrocarJoints camera_, camera_from_, camera_to_;
  double camera_time_ = 0, camera_duration_ = 0;
  std::deque<SurgicalAct> acts_;
  bool has_begun_ = false;
  double act_seconds_ = 0, pause_ = 0;
  int fruitless_plans_ = 0;
  std::uint64_t steps_seen_ = 0;
  bool has_finished_ = false;
  std::string doing_, goal_name_;
};

}  // namespace trocar::session
