// SPDX-License-Identifier: Apache-2.0
/// \file assistant.h  The third hand: an assistant who holds the fundus and obeys commands.
#pragma once

#include <span>

#include "trocar/base/state_archive.h"
#include "trocar/scene/scene.h"
#include "trocar/surgery/grasp.h"

namespace trocar::simulation {

/// A grasper in a trocar of its own. It goes around nothing and pushes nothing: what its jaws take is carried, no more.
class Assistant {
 public:
  Assistant() = default;
  Assistant(const scene::AssistantSetup& setup, const math::Vec3& p_world_target)
      : setup_(setup), p_rest_(p_world_target) {
    Reset();
  }

  void Reset();
  /// One tick: moves as the command says, closes or opens the jaws.
  /// \param fundus   where what it takes is now [m]
  /// \note Real-time safe.
  surgery::GraspChange Step(scene::AssistantCommand command, const math::Vec3& fundus, double seconds,
                            std::span<const surgery::OrganSurface> organs, const tissue::TissueModel& model,
                            const surgery::GraspSettings& settings, tissue::TissueState& tissue) noexcept;

  const instrument::TrocarJoints& Joints() const { return joints_; }
  math::Pose CalcPose() const { return instrument::CalcToolPose(setup_.p_world_port, joints_); }
  surgery::Grasp& Held() { return grasp_; }
  const surgery::Grasp& Held() const { return grasp_; }
  void VisitState(base::StateArchive& archive);

 private:
  scene::AssistantSetup setup_;
  math::Vec3 p_rest_;   // of the fundus [m]
  math::Vec3 p_taken_;  // tip where the jaws closed [m]
  instrument::TrocarJoints joints_;
  surgery::Grasp grasp_;
};

}  // namespace trocar::simulation
