// SPDX-License-Identifier: Apache-2.0
#include "operation/assistant.h"

#include <cmath>

#include "trocar/instrument/state_fields.h"
#include "trocar/math/state_fields.h"

namespace trocar::simulation {

using math::Vec3;
using scene::AssistantCommand;

namespace {

constexpr double kSpeed = 0.03;    // of the assistant's tip [m/s]
constexpr double kTurnRate = 1.0;  // of jaws and shaft [rad/s]
constexpr double kThere = 0.003;   // near enough to close [m]
constexpr double kWayOut = 0.035;  // the waiting tip stays this far above the fundus [m]

}  // namespace

void Assistant::Reset() {
  grasp_ = {};
  const Vec3 out = math::Normalized(setup_.p_world_port - p_rest_);
  joints_ = instrument::FindJoints(setup_.p_world_port, p_rest_ + kWayOut * out, 0.0, 0.0);
  p_taken_ = p_rest_;
}

surgery::GraspChange Assistant::Step(AssistantCommand command, const Vec3& fundus, double seconds,
                                     std::span<const surgery::OrganSurface> organs,
                                     const tissue::TissueModel& model, const surgery::GraspSettings& settings,
                                     tissue::TissueState& tissue) noexcept {
  const Vec3 out = math::Normalized(setup_.p_world_port - p_rest_);
  const bool wants_hold = command == AssistantCommand::kRetract || command == AssistantCommand::kRelax;
  const double open = 0.8 * setup_.tool.max_jaw;
  Vec3 target = p_rest_ + kWayOut * out;
  double jaw = 0;
  if (wants_hold && !grasp_.IsHolding()) {
    target = fundus;
    const bool is_there = math::Distance(CalcPose().translation, fundus) < kThere;
    jaw = is_there ? 0.0 : open;
    if (is_there) target = CalcPose().translation;
  } else if (grasp_.IsHolding()) {
    target = command == AssistantCommand::kRetract ? p_taken_ + setup_.lift
             : wants_hold                          ? p_taken_
                                                   : CalcPose().translation;
    jaw = wants_hold ? 0.0 : open;
  } else {
    jaw = joints_.jaw > 0.0 && math::Distance(CalcPose().translation, target) > kThere ? joints_.jaw : 0.0;
  }
  const instrument::TrocarJoints wanted =
      instrument::FindJoints(setup_.p_world_port, target, joints_.spin, jaw);
  joints_ = instrument::LimitSpeed(joints_, wanted, kSpeed, kTurnRate, seconds);
  const math::Pose X = CalcPose();
  const auto change =
      surgery::UpdateGrasp(setup_.tool, X, X, joints_.jaw, organs, nullptr, model, settings, grasp_, tissue);
  if (change == surgery::GraspChange::kGrasped) p_taken_ = X.translation;
  return change;
}

void Assistant::VisitState(base::StateArchive& archive) {
  archive.Field("p_taken", p_taken_);
  archive.Field("joints", joints_);
  archive.Field("grasp", grasp_);
}

}  // namespace trocar::simulation
