// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <nlohmann/json.hpp>
#include <system_error>

#include "trocar/assessment/proficiency.h"
#include "trocar/host/data_folder.h"
#include "trocar/host/json.h"
#include "trocar/host/json_choice.h"
#include "trocar/host/json_text.h"
#include "trocar/scene/scene.h"

namespace trocar::assessment {
namespace {

namespace fs = std::filesystem;
using base::Error;
using base::ErrorCode;
using host::JsonView;
using nlohmann::ordered_json;

constexpr host::NumberRange kMetricValue{-1e9, 1e9}, kDeviation{0, 1e9}, kAttempts{1, 1e6};
constexpr host::NumberRange kComposite{-kMostDeviations, kMostDeviations};

const char* NameOfBetter(Better better) {
  return better == Better::kLower ? "at_most" : "at_least";
}

MetricKey ReadKey(const JsonView& view) {
  MetricKey key{view.Text("metric"), view.TextOr("hand", ""), view.TextOr("phase", "")};
  if (key.hand != "" && key.hand != "left" && key.hand != "right" && key.hand != "camera")
    view.Complain("hand is \"left\", \"right\" or \"camera\", or left out", ErrorCode::kProficiencyInvalid);
  return key;
}

Purpose ReadPurpose(const JsonView& view) {
  return host::OneOf<Purpose>(view, "purpose",
                              {{NameOf(Purpose::kSafety), Purpose::kSafety},
                               {NameOf(Purpose::kTime), Purpose::kTime},
                               {NameOf(Purpose::kEconomy), Purpose::kEconomy},
                               {NameOf(Purpose::kQuality), Purpose::kQuality}},
                              ErrorCode::kProficiencyInvalid);
}

Better ReadBetter(const JsonView& view) {
  return host::OneOf<Better>(view, "better", {{"lower", Better::kLower}, {"higher", Better::kHigher}},
                             ErrorCode::kProficiencyInvalid);
}

Norm ReadNorm(const JsonView& view) {
  view.AllowOnly({"metric", "hand", "phase", "better", "mean", "deviation", "best_quartile", "attempts"});
  Norm norm{ReadKey(view), ReadBetter(view)};
  norm.mean = view.Number("mean", kMetricValue);
  norm.deviation = view.Number("deviation", kDeviation);
  norm.best_quartile = view.Number("best_quartile", kMetricValue);
  norm.attempts = static_cast<std::size_t>(view.Integer("attempts", kAttempts));
  return norm;
}

ordered_json KeyJson(const MetricKey& key) {
  ordered_json json = {{"metric", key.metric}};
  if (!key.hand.empty()) json["hand"] = key.hand;
  if (!key.phase.empty()) json["phase"] = key.phase;
  return json;
}

}  // namespace

std::vector<Threshold> ReadThresholds(const std::vector<JsonView>& elements) {
  std::vector<Threshold> thresholds;
  for (const JsonView& view : elements) {
    view.AllowOnly({"metric", "hand", "phase", "at_most", "at_least", "purpose", "undefined", "source"});
    Threshold threshold;
    threshold.of = ReadKey(view);
    if (view.Has("at_most") == view.Has("at_least"))
      view.Complain("a threshold has either at_most or at_least", ErrorCode::kProficiencyInvalid);
    threshold.better = view.Has("at_least") ? Better::kHigher : Better::kLower;
    threshold.value = view.Number(NameOfBetter(threshold.better), kMetricValue);
    threshold.purpose = ReadPurpose(view);
    threshold.passes_undefined = host::OneOfOr<bool>(
        view, "undefined", false, {{"fails", false}, {"passes", true}}, ErrorCode::kProficiencyInvalid);
    threshold.source = view.Text("source");
    if (threshold.source.empty())
      view.Complain("a threshold needs a source: a publication, or how it was found",
                    ErrorCode::kProficiencyInvalid);
    const auto is_same = [&](const Threshold& other) {
      return other.of == threshold.of && other.better == threshold.better;
    };
    if (std::any_of(thresholds.begin(), thresholds.end(), is_same))
      view.Complain("there is a threshold for " + TextOf(threshold.of) + " already; keep one",
                    ErrorCode::kProficiencyInvalid);
    thresholds.push_back(std::move(threshold));
  }
  return thresholds;
}

base::Result<Proficiency> ReadProficiency(const fs::path& path) {
  const auto document = host::JsonDocument::Read(path);
  if (!document.ok()) return document.error();
  const JsonView root = document->Root();
  root.AllowOnly(
      {"format", "version", "task", "level", "about", "source", "thresholds", "experts", "grades"});
  if (root.Text("format") != "trocar-proficiency") root.Complain("format must be \"trocar-proficiency\"");
  if (root.Integer("version") != 1) root.Complain("version must be 1");
  Proficiency proficiency;
  proficiency.key = path.stem().string();
  proficiency.task = root.Text("task");
  proficiency.level = root.TextOr("level", "");
  proficiency.about = root.TextOr("about", "");
  proficiency.source = root.Text("source");
  proficiency.thresholds = ReadThresholds(root.Array("thresholds"));
  if (proficiency.thresholds.empty())
    root.Complain("there is no threshold; an attempt could not fail", ErrorCode::kProficiencyInvalid);
  if (root.Has("experts")) {
    for (const JsonView& view : root.Array("experts")) proficiency.norms.push_back(ReadNorm(view));
  }
  if (root.Has("grades")) {
    for (const JsonView& view : root.Array("grades")) {
      view.AllowOnly({"name", "at_least"});
      proficiency.grades.push_back({view.Text("name"), view.Number("at_least", kComposite)});
      const auto& grades = proficiency.grades;
      if (grades.size() > 1 && !(grades.back().at_least < grades[grades.size() - 2].at_least))
        view.Complain("grades are listed from the best to the lowest", ErrorCode::kProficiencyInvalid);
    }
    if (proficiency.norms.empty())
      root.Complain("grades need experts, of whose deviations they are", ErrorCode::kProficiencyInvalid);
  }
  if (const auto status = document->Check(); !status.ok()) return status.error();
  return proficiency;
}

std::string FormatProficiency(const Proficiency& proficiency) {
  ordered_json json = {{"format", "trocar-proficiency"}, {"version", 1}, {"task", proficiency.task}};
  if (!proficiency.level.empty()) json["level"] = proficiency.level;
  if (!proficiency.about.empty()) json["about"] = proficiency.about;
  json["source"] = proficiency.source;
  json["thresholds"] = ordered_json::array();
  for (const Threshold& threshold : proficiency.thresholds) {
    ordered_json one = KeyJson(threshold.of);
    one[NameOfBetter(threshold.better)] = threshold.value;
    one["purpose"] = NameOf(threshold.purpose);
    if (threshold.passes_undefined) one["undefined"] = "passes";
    one["source"] = threshold.source;
    json["thresholds"].push_back(std::move(one));
  }
  if (!proficiency.norms.empty()) {
    json["experts"] = ordered_json::array();
    for (const Norm& norm : proficiency.norms) {
      ordered_json one = KeyJson(norm.of);
      one["better"] = norm.better == Better::kLower ? "lower" : "higher";
      one["mean"] = norm.mean;
      one["deviation"] = norm.deviation;
      one["best_quartile"] = norm.best_quartile;
      one["attempts"] = norm.attempts;
      json["experts"].push_back(std::move(one));
    }
  }
  if (!proficiency.grades.empty()) {
    json["grades"] = ordered_json::array();
    for (const Grade& grade : proficiency.grades)
      json["grades"].push_back({{"name", grade.name}, {"at_least", grade.at_least}});
  }
  return host::FormatJson(json, 2) + "\n";
}

base::Result<std::vector<Proficiency>> ListProficiencies() {
  const auto data = host::FindDataFolder();
  if (!data.ok()) return data.error();
  const fs::path folder = *data / "assets/proficiency";
  std::error_code failure;
  std::vector<Proficiency> all;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, failure)) {
    if (entry.path().extension() != ".json") continue;
    auto one = ReadProficiency(entry.path());
    if (!one.ok()) return one.error();
    all.push_back(std::move(*one));
  }
  if (failure) {
    return Error{ErrorCode::kFileMissing, folder.string() + ": " + failure.message() +
                                              "; the thresholds are delivered with the program"};
  }
  std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.key < b.key; });
  return all;
}

base::Result<Proficiency> FindProficiency(const std::string& name_or_path) {
  std::error_code ignored;
  if (name_or_path.ends_with(".json") || fs::is_regular_file(name_or_path, ignored))
    return ReadProficiency(name_or_path);
  auto all = ListProficiencies();
  if (!all.ok()) return all.error();
  std::string known;
  for (Proficiency& one : *all) {
    if (one.key == name_or_path) return std::move(one);
    known += (known.empty() ? "" : ", ") + one.key;
  }
  return Error{ErrorCode::kUnknownName, "there are no thresholds \"" + name_or_path + "\"; known are " +
                                            known + "; or give the path of a file (.json)"};
}

}  // namespace trocar::assessment
