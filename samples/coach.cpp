// SPDX-License-Identifier: Apache-2.0
// A scripted person whose hands tremble does a task, and the coach says what cost most.
//   sample_coach RULES.json VALIDITY.json
#include <cstdio>
#include <memory>

#include "trocar/agent/skill.h"
#include "trocar/files/task_file.h"
#include "trocar/host/safe_file.h"
#include "trocar/record/trace.h"
#include "trocar/scene/task.h"
#include "trocar/simulation/simulation.h"
#include "trocar/training/attempt_metrics.h"
#include "trocar/training/coach.h"

using namespace trocar;  // NOLINT(google-build-using-namespace): a sample shows calls, not names

int main(int argc, char** argv) {
  if (argc != 3) return std::printf("use: sample_coach RULES.json VALIDITY.json\n"), 2;
  const auto rules_text = host::ReadFile(argv[1]), validity_text = host::ReadFile(argv[2]);
  if (!rules_text.ok() || !validity_text.ok()) return std::printf("the files cannot be read\n"), 1;
  const auto rules = training::ParseCoachRules(*rules_text, argv[1]);
  const auto validity = training::ParseValidity(*validity_text, argv[2]);
  if (!rules.ok() || !validity.ok()) return std::printf("the files are not what they should be\n"), 1;

  const auto path = files::FindTask("instrument_navigation");
  auto read = path.ok() ? files::ReadTask(*path) : path.error();
  if (!read.ok()) return std::printf("%s\n", read.error().Text().c_str()), 1;
  const auto task = std::make_shared<const scene::Scene>(std::move(*read));
  const agent::SurgeonSkill skill =
      agent::PlantWeakness(agent::LevelSkill(agent::SkillLevel::kExpert), agent::Weakness::kTremor);
  auto person = agent::MakeSkilledSurgeon(task, skill, 1);
  auto simulation = simulation::Simulation::Make(task);
  if (!person.ok() || !simulation.ok()) return 1;

  record::TraceBuilder builder(*simulation);
  builder.Add(simulation->GetSnapshot());
  while (!(*person)->HasFinished()) {
    const scene::Input input = (*person)->Act(simulation->GetSnapshot());
    simulation->Step(input);
    builder.Add(simulation->GetSnapshot(), input.controls);
  }
  const training::AttemptTrace trace = builder.Calc();
  const auto metrics = training::CalcAttemptMetrics(trace);
  if (!metrics.ok()) return 1;
  for (const training::Advice& advice :
       training::CoachAttempt(trace, *metrics, *rules, validity->FindTask("instrument_navigation")))
    std::printf("%s %s\n  %s\n  %s: %s\n", advice.sentence.c_str(), advice.look.c_str(), advice.why.c_str(),
                advice.exercise.c_str(), advice.practise.c_str());
  return 0;
}
