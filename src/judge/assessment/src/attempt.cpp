// SPDX-License-Identifier: Apache-2.0
#include "trocar/assessment/attempt.h"

#include <nlohmann/json.hpp>
#include <system_error>

#include "trocar/base/to_integer.h"
#include "trocar/host/file_lock.h"
#include "trocar/host/json.h"
#include "trocar/host/json_text.h"
#include "trocar/host/safe_file.h"

namespace trocar::assessment {
namespace {

namespace fs = std::filesystem;
using base::ErrorCode;
using host::JsonView;
using nlohmann::ordered_json;

/// Whole numbers up to this one are kept by a JSON number; a larger seed is not.
constexpr double kLargestSeed = 9007199254740992.0;
constexpr host::NumberRange kSeed{0, kLargestSeed}, kScore{0, 1e9}, kValue{-1e15, 1e15};

Milestone ReadMilestone(const JsonView& view, const char* key, Milestone fallback) {
  if (!view.Has(key)) return fallback;
  const std::string name = view.Text(key);
  if (const auto milestone = FindMilestone(name)) return *milestone;
  view.Complain(std::string(key) +
                " is \"start\", \"critical_view\", \"divided\", \"free\" or \"completed\", not \"" + name +
                "\"");
  return fallback;
}

training::MetricValue ReadMetric(const JsonView& view) {
  view.AllowOnly({"metric", "hand", "phase", "tool", "value", "unit"});
  (void)view.TextOr("unit", "");
  training::MetricValue value;
  value.metric = view.Text("metric");
  value.hand = view.TextOr("hand", "");
  value.phase = view.TextOr("phase", "");
  value.tool = view.TextOr("tool", "");
  value.value = view.Number("value", kValue);
  return value;
}

Attempt ReadAttempt(const JsonView& view) {
  view.AllowOnly({"course", "step", "task", "level", "patient", "seed", "from", "until", "started",
                  "recording", "score", "completed", "metrics"});
  Attempt attempt;
  attempt.course = view.TextOr("course", "");
  attempt.step = view.TextOr("step", "");
  if (attempt.course.empty() != attempt.step.empty())
    view.Complain("course and step are named together, or not at all");
  attempt.task = view.Text("task");
  attempt.level = view.TextOr("level", "");
  attempt.patient = view.TextOr("patient", "");
  attempt.seed = base::TruncateTo<std::uint64_t>(view.NumberOr("seed", 0, kSeed));
  attempt.from = ReadMilestone(view, "from", Milestone::kStart);
  attempt.until = ReadMilestone(view, "until", Milestone::kCompleted);
  attempt.started = view.TextOr("started", "");
  attempt.recording = view.TextOr("recording", "");
  if (view.Has("score")) attempt.score = view.Number("score", kScore);
  if (!view.Has("completed")) view.Complain("completed is missing: true or false");
  attempt.result.is_completed = view.BooleanOr("completed", false);
  for (const JsonView& metric : view.Array("metrics"))
    attempt.result.metrics.values.push_back(ReadMetric(metric));
  return attempt;
}

ordered_json AttemptJson(const Attempt& attempt) {
  ordered_json json;
  const auto put = [&](const char* key, const std::string& text) {
    if (!text.empty()) json[key] = text;
  };
  put("course", attempt.course);
  put("step", attempt.step);
  json["task"] = attempt.task;
  put("level", attempt.level);
  put("patient", attempt.patient);
  json["seed"] = attempt.seed;
  if (attempt.from != Milestone::kStart) json["from"] = NameOf(attempt.from);
  if (attempt.until != Milestone::kCompleted) json["until"] = NameOf(attempt.until);
  put("started", attempt.started);
  put("recording", attempt.recording);
  if (attempt.score) json["score"] = *attempt.score;
  json["completed"] = attempt.result.is_completed;
  json["metrics"] = ordered_json::array();
  for (const training::MetricValue& value : attempt.result.metrics.values) {
    ordered_json one = {{"metric", value.metric}};
    if (!value.hand.empty()) one["hand"] = value.hand;
    if (!value.phase.empty()) one["phase"] = value.phase;
    if (!value.tool.empty()) one["tool"] = value.tool;
    one["value"] = value.value;
    json["metrics"].push_back(std::move(one));
  }
  return json;
}

}  // namespace

base::Result<std::vector<Attempt>> ReadAttempts(const fs::path& path) {
  const auto document = host::JsonDocument::Read(path);
  if (!document.ok()) return document.error();
  const JsonView root = document->Root();
  root.AllowOnly({"format", "version", "attempts"});
  if (root.Text("format") != "trocar-attempts") root.Complain("format must be \"trocar-attempts\"");
  if (root.Integer("version") != 1) root.Complain("version must be 1");
  std::vector<Attempt> attempts;
  for (const JsonView& view : root.Array("attempts")) attempts.push_back(ReadAttempt(view));
  if (const auto status = document->Check(); !status.ok()) return status.error();
  return attempts;
}

std::string FormatAttempts(const std::vector<Attempt>& attempts) {
  ordered_json json = {{"format", "trocar-attempts"}, {"version", 1}, {"attempts", ordered_json::array()}};
  for (const Attempt& attempt : attempts) json["attempts"].push_back(AttemptJson(attempt));
  return host::FormatJson(json, 1) + "\n";
}

base::Status AppendAttempt(const fs::path& path, const Attempt& attempt) {
  auto lock = host::FileLock::Take(path.string() + ".lock");
  if (!lock.ok()) return lock.error();
  std::vector<Attempt> attempts;
  std::error_code failure;
  if (fs::exists(path, failure)) {
    auto read = ReadAttempts(path);
    if (!read.ok()) return read.error();
    attempts = std::move(*read);
  }
  attempts.push_back(attempt);
  return host::WriteFile(path, FormatAttempts(attempts));
}

}  // namespace trocar::assessment
