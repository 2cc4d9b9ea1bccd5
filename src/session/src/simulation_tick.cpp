// SPDX-License-Identifier: Apache-2.0
// The stages of a tick, in order.
#include <algorithm>
#include <cmath>
#include <utility>

#include "simulation_content.h"
#include "trocar/tissue/damage.h"

namespace trocar::session {
namespace {

/// No hand is faster; a device that jumps is slowed to this (faults D5) [m/s], [rad/s].
constexpr double kMaxTipSpeed = 2.0;
constexpr double kMaxTurnRate = 20.0;
/// A tool this deep has been pushed in, and is followed by the laparoscope [m].
constexpr double kPushedIn = 0.04;

/// Gravity in the patient's frame when the table is tilted [m/s^2].
Vec3 CalcGravity(const LiveSettings& settings) noexcept {
  const double head = settings.head_up, right = settings.right_up;
  return settings.gravity *
         Vec3{std::sin(right) * std::cos(head), -std::sin(head), -std::cos(right) * std::cos(head)};
}

}  // namespace

void Simulation::Content::ReadInputs(const Input& input) noexcept {
  settings = ClampSettings(input.settings);
  load.gravity = CalcGravity(settings) - kImagingGravity;
  load.stiffness_scale = settings.stiffness_scale;
  load.shape_scale = settings.shape_scale;
}

void Simulation::Content::MoveInstruments(const Input& input) noexcept {
  if (operation != nullptr) operation->BeginTick();
  for (int hand = 0; hand < kHandCount; ++hand) {
    instrument::JointLimits limits;
    limits.max_jaw = ToolOf(hand).max_jaw;
    instrument::TrocarJoints wanted = instrument::ClampJoints(input.hands[hand], limits);
    if (operation != nullptr && !operation->MoveTool(hand, input.controls[hand], grasps[hand].IsHolding(),
                                                     scene->tick_seconds, wanted))
      Note(EventKind::kExchangeRefused, hand, grasps[hand].surface, 0.0);
    const double jaw_before = joints[hand].jaw;
    joints[hand] =
        instrument::LimitSpeed(joints[hand], wanted, kMaxTipSpeed, kMaxTurnRate, scene->tick_seconds);
    joints[hand].jaw = rigid.StopJaw(hand, joints[hand].jaw);
    if (operation != nullptr)
      joints[hand].jaw = operation->StopJaw(hand, jaw_before, joints[hand].jaw, grasps[hand].IsHolding());
  }
}

void Simulation::Content::MoveLaparoscope(const Input& input) noexcept {
  if (!settings.holds_camera) {
    instrument::JointLimits limits;
    limits.min_depth = 0.01;
    laparoscope = instrument::ClampJoints(input.laparoscope, limits);
    camera_holder.Reset(laparoscope);
    return;
  }
  std::array<Vec3, kHandCount> tips;
  std::size_t count = 0;
  for (int hand = 0; hand < kHandCount; ++hand) {
    if (joints[hand].depth > kPushedIn) tips[count++] = touch.Proxy(hand).translation;
  }
  laparoscope = camera_holder.Follow(scene->laparoscope, std::span(tips).first(count), scene->tick_seconds);
}

ToolsNow Simulation::Content::GetTools() const noexcept {
  ToolsNow now{joints, {}, {}};
  for (int hand = 0; hand < kHandCount; ++hand) {
    now.grasped_surfaces[hand] = grasps[hand].surface;
    now.tools[hand] = &ToolOf(hand);
  }
  return now;
}

void Simulation::Content::FindContacts() noexcept {
  load.contacts = touch.Find(*scene, GetTools(), tissue);
  rigid.FindObstacles(*scene, joints, touch);
}

void Simulation::Content::ActOnTissue() noexcept {
  for (int hand = 0; hand < kHandCount; ++hand) {
    const std::int32_t held = grasps[hand].surface;
    changes[hand] = surgery::GraspChange::kNone;
    changed_organs[hand] = held;
    const instrument::Tool& tool = ToolOf(hand);
    const bool can_grasp =
        tool.kind == instrument::ToolKind::kGrasper || tool.kind == instrument::ToolKind::kDissector;
    const bool has_stone = operation != nullptr && operation->HoldsStone(hand);
    if ((!can_grasp || has_stone) && !grasps[hand].IsHolding()) continue;
    changes[hand] =
        surgery::UpdateGrasp(tool, touch.Proxy(hand), touch.Device(hand), joints[hand].jaw, touch.Organs(),
                             &touch.Tubes(), tissue_model, grasp_settings, grasps[hand], tissue);
    changed_organs[hand] = changes[hand] == surgery::GraspChange::kReleased ? held : grasps[hand].surface;
  }
  // nodes that a tool presses are the paper's second condition
  for (std::size_t i = 0; i < tissue.condition.size(); ++i) {
    if (tissue.condition[i] == tissue::NodeCondition::kExternalForce)
      tissue.condition[i] = tissue::NodeCondition::kFree;
  }
  for (const auto& spring : load.contacts) {
    if (!(tissue::CalcContactDepth(spring, tissue.position) > 0.0)) continue;
    for (const auto node : spring.nodes) {
      if (tissue.condition[node] == tissue::NodeCondition::kFree)
        tissue.condition[node] = tissue::NodeCondition::kExternalForce;
    }
  }
}

void Simulation::Content::Solve() noexcept {
  if (guard->IsFrozen()) return;
  std::copy(tissue.condition.begin(), tissue.condition.end(), solved_condition.begin());
  load.external_force = {};
  tissue::SolverSettings bounds = settings.solver;
  if (std::exchange(has_cut, false)) {
    // making the solver anew has taken its part of the tick
    bounds.max_newton_steps = (bounds.max_newton_steps + 1) / 2;
    bounds.max_linear_total = (bounds.max_linear_total + 1) / 2;
  }
  report =
      tissue::SolveConserving(*solver, bounds, scene->tick_seconds, *conservation, load, tissue, conserved);
}

void Simulation::Content::CheckState() noexcept {
  verdict = guard->Check(tissue, report.is_finite);
  // what a bad tick left in the pressures and frames goes with it
  if (verdict == tissue::GuardVerdict::kGood) {
    good_conserved = conserved;
  } else {
    static_cast<tissue::ConservationTick&>(conserved) = good_conserved;
  }
  const bool is_good = verdict == tissue::GuardVerdict::kGood;
  const auto touched = touch.CalcTouch(tissue, is_good);
  for (int hand = 0; hand < kHandCount; ++hand) {
    const Vec3 held = solver->CalcReaction(load, tissue, grasps[hand].Nodes());
    touched_organs[hand] = grasps[hand].IsHolding() ? grasps[hand].surface : touched[hand].surface;
    forces[hand] = is_good ? touched[hand].force + held : Vec3{};
    if (!is_good) continue;
    const std::int32_t surface = grasps[hand].surface;
    if (surgery::UpdateSlip(math::Norm(held), grasp_settings, tissue_model, grasps[hand], tissue) ==
        surgery::GraspChange::kSlipped) {
      changes[hand] = surgery::GraspChange::kSlipped;
      changed_organs[hand] = surface;
    }
  }
}

void Simulation::Content::TearTissue() noexcept {
  torn_count = verdict == tissue::GuardVerdict::kGood
                   ? tissue::TearStrands(tissue_model, max_elongation, tissue, torn)
                   : 0;
  torn_spring_count = 0;
  if (!walls_tear || verdict != tissue::GuardVerdict::kGood) return;
  torn_spring_count = tissue::TearSprings(tissue_model, scene->tick_seconds, tissue, torn_springs);
  // a hollow organ leaks through what the spring no longer closes
  for (std::size_t i = 0; i < torn_spring_count; ++i) {
    const std::int32_t organ = spring_organs[torn_springs[i]];
    if (organ == hollow_organ)
      conservation->Perforate(static_cast<std::size_t>(organ), spring_areas[torn_springs[i]], conserved);
  }
}

void Simulation::Content::UpdateHierarchy() noexcept {
  touch.Update(*scene, GetTools(), tissue);
  rigid.Step(*scene, joints, touch, CalcGravity(settings));
  for (int hand = 0; hand < kHandCount; ++hand) forces[hand] = forces[hand] + rigid.ForceOn(hand);
}

void Simulation::Content::Note(EventKind kind, int hand, std::int32_t organ, double force,
                               std::int32_t object) noexcept {
  snapshot.events[snapshot.event_count % snapshot.events.size()] = {kind, tick, hand, organ, force, object};
  ++snapshot.event_count;
}

void Simulation::Content::DetectEvents() noexcept {
  for (int hand = 0; hand < kHandCount; ++hand) {
    const double force = math::Norm(forces[hand]);
    switch (changes[hand]) {
      case surgery::GraspChange::kNone:
        break;
      case surgery::GraspChange::kGrasped:
        Note(EventKind::kGrasp, hand, changed_organs[hand], force);
        break;
      case surgery::GraspChange::kMissed:
        Note(EventKind::kGraspMissed, hand, -1, 0.0);
        break;
      case surgery::GraspChange::kReleased:
        Note(EventKind::kRelease, hand, changed_organs[hand], force);
        break;
      case surgery::GraspChange::kSlipped:
        Note(EventKind::kSlip, hand, changed_organs[hand], force);
        break;
      case surgery::GraspChange::kDamaged:
        Note(EventKind::kPinchDamage, hand, changed_organs[hand], grasps[hand].pinch);
        break;
    }
  }
  rigid.NoteChanges([&](EventKind kind, int hand, std::int32_t object) {
    Note(kind, hand, -1, math::Norm(forces[hand]), object);
  });
  if (touch.AreToolsTouching() && !were_tools_touching) Note(EventKind::kToolsTouch, -1, -1, 0.0);
  were_tools_touching = touch.AreToolsTouching();
  if (torn_count > 0) Note(EventKind::kTear, -1, strand_organs[torn[0]], 0.0);
  if (torn_spring_count > 0) Note(EventKind::kTear, -1, spring_organs[torn_springs[0]], 0.0);
  if (verdict == tissue::GuardVerdict::kRestored) Note(EventKind::kStateRestored, -1, -1, 0.0);
  if (verdict == tissue::GuardVerdict::kFrozen && !was_frozen) Note(EventKind::kOrganFrozen, -1, -1, 0.0);
  was_frozen = verdict == tissue::GuardVerdict::kFrozen;
}

void Simulation::Content::Publish(const Input& input) noexcept {
  snapshot.tick = tick;
  snapshot.time = static_cast<double>(tick) * scene->tick_seconds;
  std::copy(tissue.position.begin(), tissue.position.end(), snapshot.positions.begin());
  for (int hand = 0; hand < kHandCount; ++hand) {
    InstrumentSnapshot& tool = snapshot.instruments[hand];
    tool.X_world_tool = touch.Proxy(hand);
    tool.joints = joints[hand];
    tool.force = forces[hand];
    tool.is_grasping = grasps[hand].IsHolding() || rigid.HeldBy(hand) >= 0;
    tool.object = rigid.HeldBy(hand);
    tool.is_touching = touched_organs[hand] >= 0;
    tool.organ = touched_organs[hand];
    tool.X_world_device = touch.Device(hand);
    tool.pinch = std::max(grasps[hand].pinch, rigid.Pinch(hand));
    tool.overlap = touch.Overlap(hand);
    tool.is_touching_tool = touch.AreToolsTouching();
  }
  snapshot.contacts = touch.Contacts().springs.size();
  snapshot.dropped_contacts = touch.Contacts().dropped;
  MoveLaparoscope(input);
  snapshot.laparoscope = laparoscope;
  snapshot.X_world_laparoscope = CalcLaparoscopePose(scene->laparoscope, laparoscope);
  for (std::size_t i = 0; i < conserved.organs.size(); ++i) {
    const tissue::OrganVolume& organ = conserved.organs[i];
    snapshot.organs[i] = {organ.volume, organ.target, organ.pressure, organ.leaked};
  }
  if (operation != nullptr) operation->Publish(tissue, snapshot.operation);
  snapshot.residual = report.residual;
  snapshot.iterations = report.iterations;
  snapshot.gravity = CalcGravity(settings);
  rigid.Publish(snapshot.objects);
  monitor.Update(*scene, snapshot);
}

}  // namespace trocar::session
