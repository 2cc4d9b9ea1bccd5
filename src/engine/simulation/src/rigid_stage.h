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
#include "trocar/simulation/tool_contact.h"
#include "trocar/surgery/grasp.h"

namespace trocar::simulation {

/// Change of one hand's grasp of an object in a tick.
struct RigidChange {
  surgery::GraspChange kind = surgery::GraspChange::kNone;
  std::int32_t object = -1;
};

/// Called in the order of its members, once a tick each. Without objects all of it does nothing.
class RigidStage {
 public:
  /// \return kSceneInvalid
  static base::Result<RigidStage> Make(const scene::Scene& scene);

  void Reset(const scene::Scene& scene,
             const std::array<instrument::TrocarJoints, instrument::kHandCount>& joints);
  bool IsEmpty() const { return !world_; }

  /// The jaws of a hand cannot close further than what they hold.
  double StopJaw(int hand, double wanted) noexcept;
  /// Finds the obstacles that the tools run into. They limit the tools that are seen and press on the hands.
  void FindObstacles(const scene::Scene& scene,
                     const std::array<instrument::TrocarJoints, instrument::kHandCount>& joints,
                     ToolContacts& contacts);
  /// One tick, with the tools where they are seen.
  void Step(const scene::Scene& scene,
            const std::array<instrument::TrocarJoints, instrument::kHandCount>& joints,
            const ToolContacts& contacts, const math::Vec3& gravity);

  /// Where the tool of a hand touches things now, those that never move among them.
  /// \param[out] contacts  added to
  /// \note Allocates.
  void FindContacts(const scene::Scene& scene,
                    const std::array<instrument::TrocarJoints, instrument::kHandCount>& joints,
                    const ToolContacts& tools, int hand, std::vector<ToolContact>& contacts);

  math::Vec3 ForceOn(int hand) const { return forces_[static_cast<std::size_t>(hand)]; }
  /// \param emit  (surgery::FactKind, hand, object): called for each thing that jaws took, let go or lost in this tick
  template <typename F>
  void ForEachChange(F&& emit) const {
    for (int hand = 0; hand < instrument::kHandCount; ++hand) {
      const RigidChange& change = changes_[static_cast<std::size_t>(hand)];
      if (change.kind == surgery::GraspChange::kGrasped) emit(surgery::FactKind::kGrasp, hand, change.object);
      if (change.kind == surgery::GraspChange::kReleased)
        emit(surgery::FactKind::kRelease, hand, change.object);
      if (change.kind == surgery::GraspChange::kSlipped) emit(surgery::FactKind::kSlip, hand, change.object);
    }
  }
  std::int32_t HeldBy(int hand) const;
  double Pinch(int hand) const { return hands_[static_cast<std::size_t>(hand)].pinch; }
  /// \param[out] objects  (Scene::objects)
  void Publish(std::vector<scene::ObjectSnapshot>& objects) const;
  void VisitState(base::StateArchive& archive);

 private:
  struct Hand {
    double wanted_jaw = 0;     ///< of the hand [rad]
    double jaw_before = 0;     ///< of the tool [rad]
    double jaw_at_grasp = -1;  ///< at which something came between the jaws [rad]; -1 while nothing is held
    double pinch = 0;          ///< [N]
    std::uint64_t obstacles = 0;
    math::Vec3 obstacle_force;
  };
  void UpdateHold(const scene::Scene& scene, int hand, double jaw);

  std::optional<rigid::RigidWorld> world_;
  std::array<Hand, instrument::kHandCount> hands_;
  std::array<math::Vec3, instrument::kHandCount> forces_;
  std::array<RigidChange, instrument::kHandCount> changes_;
  std::array<std::int32_t, instrument::kHandCount> held_{-1, -1};
  std::vector<rigid::ToolObstacle> obstacles_;
};

}  // namespace trocar::simulation
