// SPDX-License-Identifier: Apache-2.0
#include "study_folder.h"

#include <nlohmann/json.hpp>
#include <utility>

#include "trocar/host/json.h"
#include "trocar/host/json_text.h"
#include "trocar/host/safe_file.h"
#include "trocar/host/version.h"

namespace trocar::study {
namespace {

using nlohmann::ordered_json;

/// Whoever reads this text sees at a glance what differs.
ordered_json DescribeStudy(const std::string& plan_print, const std::string& program_print) {
  return {{"format", "trocar-study-folder"},
          {"version", 1},
          {"program", "trocar " + std::string(host::VersionText())},
          {"program_sha256", program_print},
          {"plan_sha256", plan_print}};
}

/// Empty where the field is missing or no text.
std::string TextOf(const ordered_json& json, const char* key) {
  if (!json.is_object()) return {};
  const auto found = json.find(key);
  return found != json.end() && found->is_string() ? found->get<std::string>() : std::string();
}

}  // namespace

base::Status StudyFolder::Begin(const std::filesystem::path& plan_file) const {
  const std::filesystem::path head = folder_ / "study.json";
  std::optional<ordered_json> theirs;
  std::error_code ignored;
  if (std::filesystem::exists(head, ignored)) {
    const auto text = host::ReadFile(head);
    if (!text) return text.error();
    auto read = host::ParseJson<ordered_json>(*text, head.string(), host::kSmallJson);
    if (!read.ok()) return read.error();
    theirs = std::move(*read);
  }
  const auto program = FingerprintFile("/proc/self/exe");
  if (!program) return program.error();
  const auto plan = FingerprintFile(plan_file);
  if (!plan) return plan.error();
  const ordered_json mine = DescribeStudy(*plan, *program);
  if (!theirs) return host::WriteFile(head, host::FormatJson(mine, 2) + "\n");
  if (*theirs == mine) return {};
  const bool is_program = TextOf(*theirs, "plan_sha256") == *plan;
  return base::Error{
      base::ErrorCode::kStudyChanged,
      head.string() + ": this study began with another " + (is_program ? "program" : "plan") +
          "; results of two would be mixed. Begin a new folder (-o), or go on with the one that it had"};
}

std::filesystem::path StudyFolder::ResultPath(const Run& run) const {
  return folder_ / "results" / run.key.substr(0, 2) / (run.key + ".json");
}
std::filesystem::path StudyFolder::FailurePath(const Run& run) const {
  return folder_ / "failures" / (run.key + ".json");
}

std::optional<RunResult> StudyFolder::FindResult(const Run& run) const {
  const auto text = host::ReadFile(ResultPath(run));
  if (!text) return std::nullopt;
  const auto json = host::ParseJson<ordered_json>(*text, run.key, host::kSmallJson);
  if (!json.ok() || TextOf(*json, "key") != run.key || !json->contains("numbers")) return std::nullopt;
  RunResult result;
  result.outcome = TextOf(*json, "outcome");
  result.state_hash = TextOf(*json, "state_hash");
  const ordered_json& numbers = json->at("numbers");
  if (!numbers.is_object()) return std::nullopt;
  for (const auto& [name, value] : numbers.items()) {
    if (!value.is_number()) return std::nullopt;
    result.numbers.emplace_back(name, value.get<double>());
  }
  return result;
}

base::Status StudyFolder::Keep(const StudyPlan& plan, const Run& run, const RunResult& result) const {
  ordered_json json = {{"key", run.key},
                       {"run", Describe(plan, run)},
                       {"outcome", result.outcome},
                       {"state_hash", result.state_hash},
                       {"numbers", ordered_json::object()}};
  for (const auto& [name, value] : result.numbers) json["numbers"][name] = value;
  return host::WriteFile(ResultPath(run), host::FormatJson(json, 2) + "\n");
}

base::Status StudyFolder::NoteFailure(const StudyPlan& plan, const Run& run, const std::string& why) const {
  const ordered_json json = {{"key", run.key}, {"run", Describe(plan, run)}, {"why", why}};
  return host::WriteFile(FailurePath(run), host::FormatJson(json, 2) + "\n");
}

void StudyFolder::ForgetFailure(const Run& run) const {
  std::error_code ignored;
  std::filesystem::remove(FailurePath(run), ignored);
}

std::optional<std::string> StudyFolder::FindFailure(const Run& run) const {
  const auto text = host::ReadFile(FailurePath(run));
  if (!text) return std::nullopt;
  const auto json = host::ParseJson<ordered_json>(*text, run.key, host::kSmallJson);
  return json.ok() && json->is_object() ? TextOf(*json, "why") : std::string("its note is damaged");
}

std::string Describe(const StudyPlan& plan, const Run& run) {
  std::string text = "surgeon=" + run.surgeon + " patient=" + run.patient.filename().string() +
                     " seed=" + std::to_string(run.seed);
  for (std::size_t i = 0; i < run.values.size(); ++i)
    text += " " + plan.parameters[i].name + "=" + host::FormatJson(ordered_json(run.values[i]));
  return text;
}

}  // namespace trocar::study
