// SPDX-License-Identifier: Apache-2.0
// The stages of a tick, in order.
#include <algorithm>
#include <cmath>
#include <utility>

#include "bad_tick.h"
#include "simulation_content.h"
#include "trocar/math/elementary.h"
#include "trocar/tissue/conserved_equilibrium.h"
#include "trocar/tissue/damage.h"

namespace trocar::simulation {

using instrument::kHandCount;
using math::Cos;
using math::Sin;
using math::Vec3;
using scene::CalcLaparoscopePose;
using scene::ClampSettings;
using scene::Input;
using surgery::FactKind;

namespace {

/// No hand is faster; a device that jumps is slowed to this (faults D5) [m/s], [rad/s].
constexpr double kMaxTipSpeed = 2.0;
constexpr double kMaxTurnRate = 20.0;
/// A tool this deep has been pushed in, and is followed by the laparoscope [m].
constexpr double kPushedIn = 0.04;

/// Gravity in the patient's frame when the table is tilted [m/s^2].
Vec3 CalcGravity(const scene::LiveSettings& settings) noexcept {
  const double head = settings.head_up, right = settings.right_up;
  return settings.gravity * Vec3{Sin(right) * Cos(head), -Sin(head), -Cos(right) * Cos(head)};
}

}  // namespace

void Simulation::Content::ReadInputs(const Input& input) noexcept {
  tick.settings = ClampSettings(input.settings);
  tick.gravity = CalcGravity(tick.settings);
  tick.load.gravity = tick.gravity - kImagingGravity;
  tick.load.stiffness_scale = tick.settings.stiffness_scale;
  tick.load.shape_scale = tick.settings.shape_scale;
}

void Simulation::Content::MoveTools(const Input& input) noexcept {
  WorldState& w = world;
  tick.facts.Clear();
  if (w.operation != nullptr) w.operation->BeginTick(tick.facts);
  for (int hand = 0; hand < kHandCount; ++hand) {
    instrument::JointLimits limits;
    limits.max_jaw = ToolOf(hand).max_jaw;
    instrument::TrocarJoints wanted = instrument::ClampJoints(input.hands[hand], limits);
    const double seconds = GetScene().tick_seconds;
    const bool is_holding = w.grasps[hand].IsHolding();
    tick.was_exchange_refused[hand] =
        w.operation != nullptr &&
        !w.operation->MoveTool(hand, input.controls[hand], is_holding, seconds, wanted);
    const double jaw_before = w.joints[hand].jaw;
    w.joints[hand] = instrument::LimitSpeed(w.joints[hand], wanted, kMaxTipSpeed, kMaxTurnRate, seconds);
    w.joints[hand].jaw = w.rigid.StopJaw(hand, w.joints[hand].jaw);
    if (w.operation != nullptr)
      w.joints[hand].jaw = w.operation->StopJaw(hand, jaw_before, w.joints[hand].jaw, is_holding);
  }
  MoveCamera(input);
}

/// A camera that a hand holds is where the hand is.
void Simulation::Content::MoveCamera(const Input& input) noexcept {
  if (tick.settings.holds_camera) return;
  instrument::JointLimits limits;
  limits.min_depth = 0.01;
  world.laparoscope = instrument::ClampJoints(input.laparoscope, limits);
  world.camera_holder.Reset(world.laparoscope);
}

/// One that the automatic holder holds follows the tools that are seen.
void Simulation::Content::HoldCamera() noexcept {
  if (!tick.settings.holds_camera) return;
  std::array<Vec3, kHandCount> tips;
  std::size_t count = 0;
  for (int hand = 0; hand < kHandCount; ++hand) {
    if (world.joints[hand].depth > kPushedIn) tips[count++] = world.touch.Proxy(hand).translation;
  }
  const scene::Scene& scene = GetScene();
  world.laparoscope =
      world.camera_holder.Follow(scene.laparoscope, std::span(tips).first(count), scene.tick_seconds);
}

instrument::Camera Simulation::Content::GetCamera() const noexcept {
  const scene::LaparoscopeSetup& setup = GetScene().laparoscope;
  return {CalcLaparoscopePose(setup, world.laparoscope), setup.field_of_view};
}

ToolsNow Simulation::Content::GetTools() const noexcept {
  ToolsNow now{world.joints, {}, {}};
  for (int hand = 0; hand < kHandCount; ++hand) {
    now.grasped_surfaces[hand] = world.grasps[hand].surface;
    now.tools[hand] = &ToolOf(hand);
  }
  return now;
}

OperatedTissue Simulation::Content::GetTissue() noexcept {
  WorldState& w = world;
  return {w.topology.Model(),
          w.topology.Definition(),
          w.tissue,
          *conservation,
          w.conserved,
          w.touch.Organs(),
          w.touch.Tubes(),
          std::span(tick.torn_springs).first(tick.torn_spring_count),
          w.grasps};
}

void Simulation::Content::FindContacts() noexcept {
  tick.load.contacts = world.touch.Find(GetScene(), GetTools(), world.tissue);
  world.rigid.FindObstacles(GetScene(), world.joints, world.touch);
}

void Simulation::Content::UseTools(const Input& input) noexcept {
  Grasp();
  MarkPressedNodes();
  WorldState& w = world;
  if (w.operation == nullptr) return;
  HandsNow& hands = tick.hands;
  hands.input = &input;
  hands.joints = w.joints;
  for (int hand = 0; hand < kHandCount; ++hand) {
    hands.X_proxy[hand] = w.touch.Proxy(hand);
    hands.X_device[hand] = w.touch.Device(hand);
  }
  hands.forces = w.forces;
  hands.gravity = tick.load.gravity + kImagingGravity;
  hands.changes = tick.changes;
  hands.camera = GetCamera();
  hands.time = static_cast<double>(w.tick) * GetScene().tick_seconds;
  hands.seconds = GetScene().tick_seconds;
  OperatedTissue tissue = GetTissue();
  w.operation->Act(hands, tissue);
}

void Simulation::Content::Grasp() noexcept {
  WorldState& w = world;
  for (int hand = 0; hand < kHandCount; ++hand) {
    surgery::Grasp& grasp = w.grasps[hand];
    const std::int32_t held = grasp.surface;
    tick.changes[hand] = surgery::GraspChange::kNone;
    tick.changed_organs[hand] = held;
    const instrument::Tool& tool = ToolOf(hand);
    const bool can_grasp = instrument::AbilitiesOf(tool.kind).takes;
    const bool has_stone = w.operation != nullptr && w.operation->HoldsStone(hand);
    if ((!can_grasp || has_stone) && !grasp.IsHolding()) continue;
    tick.changes[hand] = surgery::UpdateGrasp(tool, w.touch.Proxy(hand), w.touch.Device(hand),
                                              w.joints[hand].jaw, w.touch.Organs(), &w.touch.Tubes(),
                                              w.topology.Model(), grasp_settings, grasp, w.tissue);
    tick.changed_organs[hand] = tick.changes[hand] == surgery::GraspChange::kReleased ? held : grasp.surface;
  }
}

/// Nodes that a tool presses are the paper's second condition.
void Simulation::Content::MarkPressedNodes() noexcept {
  auto& conditions = world.tissue.condition;
  for (tissue::NodeCondition& condition : conditions) {
    if (condition == tissue::NodeCondition::kExternalForce) condition = tissue::NodeCondition::kFree;
  }
  for (const auto& spring : tick.load.contacts) {
    if (!(tissue::CalcContactDepth(spring, world.tissue.position) > 0.0)) continue;
    for (const auto node : spring.nodes) {
      if (conditions[node] == tissue::NodeCondition::kFree)
        conditions[node] = tissue::NodeCondition::kExternalForce;
    }
  }
}

void Simulation::Content::Heat() noexcept {
  if (world.operation == nullptr) return;
  OperatedTissue tissue = GetTissue();
  world.operation->Heat(tick.hands, tissue);
}

/// A judge sees what tools and heat did while the tissue is as it was then.
void Simulation::Content::WitnessTools() noexcept {
  if (judgement.procedure == nullptr) return;
  judgement.procedure->SeeTools(world.operation->Observe(tick.hands, GetTissue(), tick.hands.camera));
}

void Simulation::Content::Assist() noexcept {
  if (world.operation == nullptr) return;
  OperatedTissue tissue = GetTissue();
  world.operation->Assist(tick.hands, tissue);
}

/// Takes a cut into the system in the tick that made it. Allocates.
void Simulation::Content::CutTopology() noexcept {
  tick.has_cut = world.operation != nullptr && world.operation->EndCuts();
  if (tick.has_cut) world.topology.Cut(world.operation->Change(), world.tissue);
}

void Simulation::Content::SolveTissue() noexcept {
  WorldState& w = world;
  if (w.guard->IsFrozen()) return;
  std::copy(w.tissue.condition.begin(), w.tissue.condition.end(), tick.solved_condition.begin());
  tick.load.external_force = {};
  tissue::SolverSettings bounds = tick.settings.solver;
  if (tick.has_cut) {
    // making the solver anew has taken its part of the tick
    bounds.newton.max_steps = (bounds.newton.max_steps + 1) / 2;
    bounds.newton.max_linear_total = (bounds.newton.max_linear_total + 1) / 2;
  }
  tick.report = tissue::SolveConserving(*solver, bounds, GetScene().tick_seconds, *conservation, tick.load,
                                        w.tissue, w.conserved);
}

void Simulation::Content::GuardTissue() noexcept {
  WorldState& w = world;
  tick.verdict = w.guard->Check(w.tissue, tick.report.is_finite);
  const bool is_good = tick.verdict == tissue::GuardVerdict::kGood;
  if (is_good) {
    w.good_conserved = w.conserved;
  } else {
    TakeBack(w.good_conserved, w.conserved);
  }
  const auto touched = w.touch.CalcTouch(w.tissue, is_good);
  for (int hand = 0; hand < kHandCount; ++hand) {
    surgery::Grasp& grasp = w.grasps[hand];
    const Vec3 held = solver->CalcReaction(tick.load, w.tissue, grasp.Nodes());
    tick.touched_organs[hand] = grasp.IsHolding() ? grasp.surface : touched[hand].surface;
    w.forces[hand] = is_good ? touched[hand].force + held : Vec3{};
    if (!is_good) continue;
    const std::int32_t surface = grasp.surface;
    if (surgery::UpdateSlip(math::Norm(held), grasp_settings, w.topology.Model(), grasp, w.tissue) ==
        surgery::GraspChange::kSlipped) {
      tick.changes[hand] = surgery::GraspChange::kSlipped;
      tick.changed_organs[hand] = surface;
    }
  }
  TearTissue();
}

void Simulation::Content::TearTissue() noexcept {
  WorldState& w = world;
  const tissue::TissueModel& tissue_model = w.topology.Model();
  tick.torn_count = tick.torn_spring_count = 0;
  if (tick.verdict != tissue::GuardVerdict::kGood) return;
  tick.torn_count = tissue::TearStrands(tissue_model, model->tissue->max_elongation, w.tissue, tick.torn);
  if (!model->walls_tear) return;
  tick.torn_spring_count =
      tissue::TearSprings(tissue_model, GetScene().tick_seconds, w.tissue, tick.torn_springs);
  // a hollow organ leaks through what the spring no longer closes
  const WallSprings& walls = w.topology.Walls();
  for (const std::uint32_t spring : std::span(tick.torn_springs).first(tick.torn_spring_count)) {
    const std::int32_t organ = walls.organs[spring];
    if (organ == model->hollow_organ)
      conservation->Perforate(static_cast<std::size_t>(organ), walls.areas[spring], w.conserved);
  }
}

void Simulation::Content::PlaceTools() noexcept {
  world.touch.Update(GetScene(), GetTools(), world.tissue);
}

void Simulation::Content::StepRigidBodies() noexcept {
  WorldState& w = world;
  w.rigid.Step(GetScene(), w.joints, w.touch, tick.gravity);
  for (int hand = 0; hand < kHandCount; ++hand) w.forces[hand] = w.forces[hand] + w.rigid.ForceOn(hand);
}

void Simulation::Content::Flow() noexcept {
  if (world.operation == nullptr) return;
  tick.hands.changes = tick.changes;  // a grasp may have slipped in the solve
  OperatedTissue tissue = GetTissue();
  world.operation->Flow(tick.hands, tissue);
}

void Simulation::Content::MoveLoose() noexcept {
  if (world.operation != nullptr) world.operation->MoveLoose(tick.hands, GetTissue());
}

scene::Event& Simulation::Content::Remember(const scene::Event& event) noexcept {
  JudgementState& j = judgement;
  scene::Event& place = j.events[j.event_count % j.events.size()];
  place = event;
  ++j.event_count;
  return place;
}

void Simulation::Content::Emit(FactKind kind, int hand, std::int32_t organ, double force,
                               std::int32_t object) noexcept {
  surgery::Fact fact;
  fact.kind = kind;
  fact.hand = static_cast<std::int8_t>(hand);
  fact.surface = organ;
  fact.object = object;
  fact.amount = force;
  if (hand >= 0) {
    fact.tool = ToolOf(hand).kind;
    fact.position = world.touch.Proxy(hand).translation;
  }
  tick.facts.Add(fact);
  Remember({kind, world.tick, hand, organ, force, object});
}

void Simulation::Content::EmitGrasps() noexcept {
  for (int hand = 0; hand < kHandCount; ++hand) {
    const double force = math::Norm(world.forces[hand]);
    switch (tick.changes[hand]) {
      case surgery::GraspChange::kNone:
        break;
      case surgery::GraspChange::kGrasped:
        Emit(FactKind::kGrasp, hand, tick.changed_organs[hand], force);
        break;
      case surgery::GraspChange::kMissed:
        Emit(FactKind::kGraspMissed, hand, -1, 0.0);
        break;
      case surgery::GraspChange::kReleased:
        Emit(FactKind::kRelease, hand, tick.changed_organs[hand], force);
        break;
      case surgery::GraspChange::kSlipped:
        Emit(FactKind::kSlip, hand, tick.changed_organs[hand], force);
        break;
      case surgery::GraspChange::kDamaged:
        Emit(FactKind::kPinchDamage, hand, tick.changed_organs[hand], world.grasps[hand].pinch);
        break;
    }
  }
  world.rigid.ForEachChange([&](FactKind kind, int hand, std::int32_t object) {
    Emit(kind, hand, -1, math::Norm(world.forces[hand]), object);
  });
}

void Simulation::Content::Judge() noexcept {
  JudgementState& j = judgement;
  const std::size_t of_operation = tick.facts.All().size();
  for (int hand = 0; hand < kHandCount; ++hand) {
    if (tick.was_exchange_refused[hand])
      Emit(FactKind::kExchangeRefused, hand, world.grasps[hand].surface, 0.0);
  }
  EmitGrasps();
  const bool are_touching = world.touch.AreToolsTouching();
  if (are_touching && !j.were_tools_touching) Emit(FactKind::kToolsTouch, -1, -1, 0.0);
  j.were_tools_touching = are_touching;
  if (tick.torn_count > 0) Emit(FactKind::kTear, -1, model->tissue->strand_organs[tick.torn[0]], 0.0);
  if (tick.torn_spring_count > 0)
    Emit(FactKind::kTear, -1, world.topology.Walls().organs[tick.torn_springs[0]], 0.0);
  if (tick.verdict == tissue::GuardVerdict::kRestored) Emit(FactKind::kStateRestored, -1, -1, 0.0);
  const bool is_frozen = tick.verdict == tissue::GuardVerdict::kFrozen;
  if (is_frozen && !j.was_frozen) Emit(FactKind::kOrganFrozen, -1, -1, 0.0);
  j.was_frozen = is_frozen;
  if (world.operation == nullptr) return;
  RememberFacts(tick.facts.All().first(of_operation));
  if (j.procedure == nullptr) return;
  j.procedure->Update(world.operation->Observe(tick.hands, GetTissue(), GetCamera()));
  for (const surgery::ErrorEntry& entry : j.procedure->NewErrors()) {
    scene::Event& event = Remember({FactKind::kVerdict, world.tick, entry.hand, -1, 0.0});
    event.error = entry.error.row;
    event.p_rest = entry.place;
  }
}

/// Those that count as events, as many as the ring holds.
void Simulation::Content::RememberFacts(std::span<const surgery::Fact> facts) noexcept {
  std::size_t count = 0;
  for (const surgery::Fact& fact : facts) {
    if (!surgery::IsEvent(fact.kind) || count == kEventRing) continue;
    ++count;
    Remember({fact.kind, world.tick, fact.hand, fact.surface, 0.0}).p_rest = fact.p_rest;
  }
}

void Simulation::Content::Publish() noexcept {
  const WorldState& w = world;
  snapshot.tick = w.tick;
  snapshot.time = static_cast<double>(w.tick) * GetScene().tick_seconds;
  std::copy(w.tissue.position.begin(), w.tissue.position.end(), snapshot.positions.begin());
  for (int hand = 0; hand < kHandCount; ++hand) {
    InstrumentSnapshot& tool = snapshot.instruments[hand];
    tool.X_world_tool = w.touch.Proxy(hand);
    tool.joints = w.joints[hand];
    tool.force = w.forces[hand];
    tool.is_grasping = w.grasps[hand].IsHolding() || w.rigid.HeldBy(hand) >= 0;
    tool.object = w.rigid.HeldBy(hand);
    tool.is_touching = tick.touched_organs[hand] >= 0;
    tool.organ = tick.touched_organs[hand];
    tool.X_world_device = w.touch.Device(hand);
    tool.pinch = std::max(w.grasps[hand].pinch, w.rigid.Pinch(hand));
    tool.overlap = w.touch.Overlap(hand);
    tool.is_touching_tool = w.touch.AreToolsTouching();
  }
  snapshot.contacts = w.touch.Contacts().springs.size();
  snapshot.dropped_contacts = w.touch.Contacts().dropped;
  snapshot.laparoscope = w.laparoscope;
  snapshot.X_world_laparoscope = GetCamera().X_world_camera;
  for (std::size_t i = 0; i < w.conserved.organs.size(); ++i) {
    const tissue::OrganVolume& organ = w.conserved.organs[i];
    snapshot.organs[i] = {organ.volume, organ.target, organ.pressure, organ.leaked};
  }
  if (w.operation != nullptr) {
    w.operation->Publish(w.tissue, snapshot.operation);
    if (judgement.procedure != nullptr) simulation::Publish(*judgement.procedure, snapshot.operation);
  }
  snapshot.residual = tick.report.residual;
  snapshot.iterations = tick.report.iterations;
  snapshot.gravity = tick.gravity;
  w.rigid.Publish(snapshot.objects);
  snapshot.dents = w.touch.Neighbours().Dents();
  snapshot.events = judgement.events;
  snapshot.event_count = judgement.event_count;
  const auto facts = tick.facts.All();
  snapshot.fact_count = std::min(facts.size(), snapshot.facts.size());
  std::copy_n(facts.begin(), snapshot.fact_count, snapshot.facts.begin());
}

void Simulation::Content::JudgeTask() noexcept {
  judgement.monitor.Update(GetScene(), snapshot, judgement.task);
  snapshot.task = judgement.task;
}

}  // namespace trocar::simulation
