// SPDX-License-Identifier: Apache-2.0
#include "trocar/record/outcome.h"

#include <nlohmann/json.hpp>
#include <utility>

#include "trocar/host/json.h"
#include "trocar/host/json_text.h"
#include "trocar/scene/procedure.h"
#include "trocar/simulation/attempt_end.h"

namespace trocar::record {
namespace {

using nlohmann::ordered_json;
using simulation::OperationResult;

constexpr double kMillilitre = 1e6;  // per m^3

ordered_json OutcomeOf(const scene::Task& task, const scene::TaskSnapshot& now) {
  ordered_json json = {{"phase", scene::PhaseName(now.phase)},
                       {"task_seconds", now.time},
                       {"score", scene::CalcShownScore(task, now)},
                       {"penalty", now.penalty},
                       {"goals", ordered_json::array()},
                       {"errors", ordered_json::object()}};
  for (std::size_t g = 0; g < now.goals.size(); ++g) {
    json["goals"].push_back({{"goal", task.goals[g].name},
                             {"done", now.goals[g].is_done},
                             {"steps_done", now.goals[g].steps_done}});
  }
  for (std::size_t e = 0; e < now.errors.size(); ++e) {
    if (now.errors[e] > 0) json["errors"][task.errors[e].name] = now.errors[e];
  }
  return json;
}

ordered_json OutcomeOf(const OperationResult& result, const scene::Procedure* procedure) {
  const scene::ProcedureResult& judged = result.procedure;
  const auto left = [&](surgery::Fluid fluid) {
    return kMillilitre * result.fluids.fluids[static_cast<std::size_t>(fluid)].left;
  };
  ordered_json errors = ordered_json::array();
  for (const surgery::ErrorEntry& entry : judged.errors.Entries()) {
    errors.push_back({{"error", judged.errors.RowOf(entry).name},
                      {"severity", surgery::NameOf(judged.errors.RowOf(entry).severity)},
                      {"time_s", entry.time},
                      {"hand", entry.hand}});
  }
  ordered_json json = {{"completed", result.is_completed},
                       {"critical_view", judged.was_view_achieved},
                       {"phase", scene::PhaseName(procedure, judged.now.phase)},
                       {"error_count", judged.errors.Count()},
                       {"errors", std::move(errors)}};
  for (const scene::Finding& finding : judged.findings)
    std::visit([&](const auto& value) { json[std::string(finding.name)] = value; }, finding.value);
  json["blood_ml"] = left(surgery::Fluid::kBlood);
  json["bile_ml"] = left(surgery::Fluid::kBile);
  json["stones_spilled"] = result.stones.spilled;
  for (std::size_t row = 0; procedure != nullptr && row < procedure->measures.size(); ++row) {
    const scene::MeasureRow& measure = procedure->measures[row];
    if (measure.is_share) json[std::string(measure.name)] = judged.now.Measure(row);
  }
  return json;
}

std::optional<ordered_json> ReadObject(std::string_view outcome) {
  auto parsed = host::ParseJson<ordered_json>(outcome, "the outcome", host::kSmallJson);
  if (!parsed.ok() || !parsed->is_object()) return std::nullopt;
  return std::move(*parsed);
}

std::string Written(const ordered_json& json) {
  return host::FormatJson(json);
}

}  // namespace

std::string CalcOutcome(const simulation::Simulation& simulation) {
  const simulation::Snapshot& now = simulation.GetSnapshot();
  ordered_json json = {{"seconds", now.time}};
  if (const auto& task = simulation.GetScene().task) json["task"] = OutcomeOf(*task, now.task);
  if (const auto result = simulation.GetOperationResult())
    json["operation"] = OutcomeOf(*result, scene::ProcedureOf(simulation.GetScene()));
  return Written(json);
}

std::optional<OutcomeSummary> ReadOutcome(std::string_view outcome) {
  using scene::TaskPhase;
  const auto object = ReadObject(outcome);
  if (!object) return std::nullopt;
  const ordered_json& json = *object;
  const auto field = [](const ordered_json& of, const char* key) {
    const auto found = of.find(key);
    return found == of.end() ? ordered_json() : *found;
  };
  OutcomeSummary summary;
  const auto task = field(json, "task"), operation = field(json, "operation");
  const auto phase = task.is_object() ? (field(task, "phase") == scene::PhaseName(TaskPhase::kCompleted)
                                             ? TaskPhase::kCompleted
                                             : TaskPhase::kRunning)
                                      : TaskPhase::kNone;
  const bool is_operation_completed = operation.is_object() && field(operation, "completed") == true;
  summary.is_completed = simulation::HasCompleted(phase, is_operation_completed);
  if (task.is_object()) {
    if (const auto score = field(task, "score"); score.is_number()) summary.score = score.get<double>();
  }
  return summary;
}

CourseStep FindCourseStep(std::string_view outcome) {
  const auto object = ReadObject(outcome);
  if (!object) return {};
  const auto course = object->find("course");
  if (course == object->end() || !course->is_object()) return {};
  const auto text = [&course](const char* key) {
    const auto found = course->find(key);
    return found != course->end() && found->is_string() ? found->get<std::string>() : std::string();
  };
  return {text("course"), text("step")};
}

std::string WithCourseStep(std::string_view outcome, const CourseStep& step) {
  ordered_json json = ReadObject(outcome).value_or(ordered_json::object());
  json["course"] = {{"course", step.course}, {"step", step.step}};
  return Written(json);
}

}  // namespace trocar::record
