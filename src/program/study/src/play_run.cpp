// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "trocar/agent/surgeon.h"
#include "trocar/base/state_hash.h"
#include "trocar/files/find_scene.h"
#include "trocar/scene/procedure.h"
#include "trocar/simulation/attempt_end.h"
#include "trocar/simulation/simulation.h"
#include "trocar/study/study.h"

namespace trocar::study {
namespace {

constexpr double kMillilitre = 1e-6;  // m^3

/// What both tools do over a run.
struct Sums {
  std::array<double, instrument::kHandCount> path{}, impulse{}, most_force{};  // [m], [N s], [N]
  std::array<math::Vec3, instrument::kHandCount> last{};
  double iterations = 0;
  std::uint64_t pinched = 0, torn = 0, restored = 0, events_seen = 0;
  std::uint64_t ticks = 0;

  void Begin(const simulation::Snapshot& now) {
    for (std::size_t i = 0; i < last.size(); ++i) last[i] = now.instruments[i].X_world_tool.translation;
  }
  void Add(const simulation::Snapshot& now, double seconds) {
    ++ticks;
    iterations += now.iterations;
    for (std::size_t i = 0; i < last.size(); ++i) {
      const simulation::InstrumentSnapshot& tool = now.instruments[i];
      path[i] += math::Distance(last[i], tool.X_world_tool.translation);
      last[i] = tool.X_world_tool.translation;
      const double force = math::Norm(tool.force);
      impulse[i] += force * seconds;
      most_force[i] = std::max(most_force[i], force);
    }
    // the ring holds the newest: in a tick with more, the older ones are not counted
    const std::uint64_t first =
        now.event_count > simulation::kEventRing ? now.event_count - simulation::kEventRing : 0;
    for (std::uint64_t n = std::max(events_seen, first); n < now.event_count; ++n) {
      const surgery::FactKind kind = now.events[n % simulation::kEventRing].kind;
      pinched += kind == surgery::FactKind::kPinchDamage ? 1 : 0;
      torn += kind == surgery::FactKind::kTear ? 1 : 0;
      restored += kind == surgery::FactKind::kStateRestored ? 1 : 0;
    }
    events_seen = now.event_count;
  }
};

bool HasCome(Until moment, const simulation::Snapshot& now) {
  switch (moment) {
    case Until::kEnd:
      break;
    case Until::kCriticalView:
      return now.operation.procedure.view.IsAchieved();
    case Until::kFree:
      return now.operation.is_organ_free;
  }
  return false;
}

std::string NameOutcome(const simulation::Snapshot& last, Until until, bool has_finished) {
  if (HasCome(until, last)) return "completed";
  if (simulation::HasCompleted(last)) return "completed";
  if (last.task.phase == scene::TaskPhase::kTimeOver) return "time over";
  if (last.task.phase == scene::TaskPhase::kEnded) return "ended by an error";
  return has_finished ? "given up" : "cut off";
}

}  // namespace

base::Result<RunResult> PlayRun(const StudyPlan& plan, const Run& run) {
  auto read = files::FindScene(plan.task, {plan.level, run.seed, run.patient});
  if (!read) return read.error();
  for (std::size_t i = 0; i < run.values.size(); ++i) {
    for (const Parameter& parameter : Parameters())
      if (parameter.name == plan.parameters[i].name) parameter.apply(*read, run.values[i]);
  }
  if (plan.until != Until::kEnd && !read->operation)
    return base::Error{base::ErrorCode::kStudyInvalid,
                       "\"until\" names a moment of an operation; " + plan.task + " is none: leave it out"};
  const auto scene = std::make_shared<const scene::Scene>(std::move(*read));
  auto simulation = simulation::Simulation::Make(scene);
  if (!simulation) return simulation.error();
  auto surgeon = agent::MakeSurgeon(run.surgeon, scene, run.seed);
  if (!surgeon) return surgeon.error();
  const simulation::Snapshot& now = simulation->GetSnapshot();
  Sums sums;
  sums.Begin(now);
  while (!(*surgeon)->HasFinished() && now.time < plan.most_seconds && !HasCome(plan.until, now) &&
         now.task.phase != scene::TaskPhase::kTimeOver && now.task.phase != scene::TaskPhase::kEnded) {
    simulation->Step((*surgeon)->Act(now));
    sums.Add(now, scene->tick_seconds);
  }

  const simulation::OperationSnapshot& operation = now.operation;
  const scene::Procedure* procedure = scene::ProcedureOf(*scene);
  const auto& blood = operation.flow.ledger.fluids[static_cast<std::size_t>(surgery::Fluid::kBlood)];
  std::uint64_t task_errors = 0;
  for (const std::uint32_t count : now.task.errors) task_errors += count;
  RunResult result;
  result.outcome = NameOutcome(now, plan.until, (*surgeon)->HasFinished());
  result.state_hash = base::HashText(simulation->Hash());
  result.numbers = {{"completed", result.outcome == "completed" ? 1.0 : 0.0},
                    {"seconds", now.time},
                    {"score", now.task.score},
                    {"errors", static_cast<double>(scene->operation ? operation.errors : task_errors)},
                    {"critical_errors", static_cast<double>(operation.critical_errors)},
                    {"path_left_m", sums.path[0]},
                    {"path_right_m", sums.path[1]},
                    {"most_force_left_n", sums.most_force[0]},
                    {"most_force_right_n", sums.most_force[1]},
                    {"impulse_left_ns", sums.impulse[0]},
                    {"impulse_right_ns", sums.impulse[1]},
                    {"pinch_damages", static_cast<double>(sums.pinched)},
                    {"tears", static_cast<double>(sums.torn)},
                    {"critical_view", static_cast<double>(operation.procedure.view.Sum())},
                    {"detached_share", scene::MeasureOf(procedure, operation.procedure, "detached_share")},
                    {"cleared_share", scene::MeasureOf(procedure, operation.procedure, "cleared_share")},
                    {"blood_pooled_ml", blood.pooled / kMillilitre},
                    {"solver_iterations_per_tick",
                     sums.iterations / static_cast<double>(std::max<std::uint64_t>(1, sums.ticks))},
                    {"restored_states", static_cast<double>(sums.restored)}};
  return result;
}

}  // namespace trocar::study
