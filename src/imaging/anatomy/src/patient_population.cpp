// SPDX-License-Identifier: Apache-2.0
#include "trocar/anatomy/patient_population.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <numbers>
#include <optional>
#include <utility>

#include "trocar/anatomy/generate_patient.h"
#include "trocar/anatomy/patient_lint.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/math/elementary.h"
#include "trocar/patient/patient.h"

namespace trocar::anatomy {
namespace {

constexpr std::string_view kInsertion = "cystic_duct_insertion", kSeries = "cystic_duct_series";

const patient::Parameter* Find(const std::vector<patient::Parameter>& parameters, std::string_view name) {
  const auto found = std::find_if(parameters.begin(), parameters.end(),
                                  [&](const patient::Parameter& p) { return p.name == name; });
  return found == parameters.end() ? nullptr : &*found;
}

/// The published series of insertions.
std::span<const Choice> FindSeries() {
  for (const ParameterRule& rule : ParameterRules()) {
    if (rule.name == kSeries) return rule.choices;
  }
  return {};
}

/// Whether the value was drawn: its source is then a publication, or general knowledge.
bool IsDrawn(const patient::Parameter& parameter) {
  return parameter.source != "set by the user" && !parameter.source.starts_with("follows from");
}

VariationCount StartCount(std::string name, std::span<const Choice> choices) {
  VariationCount count{std::move(name), 0, {}, 0, 0, 1};
  double total = 0;
  for (const Choice& choice : choices) total += choice.weight;
  for (const Choice& choice : choices)
    count.values.push_back({std::string(choice.name), choice.weight / total, 0});
  return count;
}

/// Counts one parameter over the patients that `belongs` accepts.
template <typename Belongs>
void CountOne(std::span<const std::vector<patient::Parameter>> patients, std::string_view name,
              VariationCount count, const Belongs& belongs, std::vector<VariationCount>& variations) {
  for (const auto& parameters : patients) {
    const patient::Parameter* parameter = Find(parameters, name);
    if (parameter == nullptr || !IsDrawn(*parameter) || !belongs(parameters)) continue;
    ++count.patients;
    for (ValueCount& value : count.values)
      value.observed += std::get<std::string>(parameter->value) == value.value;
  }
  if (count.patients == 0) return;
  count.degrees_of_freedom = -1;
  for (const ValueCount& value : count.values) {
    const double expected = value.configured * static_cast<double>(count.patients);
    if (expected == 0) continue;
    const double off = static_cast<double>(value.observed) - expected;
    count.chi_square += off * off / expected;
    ++count.degrees_of_freedom;
  }
  count.p_value = CalcChiSquareTail(count.chi_square, std::max(1, count.degrees_of_freedom));
  variations.push_back(std::move(count));
}

/// What is kept of one patient.
struct Outcome {
  std::optional<base::Error> failure;
  std::vector<patient::Parameter> parameters;
  LintReport lint;
  double smallest_angle_deg = 180;
};

Outcome Examine(const base::Result<patient::Patient>& patient) {
  Outcome outcome;
  if (!patient.ok()) {
    outcome.failure = patient.error();
    return outcome;
  }
  outcome.parameters = patient->parameters;
  outcome.lint = LintPatient(*patient);
  for (const patient::Organ& organ : patient->organs) {
    outcome.smallest_angle_deg =
        std::min(outcome.smallest_angle_deg, geometry::InspectMesh(organ.mesh).min_angle * 180.0 / M_PI);
  }
  return outcome;
}

void AddOutcome(PopulationReport& report, std::uint64_t seed, const Outcome& outcome) {
  if (outcome.failure) {
    report.failures.emplace_back(seed, *outcome.failure);
    return;
  }
  ++report.patients;
  for (const MeshSummary& mesh : outcome.lint.meshes) {
    ++report.meshes;
    report.closed_meshes += mesh.closed ? 1 : 0;
    report.manifold_meshes += mesh.manifold ? 1 : 0;
    report.self_intersections += mesh.self_intersections;
  }
  for (const LintFinding& finding : outcome.lint.findings) ++report.findings[finding.code];
  if (!outcome.lint.findings.empty()) report.seeds_with_findings.push_back(seed);
  report.smallest_angle_deg = std::min(report.smallest_angle_deg, outcome.smallest_angle_deg);
}

/// log Gamma(degrees / 2 + 1), by the recurrence from Gamma(1) or Gamma(1/2).
double CalcLogGamma(int degrees) {
  double sum = degrees % 2 == 0 ? 0.0 : 0.5 * math::Log(std::numbers::pi);
  for (int k = degrees; k > 0; k -= 2) sum += math::Log(0.5 * k);
  return sum;
}

}  // namespace

double CalcBinomialDeviation(double configured, std::size_t observed, std::size_t trials) {
  const auto n = static_cast<double>(trials);
  const double deviation = std::sqrt(n * configured * (1.0 - configured));
  return deviation > 0 ? (static_cast<double>(observed) - n * configured) / deviation : 0.0;
}

double CalcChiSquareTail(double chi_square, int degrees) {
  if (!(chi_square > 0)) return 1.0;
  const double a = 0.5 * degrees, x = 0.5 * chi_square;
  // the series of the lower function: all terms positive, so nothing cancels
  double term = math::Exp(a * math::Log(x) - x - CalcLogGamma(degrees)), sum = term;
  for (int n = 1; n < 10000 && term > 1e-17 * sum; ++n) {
    term *= x / (a + n);
    sum += term;
  }
  return std::clamp(1.0 - sum, 0.0, 1.0);
}

std::vector<VariationCount> CountVariations(std::span<const std::vector<patient::Parameter>> patients) {
  std::vector<VariationCount> variations;
  const auto everyone = [](const std::vector<patient::Parameter>&) { return true; };
  for (const ParameterRule& rule : ParameterRules()) {
    const std::string name(rule.name);
    if (rule.name == kSeries || rule.name == "population") continue;  // not drawn: the first unless set
    if (rule.name == kInsertion) {
      // its shares depend on the series
      for (const Choice& series : FindSeries()) {
        CountOne(
            patients, rule.name,
            StartCount(name + " (" + std::string(series.name) + ")", FindInsertionSeries(series.name)),
            [&](const std::vector<patient::Parameter>& parameters) {
              const patient::Parameter* chosen = Find(parameters, kSeries);
              return chosen != nullptr && std::get<std::string>(chosen->value) == series.name;
            },
            variations);
      }
    } else if (rule.distribution == Distribution::kChance) {
      const Choice choices[] = {{"yes", rule.centre}, {"no", 1.0 - rule.centre}};
      CountOne(patients, rule.name, StartCount(name, choices), everyone, variations);
    } else if (rule.distribution == Distribution::kChoice) {
      CountOne(patients, rule.name, StartCount(name, rule.choices), everyone, variations);
    }
  }
  return variations;
}

base::Result<PopulationReport> GeneratePopulation(const PopulationSettings& settings, const PatientSink& sink,
                                                  const std::function<void(std::size_t)>& progress) {
  if (settings.count == 0)
    return base::Error{base::ErrorCode::kUsage, "a population has at least one patient"};
  // settings that are wrong are wrong for every seed
  if (auto drawn = DrawParameters(settings.first_seed, settings.parameters); !drawn.ok())
    return drawn.error();

  std::vector<Outcome> outcomes(settings.count);
  std::mutex one_at_a_time;
  std::atomic<bool> is_ended = false;
  base::Status sink_status;
  std::size_t done = 0;
  // one patient a task, so that the bar moves and an error ends the run soon
  oneapi::tbb::parallel_for(
      oneapi::tbb::blocked_range<std::size_t>(0, settings.count, 1),
      [&](const oneapi::tbb::blocked_range<std::size_t>& range) {
        for (std::size_t i = range.begin(); i < range.end() && !is_ended; ++i) {
          const std::uint64_t seed = settings.first_seed + i;
          // while its own loops wait, this thread may not start on another patient
          const auto patient = oneapi::tbb::this_task_arena::isolate(
              [&] { return GeneratePatient(seed, settings.parameters); });
          outcomes[i] = Examine(patient);
          const std::lock_guard lock(one_at_a_time);
          if (sink && patient.ok() && !is_ended) {
            if (auto status = sink(seed, *patient); !status.ok()) sink_status = status, is_ended = true;
          }
          if (progress) progress(++done);
        }
      },
      oneapi::tbb::simple_partitioner());
  if (!sink_status.ok()) return sink_status.error();

  PopulationReport report;
  std::vector<std::vector<patient::Parameter>> parameters;
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    AddOutcome(report, settings.first_seed + i, outcomes[i]);
    if (!outcomes[i].failure) parameters.push_back(std::move(outcomes[i].parameters));
  }
  report.variations = CountVariations(parameters);
  return report;
}

}  // namespace trocar::anatomy
