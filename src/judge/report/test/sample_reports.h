// SPDX-License-Identifier: Apache-2.0
/// \file sample_reports.h  Attempts for the tests: a task, and an operation with everything that a report can hold.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "trocar/report/attempt_report.h"
#include "trocar/training/attempt_metrics.h"

namespace trocar::report::test {

inline constexpr double kTick = 1.0 / 120;

/// Two hands on curves, with force where they press.
inline training::AttemptTrace MakeTrace(double seconds, bool is_operation) {
  training::AttemptTrace trace;
  trace.dt = kTick;
  trace.tool_names = {"grasper", "hook"};
  trace.organ_names = {"liver", "gallbladder", "cystic_duct"};
  const auto ticks = static_cast<std::size_t>(seconds / kTick) + 1;
  for (std::size_t i = 0; i < ticks; ++i) {
    const double t = static_cast<double>(i) * kTick;
    for (int hand = 0; hand < 2; ++hand) {
      const double side = hand == 0 ? 1 : -1;
      training::ToolSample sample;
      sample.tip = {side * 0.03 + 0.02 * std::sin(0.9 * t + hand),
                    0.025 * std::sin(0.53 * t * (1 + 0.2 * hand)), 0.01 * std::cos(0.7 * t)};
      sample.force = std::max(0.0, 2.2 * std::sin(0.4 * t + 2 * hand) + 1.4 * std::sin(2.3 * t));
      sample.in_contact = sample.force > 0;
      sample.tool = static_cast<std::int16_t>(hand);
      trace.hands[static_cast<std::size_t>(hand)].push_back(sample);
    }
    trace.camera.push_back({});
  }
  trace.is_operation = is_operation;
  training::AttemptEvent error;
  const auto add = [&](double time, surgery::Severity severity, int hand, int organ, const char* text) {
    error.time = time, error.kind = "an_error", error.hand = hand, error.organ = organ;
    error.is_error = true, error.severity = severity, error.text = text;
    trace.events.push_back(error);
  };
  add(0.11 * seconds, surgery::Severity::kMinor, 1, 0, "The force on the tissue was too great");
  add(0.42 * seconds, surgery::Severity::kMajor, 0, 1,
      "A clip was placed before the critical view of safety");
  if (is_operation) add(0.77 * seconds, surgery::Severity::kCritical, 1, 2, "The common bile duct was burnt");
  if (is_operation) {
    trace.phases = {{"Preparation", 0, 0.1 * seconds},
                    {"CalotTriangleDissection", 0.1 * seconds, 0.4 * seconds},
                    {"ClippingCutting", 0.4 * seconds, 0.55 * seconds},
                    {"CalotTriangleDissection", 0.55 * seconds, 0.6 * seconds},
                    {"GallbladderDissection", 0.6 * seconds, seconds}};
    trace.fluids = {{0, 0, 0}, {seconds, 12.5e-6, 1.25e-6}};
    trace.critical_view_time = 0.39 * seconds;
    trace.outcome = {"completed", true, {}, 0};
  } else {
    trace.goals = {{"Ring on the first peg", 0.3 * seconds, 10},
                   {"Ring on the second peg", 0.9 * seconds, 10}};
    trace.outcome = {"completed", true, 87.5, seconds - 1};
  }
  return trace;
}

inline AttemptFacts MakeFacts() {
  AttemptFacts facts;
  facts.person = "T-7F3K2Q";
  facts.task = "Object transport";
  facts.task_key = "object_transport";
  facts.level = "hard";
  facts.seed = 7;
  facts.started = "2026-11-24T22:50:20+01:00";
  facts.player = "mouse and keyboard";
  facts.program = "0.1.0";
  facts.recording = "attempt.trocar";
  facts.best_score = 100;
  return facts;
}

inline training::AttemptMetrics MakeMetrics(const training::AttemptTrace& trace) {
  auto metrics = training::CalcAttemptMetrics(trace);
  EXPECT_TRUE(metrics.ok()) << metrics.error().Text();
  return metrics.ok() ? *metrics : training::AttemptMetrics();
}

/// An expert set that is somewhat better, and a group around.
inline std::vector<MetricReference> MakeReferences(const training::AttemptMetrics& metrics) {
  std::vector<MetricReference> references;
  for (const char* id :
       {"time", "path_length", "movements", "sparc", "idle_fraction", "max_force", "mean_speed"}) {
    for (const char* hand : {"", "left", "right"}) {
      const double* value = metrics.Find(id, hand);
      if (value == nullptr) continue;
      MetricReference reference{id, hand, "", 0.85 * *value, 0.12 * std::fabs(*value) + 1e-6, {}, {}};
      for (int i = 0; i < 9; ++i) reference.group.push_back(*value * (0.8 + 0.06 * i));
      if (std::string(id) == "mean_speed") reference.separates = false;
      references.push_back(std::move(reference));
    }
  }
  return references;
}

inline std::vector<Advice> MakeAdvice() {
  return {{"The right hand pressed the liver with up to 3.6 N.", "More than 3 N can tear the capsule.",
           "lift_and_grasp", "Lift and grasp, level easy, until no force passes 3 N.", 9.0},
          {"The left hand rested for 41 % of the time.",
           "Exposure needs both hands.",
           "object_transport",
           "Object transport: hand every object over in the air.",
           {}}};
}

inline AttemptReport MakeTaskReport() {
  const auto trace = MakeTrace(90, false);
  const auto metrics = MakeMetrics(trace);
  const auto references = MakeReferences(metrics);
  const auto advice = MakeAdvice();
  return MakeAttemptReport(trace, metrics, {MakeFacts(), references, advice});
}

inline AttemptReport MakeOperationReport() {
  const auto trace = MakeTrace(240, true);
  const auto metrics = MakeMetrics(trace);
  const auto references = MakeReferences(metrics);
  const auto advice = MakeAdvice();
  AttemptFacts facts = MakeFacts();
  facts.task = "Cholecystectomy";
  facts.task_key = "cholecystectomy";
  facts.level.clear();
  facts.patient = "seed 7";
  return MakeAttemptReport(trace, metrics, {facts, references, advice});
}

}  // namespace trocar::report::test
