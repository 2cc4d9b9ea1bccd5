// SPDX-License-Identifier: Apache-2.0
/// \file rigid_stage.h  The rigid things of a scene in its tick: held, pushed, dropped, and what keeps tools out.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "tool_contacts.h"
#include "trocar/base/state_archive.h"
#include "trocar/rigid/rigid_world.h"
#include "trocar/scene/scene.h"
#include "trocar/simulation/snapshot.h"
#include "trocar/surgery/grasp.h"

namespace trocar::simulation {

using scene::EventKind;

/// Change of one hand's grasp of an object in a tick.
struct RigidChange {
  surgery::GraspChange kind = surgery::GraspChange::kNone;
  std::int32_t object = -1;
};

/// Called in the order of its members, once a tick each. Without objects all of it does nothing.
class RigidStage {
 public:
  /// \return kSceneInvalid
  static base::Result<RigidStage> Make(const Scene& scene);

  void Reset(const Scene& scene, const std::array<instrument::TrocarJoints, kHandCount>& joints);
  bool IsEmpty() const { return !world_; }

  /// The jaws of a hand cannot close further than what they hold.
  double StopJaw(int hand, double wanted) noexcept;
  /// Finds the obstacles that the tools run into. They limit the tools that are seen and press on the hands.
  void FindObstacles(const Scene& scene, const std::array<instrument::TrocarJoints, kHandCount>& joints,
                     ToolContacts& contacts);
  /// One tick, with the tools where they are seen.
  void Step(const Scene& scene, const std::array<instrument::TrocarJoints, kHandCount>& joints,
            const ToolContacts& contacts, const Vec3& gravity);

  Vec3 ForceOn(int hand) const { return forces_[static_cast<std::size_t>(hand)]; }
  /// \param emit  (EventKind, hand, object): called for each thing that jaws took, let go or lost in this tick
  template <typename F>
  void ForEachChange(F&& emit) const {
    for (int hand = 0; hand < kHandCount; ++hand) {
      const RigidChange& change = changes_[static_cast<std::size_t>(hand)];
      if (change.kind == surgery::GraspChange::kGrasped) emit(EventKind::kGrasp, hand, change.object);
      if (change.kind == surgery::GraspChange::kReleased) emit(EventKind::kRelease, hand, change.object);
      if (change.kind == surgery::GraspChange::kSlipped) emit(EventKind::kSlip, hand, change.object);
    }
  }
  std::int32_t HeldBy(int hand) const;
  double Pinch(int hand) const { return hands_[static_cast<std::size_t>(hand)].pinch; }
  /// \param[out] objects  (Scene::objects)
  void Publish(std::vector<ObjectSnapshot>& objects) const;
  void VisitState(base::StateArchive& archive);

 private:
  struct Hand {
    double wanted_jaw = 0;     ///< of the hand [rad]
    double jaw_before = 0;     ///< of the tool [rad]
    double jaw_at_grasp = -1;  ///< at which something came between the jaws [rad]; -1 while nothing is held
    double pinch = 0;          ///< [N]
    std::uint64_t obstacles = 0;
    Vec3 obstacle_force;
  };
  void UpdateHold(const Scene& scene, int hand, double jaw);

  std::optional<rigid::RigidWorld> world_;
  std::array<Hand, kHandCount> hands_;
  std::array<Vec3, kHandCount> forces_;
  std::array<RigidChange, kHandCount> changes_;
  std::array<std::int32_t, kHandCount> held_{-1, -1};
  std::vector<rigid::ToolObstacle> obstacles_;
};

}  // namespace trocar::simulation
