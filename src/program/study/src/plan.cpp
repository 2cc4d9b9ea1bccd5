// SPDX-License-Identifier: Apache-2.0
#include "trocar/study/plan.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "trocar/host/json.h"
#include "trocar/host/json_text.h"
#include "trocar/host/safe_file.h"
#include "trocar/host/sha256.h"

namespace trocar::study {
namespace {

constexpr std::uint64_t kMostRuns = 1'000'000;
constexpr double kMostSeed = 2147483647;
constexpr std::size_t kPrintDigits = 32;

constexpr Parameter kParameters[] = {
    {"stiffness_scale", "on every structural and attachment spring [-]", 0.05, 20,
     [](scene::Scene& s, double v) { s.settings.stiffness_scale = v; }},
    {"shape_scale", "on every virtual (shape) spring [-]", 0, 20,
     [](scene::Scene& s, double v) { s.settings.shape_scale = v; }},
    {"gravity", "[m/s^2]", 0, 30, [](scene::Scene& s, double v) { s.settings.gravity = v; }},
    {"head_up", "reverse Trendelenburg [rad]", -0.6, 0.6,
     [](scene::Scene& s, double v) { s.settings.head_up = v; }},
    {"right_up", "the patient's right side up [rad]", -0.6, 0.6,
     [](scene::Scene& s, double v) { s.settings.right_up = v; }},
    {"solver_max_error", "at which Newton's method stops, of the largest distance from rest [-]", 1e-8, 0.5,
     [](scene::Scene& s, double v) { s.settings.solver.max_error = v; }},
    {"solver_max_iterations", "of every solver but Newton's, per tick", 1, 100000,
     [](scene::Scene& s, double v) { s.settings.solver.max_iterations = static_cast<int>(std::lround(v)); }},
    {"newton_max_steps", "per tick", 1, 1000,
     [](scene::Scene& s, double v) {
       s.settings.solver.newton.max_steps = static_cast<int>(std::lround(v));
     }},
    {"field_of_view", "of the laparoscope [rad]", 0.3, 2.4,
     [](scene::Scene& s, double v) { s.laparoscope.field_of_view = v; }},
};

constexpr std::pair<std::string_view, Until> kMoments[] = {{"critical_view", Until::kCriticalView},
                                                           {"free", Until::kFree}};

Until ReadUntil(const host::JsonView& view) {
  if (!view.Has("until")) return Until::kEnd;
  const std::string text = view.Text("until");
  std::string known;
  for (const auto& [name, moment] : kMoments) {
    if (name == text) return moment;
    known += " " + std::string(name);
  }
  view.Complain("a run does not end at \"" + text + "\"; there are" + known, base::ErrorCode::kStudyInvalid);
  return Until::kEnd;
}

/// Of all files of a folder, by their names.
base::Result<std::string> FingerprintFolder(const std::filesystem::path& folder) {
  std::error_code failure;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder, failure))
    if (entry.is_regular_file()) files.push_back(entry.path());
  if (failure || files.empty())
    return base::Error{base::ErrorCode::kFileMissing,
                       folder.string() + " is no patient's folder; check the plan's patients"};
  std::sort(files.begin(), files.end());
  std::string all;
  for (const auto& file : files) {
    const auto print = FingerprintFile(file);
    if (!print) return print.error();
    all += file.lexically_relative(folder).generic_string() + " " + *print + "\n";
  }
  return Fingerprint(all);
}

const Parameter* FindParameter(std::string_view name) {
  const auto found = std::find_if(std::begin(kParameters), std::end(kParameters),
                                  [&](const Parameter& parameter) { return parameter.name == name; });
  return found == std::end(kParameters) ? nullptr : found;
}

void ReadParameters(const host::JsonView& view, StudyPlan& plan) {
  for (const std::string& name : view.Keys()) {
    const Parameter* parameter = FindParameter(name);
    if (parameter == nullptr) {
      std::string known;
      for (const Parameter& each : kParameters) known += " " + std::string(each.name);
      view.Complain("there is no parameter \"" + name + "\"; there are" + known,
                    base::ErrorCode::kStudyInvalid);
      continue;
    }
    ParameterValues values{name, {}};
    for (const host::JsonView& value : view.Array(name))
      values.values.push_back(value.AsNumber({parameter->low, parameter->high}));
    if (values.values.empty())
      view.Complain("\"" + name + "\" has no values", base::ErrorCode::kStudyInvalid);
    plan.parameters.push_back(std::move(values));
  }
}

std::vector<std::string> ReadTexts(const host::JsonView& view, std::string_view key,
                                   std::vector<std::string> fallback) {
  if (!view.Has(key)) return fallback;
  std::vector<std::string> texts;
  for (const host::JsonView& element : view.Array(key)) texts.push_back(element.AsText());
  if (texts.empty()) view.Complain("\"" + std::string(key) + "\" is empty", base::ErrorCode::kStudyInvalid);
  return texts;
}

}  // namespace

std::span<const Parameter> Parameters() noexcept {
  return kParameters;
}

std::string Fingerprint(std::string_view text) {
  return host::CalcSha256(text).substr(0, kPrintDigits);
}

base::Result<std::string> FingerprintFile(const std::filesystem::path& path) {
  auto digits = host::CalcSha256OfFile(path);
  if (digits) digits->resize(kPrintDigits);
  return digits;
}

base::Result<StudyPlan> ReadPlan(const std::filesystem::path& path) {
  const auto text = host::ReadFile(path);
  if (!text) return text.error();
  const auto document = host::JsonDocument::Parse(*text, path.string());
  if (!document) return document.error();
  const host::JsonView root = document->Root();
  root.AllowOnly({"format", "version", "name", "about", "task", "level", "surgeons", "patients", "seeds",
                  "parameters", "most_seconds", "until"});
  StudyPlan plan;
  if (root.Text("format") != "trocar-study-plan")
    root.Complain("format is not \"trocar-study-plan\"", base::ErrorCode::kStudyInvalid);
  if (root.Integer("version") != 1) root.Complain("version is not 1", base::ErrorCode::kStudyInvalid);
  plan.name = root.Text("name");
  plan.about = root.TextOr("about", "");
  plan.task = root.Text("task");
  plan.level = root.TextOr("level", plan.level);
  plan.surgeons = ReadTexts(root, "surgeons", plan.surgeons);
  const std::vector<double> seeds = root.Numbers("seeds", 2, {0, kMostSeed});
  if (seeds.size() == 2) {
    plan.first_seed = static_cast<std::uint64_t>(seeds[0]);
    plan.last_seed = static_cast<std::uint64_t>(seeds[1]);
    if (plan.last_seed < plan.first_seed)
      root.Complain("seeds are [first, last]", base::ErrorCode::kStudyInvalid);
  }
  if (root.Has("parameters")) ReadParameters(root.Object("parameters"), plan);
  plan.most_seconds = root.NumberOr("most_seconds", plan.most_seconds, {0.01, 1e5});
  plan.until = ReadUntil(root);
  const std::vector<std::string> patients = ReadTexts(root, "patients", {""});
  if (const auto status = document->Check(); !status) return status.error();
  plan.patients.clear();
  plan.patient_prints.clear();
  for (const std::string& patient : patients) {
    const std::filesystem::path folder =
        patient.empty() ? "" : std::filesystem::absolute(path).parent_path() / patient;
    std::string print;
    if (!patient.empty()) {
      const auto made = FingerprintFolder(folder);
      if (!made) return made.error();
      print = *made;
    }
    plan.patients.push_back(folder);
    plan.patient_prints.push_back(print);
  }
  std::uint64_t runs = (plan.last_seed - plan.first_seed + 1) * plan.surgeons.size() * plan.patients.size();
  for (const ParameterValues& parameter : plan.parameters) runs *= parameter.values.size();
  if (runs > kMostRuns)
    return base::Error{base::ErrorCode::kStudyInvalid, path.string() + " has " + std::to_string(runs) +
                                                           " runs; at most 1,000,000 are accepted"};
  return plan;
}

std::vector<Run> ListRuns(const StudyPlan& plan) {
  std::vector<std::vector<double>> combinations{{}};
  for (const ParameterValues& parameter : plan.parameters) {
    std::vector<std::vector<double>> longer;
    for (const auto& combination : combinations) {
      for (const double value : parameter.values) {
        longer.push_back(combination);
        longer.back().push_back(value);
      }
    }
    combinations = std::move(longer);
  }
  std::vector<Run> runs;
  for (const auto& values : combinations) {
    for (std::size_t p = 0; p < plan.patients.size(); ++p) {
      for (const std::string& surgeon : plan.surgeons) {
        for (std::uint64_t seed = plan.first_seed; seed <= plan.last_seed; ++seed) {
          nlohmann::json inputs = {{"task", plan.task},
                                   {"level", plan.level},
                                   {"surgeon", surgeon},
                                   {"patient", plan.patient_prints[p]},
                                   {"seed", seed},
                                   {"most_seconds", plan.most_seconds},
                                   {"parameters", nlohmann::json::object()}};
          for (const auto& [name, moment] : kMoments)
            if (plan.until == moment) inputs["until"] = name;
          for (std::size_t i = 0; i < values.size(); ++i)
            inputs["parameters"][plan.parameters[i].name] = values[i];
          runs.push_back(
              {runs.size(), Fingerprint(host::FormatJson(inputs)), surgeon, plan.patients[p], seed, values});
        }
      }
    }
  }
  return runs;
}

}  // namespace trocar::study
