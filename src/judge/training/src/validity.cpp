// SPDX-License-Identifier: Apache-2.0
#include "trocar/training/validity.h"

#include <algorithm>

#include "trocar/host/json.h"

namespace trocar::training {

const MeasureValidity* TaskValidity::Find(std::string_view metric, std::string_view hand) const noexcept {
  const auto found = std::find_if(measures.begin(), measures.end(), [&](const MeasureValidity& measure) {
    return measure.metric == metric && measure.hand == hand;
  });
  return found == measures.end() ? nullptr : &*found;
}

const TaskValidity* Validity::FindTask(std::string_view task) const noexcept {
  const auto found =
      std::find_if(tasks.begin(), tasks.end(), [&](const TaskValidity& one) { return one.task == task; });
  return found == tasks.end() ? nullptr : &*found;
}

base::Result<Validity> ParseValidity(std::string_view text, const std::string& name) {
  auto document = host::JsonDocument::Parse(text, name);
  if (!document.ok()) return document.error();
  const host::JsonView root = document->Root();
  root.AllowOnly({"format", "version", "about", "study", "tasks"});
  if (root.Text("format") != "trocar-validity") root.Complain("the format is not \"trocar-validity\"");
  if (root.Integer("version") != 1) root.Complain("the version is not 1");
  Validity validity;
  for (const host::JsonView& task : root.Array("tasks")) {
    task.AllowOnly({"task", "level", "people", "measures"});
    TaskValidity made{task.Text("task"), task.Text("level"), {}};
    for (const host::JsonView& view : task.Array("measures")) {
      view.AllowOnly({"metric", "hand", "separates", "auc", "expert_mean", "expert_sd", "experts"});
      made.measures.push_back({view.Text("metric"), view.TextOr("hand", ""),
                               view.BooleanOr("separates", false), view.Number("auc", {0, 1}),
                               view.Number("expert_mean"), view.Number("expert_sd", {0, 1e300}),
                               view.Integer("experts", {1, 1e9})});
    }
    validity.tasks.push_back(std::move(made));
  }
  if (const auto status = document->Check(); !status.ok()) return status.error();
  return validity;
}

std::string_view ValidityWords(const TaskValidity* task, std::string_view metric,
                               std::string_view hand) noexcept {
  const MeasureValidity* found = task == nullptr ? nullptr : task->Find(metric, hand);
  if (found == nullptr) return "not studied";
  return found->separates ? "separates" : "does not separate";
}

}  // namespace trocar::training
