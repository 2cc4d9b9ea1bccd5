// SPDX-License-Identifier: Apache-2.0
/// \file task_surgeon.h  A surgeon who reads a task's goals and does them with a few verbs; and one who errs.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "trocar/agent/hand_motion.h"
#include "trocar/agent/skill.h"
#include "trocar/agent/surgeon.h"
#include "trocar/base/state_archive.h"
#include "trocar/math/random.h"

namespace trocar::agent {

/// The one thing that a careless surgeon does wrong, once.
enum class ErrorScenario : std::uint8_t {
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

/// A place on a duct or a band, by the rows of Snapshot::positions between which it was at rest.
struct TissueSpot {
  std::uint32_t a = 0, b = 0;
  double t = 0;

  math::Vec3 At(const simulation::Snapshot& seen) const {
    return math::Lerp(seen.positions[a], seen.positions[b], t);
  }
  math::Vec3 Along(const simulation::Snapshot& seen) const {
    return math::Normalized(seen.positions[b] - seen.positions[a]);
  }
  void VisitState(base::StateArchive& archive);
};

/// One thing to do: begun once, then waited for. A value, so that a plan can be saved.
struct TaskAct {
  enum class Kind : std::uint8_t {
    kReachPoint,     ///< the tip goes to `p`
    kReachGrip,      ///< to the grip of `object`, `p` beside it
    kReachSpot,      ///< `amount` beyond `spot`, along the shaft
    kMoveBy,         ///< by `p`
    kGoBack,         ///< by `amount`, along the shaft
    kCarry,          ///< `object`, which is held, goes to `p`
    kReachFor,       ///< open jaws wait before the grip of `object`
    kCloseOn,        ///< until `object` is held
    kLetGo,          ///< opens the jaws
    kSetJaw,         ///< to `amount`, for `seconds`
    kLook,           ///< the camera goes to `camera`
    kWait,           ///< for `seconds`
    kPass,           ///< nothing, in one tick
    kExchangeTool,   ///< for `tool`
    kLineUp,         ///< before `spot`, the jaws across it and open by `amount`
    kPressPedal,     ///< to coagulate, for `seconds`
    kPressCutPedal,  ///< and leave the foot on it
    kLiftFoot,       ///< off that pedal
    kFollowSheet,    ///< the hook's toe, which points down, goes to `p`
    kReachBand,      ///< the hook's toe along `q`, which will be at `p`, waits before it
    kBurnBand        ///< until `object`, a band, parts
  } kind = Kind::kPass;
  std::string doing;
  double time_limit = 6.0;  ///< then the whole plan is made anew [s]
  std::int32_t hand = instrument::kLeft;
  std::int32_t object = -1;  ///< Scene::objects, or a band
  std::int32_t grip = 0;     ///< of SceneObject::grips
  std::uint8_t tool = 0;     ///< of the hand's tray
  math::Vec3 p, q;           ///< [m]
  TissueSpot spot;
  double hurry = 1;    ///< times the skill's speed
  double amount = 0;   ///< [m] or [rad]
  double seconds = 0;  ///< [s]
  instrument::TrocarJoints camera;

  void VisitState(base::StateArchive& archive);
};

/// A training task, with a patient or without one. An operation has plans of its own, also where a task asks for a part of it.
bool IsDoneByGoals(const scene::Scene& scene) noexcept;

class TaskSurgeon final : public Surgeon {
 public:
  TaskSurgeon(std::shared_ptr<const scene::Scene> scene, const SurgeonSkill& skill,
              ErrorScenario error_scenario, std::uint64_t seed);

  scene::Input Act(const simulation::Snapshot& seen) override;
  bool HasFinished() const override { return has_finished_; }
  std::string_view Doing() const override { return doing_; }
  void VisitState(base::StateArchive& archive) override;

 private:
  // plans: task_surgeon.cpp
  void Plan(const simulation::Snapshot& seen);
  void PlanStep(const simulation::Snapshot& seen, const scene::Goal& goal, std::uint32_t step);
  void PlanPlace(const simulation::Snapshot& seen, int object, const std::vector<int>& regions);
  void PlanHandOver(const simulation::Snapshot& seen, int object, int from, int to, bool in_place);
  bool IsLost(const simulation::Snapshot& seen, const scene::Goal& goal) const;
  int ChooseHand(const simulation::Snapshot& seen, int object, int wanted) const;
  // verbs: task_verbs.cpp
  void Begin(const TaskAct& act, const simulation::Snapshot& seen);
  bool IsDone(const TaskAct& act, const simulation::Snapshot& seen);
  void BeginReachFor(const TaskAct& act, const simulation::Snapshot& seen);
  void BeginLineUp(const TaskAct& act, const simulation::Snapshot& seen);
  void BeginFollowSheet(const TaskAct& act);
  void BeginReachBand(const TaskAct& act);
  void Add(TaskAct act) { acts_.push_back(std::move(act)); }
  /// Adds one of the kinds that move a tip. \return it, for what else it needs
  TaskAct& Reach(TaskAct::Kind kind, int hand, double hurry = 1);
  void MoveBy(int hand, const math::Vec3& by);
  void SetJaw(std::string doing, int hand, double jaw, double seconds);
  void ReachPoint(int hand, const math::Vec3& p_world_tip, double hurry = 1);
  void PickUp(int hand, int object, int grip);
  void Carry(int hand, int object, const math::Vec3& p_world_object, double hurry = 1);
  void Rise(int hand, double height);
  void LetGo(int hand);
  void WithDraw(int hand);
  void Look(const scene::Region& region, double distance);
  void Wait(double seconds);
  // verbs and plans for tissue: task_tissue_verbs.cpp
  TissueSpot FindOnTube(const math::Vec3& p_rest) const;
  void PlanTissue(const simulation::Snapshot& seen, const scene::Condition& wanted);
  int TakeTool(const simulation::Snapshot& seen, instrument::ToolKind kind);
  void LineUp(int hand, const TissueSpot& spot, double jaw);
  void Advance(int hand, const TissueSpot& spot, double ahead);
  void CloseClip(const simulation::Snapshot& seen, const math::Vec3& p_rest, double depth_share);
  void CutTube(const simulation::Snapshot& seen, const math::Vec3& p_rest);
  double FindClearPlace(const simulation::Snapshot& seen, int band) const;
  void BurnBand(const simulation::Snapshot& seen, int band);
  void PressPedal(int hand, double seconds);
  void GraspTissue(const simulation::Snapshot& seen, int hand, const math::Vec3& p_before);
  void CutCircle(const simulation::Snapshot& seen, int sheet, double aside, double turns);
  void FollowSheet(int hand, const math::Vec3& p_sheet, double hurry);
  math::Vec3 FindTip(const simulation::Snapshot& seen, int hand, int object,
                     const math::Vec3& p_world_object) const;
  math::Vec3 GripTip(const simulation::Snapshot& seen, int hand, int object, int grip, double back) const;
  // what skill adds: task_skill.cpp
  void Anticipate(const TaskAct& act, const simulation::Snapshot& seen);
  std::optional<math::Vec3> FindNextWork(const simulation::Snapshot& seen, int hand) const;
  bool BeginAtTheWrongPlace(const simulation::Snapshot& seen, std::size_t goal);
  // errors: task_error_scenarios.cpp
  bool AddErrorScenario(const simulation::Snapshot& seen, int hand, int object, bool on_path = false);
  bool AddIdleErrorScenario(const simulation::Snapshot& seen);
  bool AddTissueErrorScenario(const simulation::Snapshot& seen,
                              const scene::Condition& wanted);  // task_tissue_error_scenarios.cpp
  math::Vec3 FindAstray(const math::Vec3& p_rest) const;

  void MoveCamera(const instrument::TrocarJoints& to);
  void StepCamera(double dt);
  HandMotion& HandOf(int hand) { return hands_[static_cast<std::size_t>(hand)]; }

  std::shared_ptr<const scene::Scene> scene_;
  SurgeonSkill skill_;
  ErrorScenario error_scenario_;
  math::Random random_;
  std::array<HandMotion, instrument::kHandCount> hands_;
  std::array<scene::HandControls, instrument::kHandCount> controls_;
  std::vector<math::Vec3> start_;                           // Snapshot::positions when it began
  std::vector<std::array<std::uint32_t, 2>> start_pieces_;  // and the rows of each piece of its ducts
  instrument::TrocarJoints camera_, camera_from_, camera_to_;
  double camera_time_ = 0, camera_duration_ = 0;
  std::deque<TaskAct> acts_;
  bool has_begun_ = false;
  double act_seconds_ = 0, pause_ = 0;
  int fruitless_plans_ = 0;
  std::uint64_t steps_seen_ = 0;
  bool has_finished_ = false;
  std::string doing_, goal_name_;
};

}  // namespace trocar::agent
