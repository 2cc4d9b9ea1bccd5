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
#include <string>
#include <vector>

#include "patient_tissue.h"
#include "task_surgeon.h"
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
  kPerforates,
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
  /// Fibres that are worked on until none is left that can be reached.
  struct Dissection {
    std::vector<std::uint32_t> strands;
    std::vector<double> order;  ///< (strands) what comes first
    double enough = 1.0;        ///< share that is to be parted [-]
    double traction = 0;        ///< by which the other hand has drawn back at the end [m]
    double parted_at_reset = 0;
    Vec3 p_hold;  ///< of the other hand, when it began [m]
    std::vector<std::uint8_t> attempts;
    std::int32_t target = -1;
    double seconds = 0, blocked = 0;
  };

  void Learn(PatientTissue tissue);
  void PlanOperation();
  void PlanFlaw(OperationFlaw flaw);

  // verbs
  void Add(std::string doing, std::function<void(const Snapshot&)> begin,
           std::function<bool(const Snapshot&)> is_done, double patience);
  void Reach(int hand, Place tip, double hurry = 1);
  void Jaw(int hand, double share);
  void Wait(double seconds);
  void Exchange(int hand, instrument::ToolKind kind, bool over_field = true);
  void Grasp(int hand, const Place& at, double squeeze = 0);
  void Draw(int hand, const Vec3& by);
  void LetGo(int hand);
  void LineUp(const std::string& what, std::size_t tube, double share, double jaw);
  void PlaceClip(std::size_t tube, double share, double beyond = 0.5, int tries = 2);
  void CloseClip(std::size_t tube, double share);
  void CutTube(std::size_t tube, double share);
  void Burn(int hand, const Place& at, double seconds);
  void Dissect(const std::string& what, std::vector<std::uint32_t> strands, std::vector<double> order,
               double enough, double traction);
  bool GoOnDissecting(Dissection& work, const Snapshot& seen);
  void LookAt(Place target, double turn, double distance);

  // knowledge
  Vec3 TubePoint(const Snapshot& seen, std::size_t tube, double share) const;
  Vec3 TubeDirection(const Snapshot& seen, std::size_t tube, double share) const;
  std::uint32_t FindNode(std::int32_t organ, const Vec3& p) const;
  std::size_t FindTube(std::string_view name) const;
  Vec3 HookTip(const Vec3& at) const;
  /// That far beyond a point of a tube, as seen from the right hand's trocar; negative: before it.
  Vec3 Aim(const Snapshot& seen, std::size_t tube, double share, double ahead) const;
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
      tube_nodes_;  // (tubes) from the gallbladder's end, where one enters it
  std::uint32_t neck_ = 0, hold_ = 0, fundus_ = 0, liver_node_ = 0;
  Vec3 bed_normal_;                          // from the liver towards the gallbladder, at rest
  std::deque<SurgicalAct> acts_, inserted_;  // the latter by the act that is under way, to be done next
  bool has_begun_ = false, has_finished_ = false;
  double act_seconds_ = 0;
  std::string doing_;
};

/// Whether a scene is one that they can operate on.
bool IsCholecystectomy(const Scene& scene);

}  // namespace trocar::session
