// SPDX-License-Identifier: Apache-2.0
#include "rigid_stage.h"

#include <algorithm>
#include <cmath>

#include "trocar/math/state_fields.h"

namespace trocar::simulation {

using instrument::kHandCount;
using math::Pose;
using math::Vec3;
using scene::InstrumentSetup;
using scene::kMaxObjects;
using scene::Scene;
using scene::SceneObject;

namespace {

using rigid::ToolCapsule;
using surgery::GraspChange;

/// Of the shaft behind the jaws, what can touch things [m].
constexpr double kShaftReach = 0.15;
/// Jaws let go when they have opened so far beyond where they met what they hold [rad].
constexpr double kLetGo = 0.07;
/// Squeezed by so much more than needed to meet it, jaws pinch as hard as they can [rad].
constexpr double kFullSqueeze = 0.15;
/// Rubber in profiled jaws; pinch of jaws that have just closed, and of jaws squeezed [N]. Source: as
/// surgery::GraspSettings.
constexpr double kGripFriction = 1.0, kLeastPinch = 3.0, kMostPinch = 20.0;
/// Of the board under a tool that presses it [N/m]; below what a haptic device renders stably.
constexpr double kObstacleStiffness = 400.0;
/// Obstacles this near already limit the tool, so that it does not enter and come out again [m].
constexpr double kObstacleReach = 0.002;
/// Beyond that, as far as the tool may go in this tick, but no farther [m].
constexpr double kMostObstacleMotion = 0.010;

void FindParts(const instrument::Tool& tool, double jaw, const Pose& X_world_tool,
               ToolCapsule (&capsules)[rigid::kToolPartCount], Pose (&X)[rigid::kToolPartCount]) {
  const instrument::ToolCapsules bodies = instrument::CalcCapsules(tool, jaw, kShaftReach);
  const instrument::Capsule* parts[rigid::kToolPartCount] = {&bodies.shaft, &bodies.upper_jaw,
                                                             &bodies.lower_jaw};
  for (int part = 0; part < rigid::kToolPartCount; ++part) {
    const instrument::Capsule& one = *parts[part];
    const Vec3 along = one.b - one.a;
    capsules[part] = {one.radius, 0.5 * math::Norm(along)};
    X[part] =
        X_world_tool * Pose{math::RotationBetween({0, 0, 1}, math::Normalized(along)), 0.5 * (one.a + one.b)};
  }
}

}  // namespace

base::Result<RigidStage> RigidStage::Make(const Scene& scene) {
  RigidStage made;
  if (scene.objects.empty()) return made;
  made.world_.emplace(Vec3{0, 0, -scene.settings.gravity}, scene.tick_seconds);
  for (const SceneObject& object : scene.objects) {
    if (const auto added = made.world_->AddBody(object.body); !added.ok())
      return base::Error{added.error().code, "object \"" + object.name + "\": " + added.error().message};
  }
  for (const InstrumentSetup& setup : scene.instruments) {
    ToolCapsule capsules[rigid::kToolPartCount];
    Pose X[rigid::kToolPartCount];
    FindParts(setup.tool, setup.home.jaw, instrument::CalcToolPose(setup.p_world_port, setup.home), capsules,
              X);
    if (const auto added = made.world_->AddTool(capsules, X); !added.ok()) return added.error();
  }
  made.obstacles_.reserve(kMaxObjects * rigid::kToolPartCount);
  return made;
}

void RigidStage::Reset(const Scene& scene, const std::array<instrument::TrocarJoints, kHandCount>& joints) {
  if (!world_) return;
  for (int hand = 0; hand < kHandCount; ++hand) {
    const auto h = static_cast<std::size_t>(hand);
    ToolCapsule capsules[rigid::kToolPartCount];
    Pose X[rigid::kToolPartCount];
    FindParts(scene.instruments[h].tool, joints[h].jaw,
              instrument::CalcToolPose(scene.instruments[h].p_world_port, joints[h]), capsules, X);
    world_->MoveTool(static_cast<std::uint32_t>(hand), X);
    hands_[h] = {};
    hands_[h].wanted_jaw = hands_[h].jaw_before = joints[h].jaw;
    forces_[h] = {};
    changes_[h] = {};
    held_[h] = -1;
  }
  world_->Reset();
}

std::int32_t RigidStage::HeldBy(int hand) const {
  return held_[static_cast<std::size_t>(hand)];
}

double RigidStage::StopJaw(int hand, double wanted) noexcept {
  Hand& h = hands_[static_cast<std::size_t>(hand)];
  h.wanted_jaw = wanted;
  return h.jaw_at_grasp < 0 ? wanted : std::max(wanted, h.jaw_at_grasp);
}

void RigidStage::FindObstacles(const Scene& scene,
                               const std::array<instrument::TrocarJoints, kHandCount>& joints,
                               ToolContacts& contacts) {
  if (!world_) return;
  for (int hand = 0; hand < kHandCount; ++hand) {
    const auto h = static_cast<std::size_t>(hand);
    ToolCapsule capsules[rigid::kToolPartCount];
    Pose X[rigid::kToolPartCount];
    // from the tool that is seen, which is outside: a hand that presses may have its jaws below the board already
    const Pose &X_proxy = contacts.Proxy(hand), &X_device = contacts.Device(hand);
    const Pose X_device_proxy = X_device * math::Inverse(X_proxy);
    FindParts(scene.instruments[h].tool, joints[h].jaw, X_proxy, capsules, X);
    const double motion = math::Distance(X_proxy.translation, X_device.translation);
    world_->FindObstacles(static_cast<std::uint32_t>(hand), X,
                          kObstacleReach + std::min(motion, kMostObstacleMotion), obstacles_);
    hands_[h].obstacles = 0;
    hands_[h].obstacle_force = {};
    double deepest = 0;
    for (const rigid::ToolObstacle& one : obstacles_) {
      const Vec3 on_device = X_device_proxy * one.point;
      const double clearance = math::Dot(one.normal, one.point - on_device) - one.depth;
      contacts.AddLimit(hand, {on_device, one.normal, clearance});
      if (!(clearance < 0)) continue;
      hands_[h].obstacles |= std::uint64_t{1} << one.body;
      if (-clearance > deepest) {
        deepest = -clearance;
        hands_[h].obstacle_force = (kObstacleStiffness * clearance) * one.normal;
      }
    }
  }
}

void RigidStage::FindContacts(const Scene& scene,
                              const std::array<instrument::TrocarJoints, kHandCount>& joints,
                              const ToolContacts& tools, int hand, std::vector<ToolContact>& contacts) {
  if (!world_) return;
  const auto h = static_cast<std::size_t>(hand);
  std::vector<rigid::ToolTouch> touches;
  world_->FindTouches(static_cast<std::uint32_t>(hand), touches);
  for (const rigid::ToolTouch& touch : touches) {
    contacts.push_back(
        {touch.point, touch.normal, touch.force, hand, -1, static_cast<std::int32_t>(touch.body)});
  }
  ToolCapsule capsules[rigid::kToolPartCount];
  Pose X[rigid::kToolPartCount];
  const Pose &X_proxy = tools.Proxy(hand), &X_device = tools.Device(hand);
  const Pose X_device_proxy = X_device * math::Inverse(X_proxy);
  FindParts(scene.instruments[h].tool, joints[h].jaw, X_proxy, capsules, X);
  const double motion = math::Distance(X_proxy.translation, X_device.translation);
  std::vector<rigid::ToolObstacle> obstacles;
  world_->FindObstacles(static_cast<std::uint32_t>(hand), X,
                        kObstacleReach + std::min(motion, kMostObstacleMotion), obstacles);
  // what never moves presses where the tool is deepest, as in FindObstacles
  double deepest = 0;
  ToolContact contact;
  for (const rigid::ToolObstacle& one : obstacles) {
    const double clearance = math::Dot(one.normal, one.point - X_device_proxy * one.point) - one.depth;
    if (!(-clearance > deepest)) continue;
    deepest = -clearance;
    contact = {one.point,
               -1.0 * one.normal,
               (kObstacleStiffness * clearance) * one.normal,
               hand,
               -1,
               static_cast<std::int32_t>(one.body)};
  }
  if (deepest > 0) contacts.push_back(contact);
}

void RigidStage::UpdateHold(const Scene& scene, int hand, double jaw) {
  const auto h = static_cast<std::size_t>(hand);
  const auto tool = static_cast<std::uint32_t>(hand);
  Hand& now = hands_[h];
  const bool is_closing = jaw < now.jaw_before - 1e-6 || now.wanted_jaw < jaw - 1e-6;
  now.jaw_before = jaw;
  if (held_[h] >= 0) {
    if (world_->HeldBy(tool) < 0) {  // pulled away by the world in its last step
      changes_[h] = {GraspChange::kSlipped, held_[h]};
    } else if (now.wanted_jaw > now.jaw_at_grasp + kLetGo) {
      world_->Release(tool);
      changes_[h] = {GraspChange::kReleased, held_[h]};
    } else {
      const double squeeze = std::clamp((now.jaw_at_grasp - now.wanted_jaw) / kFullSqueeze, 0.0, 1.0);
      now.pinch = kLeastPinch + squeeze * (kMostPinch - kLeastPinch);
      world_->SetHoldForce(tool, kGripFriction * now.pinch);
      return;
    }
    held_[h] = -1;
    now.jaw_at_grasp = -1;
    now.pinch = 0;
    return;
  }
  const bool can_grasp = scene.instruments[h].tool.max_jaw > 0 && is_closing;
  const std::int32_t between = can_grasp ? world_->FindBodyInJaws(tool) : -1;
  if (between < 0) return;
  now.pinch = kLeastPinch;
  now.jaw_at_grasp = jaw;
  held_[h] = between;
  world_->Hold(tool, static_cast<std::uint32_t>(between), kGripFriction * now.pinch);
  changes_[h] = {GraspChange::kGrasped, between};
}

void RigidStage::Step(const Scene& scene, const std::array<instrument::TrocarJoints, kHandCount>& joints,
                      const ToolContacts& contacts, const Vec3& gravity) {
  if (!world_) return;
  world_->SetGravity(gravity);
  for (int hand = 0; hand < kHandCount; ++hand) {
    const auto h = static_cast<std::size_t>(hand);
    ToolCapsule capsules[rigid::kToolPartCount];
    Pose X[rigid::kToolPartCount];
    FindParts(scene.instruments[h].tool, joints[h].jaw, contacts.Proxy(hand), capsules, X);
    world_->MoveTool(static_cast<std::uint32_t>(hand), X);
  }
  world_->Step();
  for (int hand = 0; hand < kHandCount; ++hand) {
    const auto h = static_cast<std::size_t>(hand);
    changes_[h] = {};
    UpdateHold(scene, hand, joints[h].jaw);
    forces_[h] = world_->ForceOn(static_cast<std::uint32_t>(hand)) + hands_[h].obstacle_force;
  }
}

void RigidStage::Publish(std::vector<scene::ObjectSnapshot>& objects) const {
  if (!world_) return;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const auto body = static_cast<std::uint32_t>(i);
    scene::ObjectSnapshot& object = objects[i];
    object.X_world_object = world_->PoseOf(body);
    object.velocity = world_->VelocityOf(body);
    object.is_at_rest = world_->IsAtRest(body);
    object.touches = world_->TouchedBodies(body);
    object.held_by = object.touched_by = 0;
    for (int hand = 0; hand < kHandCount; ++hand) {
      const auto h = static_cast<std::size_t>(hand);
      const auto bit = static_cast<std::uint8_t>(1 << hand);
      const bool is_held = held_[h] == static_cast<std::int32_t>(i);
      if (is_held) object.held_by |= bit;
      if (is_held || world_->Touches(static_cast<std::uint32_t>(hand), body) ||
          ((hands_[h].obstacles >> i) & 1) != 0)
        object.touched_by |= bit;
    }
  }
}

void RigidStage::VisitState(base::StateArchive& archive) {
  if (!world_) return;
  archive.Field("bodies", *world_);
  for (Hand& hand : hands_) {
    archive.Field("wanted_jaw", hand.wanted_jaw);
    archive.Field("jaw_before", hand.jaw_before);
    archive.Field("jaw_at_grasp", hand.jaw_at_grasp);
    archive.Field("pinch", hand.pinch);
    archive.Field("obstacles", hand.obstacles);
    archive.Field("obstacle_force", hand.obstacle_force);
  }
  archive.Field("forces", forces_);
  archive.Field("held", held_);
}

}  // namespace trocar::simulation
