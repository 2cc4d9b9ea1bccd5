// SPDX-License-Identifier: Apache-2.0
// A small study, whole: played, stopped and gone on with, judged and written; and the coach against people whose one weakness is
// known.
#include "trocar/bench/validity_study.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <memory>
#include <string>

#include "trocar/agent/skill.h"
#include "trocar/files/task_file.h"
#include "trocar/host/data_folder.h"
#include "trocar/host/safe_file.h"
#include "trocar/math/random.h"
#include "trocar/record/trace.h"
#include "trocar/scene/task.h"
#include "trocar/simulation/simulation.h"
#include "trocar/training/attempt_metrics.h"
#include "trocar/training/coach.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::bench {
namespace {

using agent::Weakness;
using testing::HasSubstr;

StudyOptions SmallStudy(const std::filesystem::path& folder) {
  StudyOptions options;
  options.tasks = {"instrument_navigation"};
  options.people = 2;
  options.has_weaknesses = options.has_careless = false;
  options.folder = folder;
  return options;
}

TEST(Study, GoesOnWhereItStoppedAndGivesTheSameForAnyNumberOfJobs) {
  test::TemporaryFolder once, twice;
  const auto whole = RunStudy(SmallStudy(once.Path()));
  ASSERT_TRUE(whole.ok()) << whole.error().Text();
  ASSERT_EQ(whole->size(), 12u) << "3 levels, 2 people, 2 repeats";
  StudyOptions options = SmallStudy(twice.Path());
  options.people = 1;
  ASSERT_TRUE(RunStudy(options).ok());
  // killed in the middle of a line
  std::ofstream(twice.Path() / "attempts.jsonl", std::ios::app) << "{\"task\": \"instru\n";
  options.people = 2;
  options.jobs = 2;
  int played = 0;
  const auto rest = RunStudy(options, [&](const std::string&, double) { ++played; });
  ASSERT_TRUE(rest.ok()) << rest.error().Text();
  EXPECT_EQ(played, 6);
  const auto page = [&](const std::vector<StudyAttempt>& attempts) {
    return FormatStudyJson(options, FindOutOfStudy(options, attempts));
  };
  EXPECT_EQ(page(*rest), page(*whole));
  options.spread = 0.3;
  const auto other = RunStudy(options);
  ASSERT_FALSE(other.ok()) << "a folder of other people";
  EXPECT_EQ(other.error().code, base::ErrorCode::kUsage);
}

StudyOptions OnPatients(const std::filesystem::path& folder) {
  StudyOptions options = SmallStudy(folder);
  options.tasks = {(*host::FindDataFolder() / "scenes/study/gallbladder_retraction.json").string()};
  options.people = 1;
  options.patients = 2;
  return options;
}

TEST(Study, PlaysFirstAttemptsOnEachPatientAndRepeatsOnTheFirst) {
  test::TemporaryFolder folder;
  StudyOptions options = OnPatients(folder.Path());
  options.repeats = 3;
  EXPECT_EQ(*CountStudyAttempts(options), 12u) << "3 levels; 2 patients and 2 repeats more";
  options.patients = 0;
  EXPECT_EQ(RunStudy(options).error().code, base::ErrorCode::kUsage) << "on which patients?";
}

// The same hands on other anatomy: reliability over patients beside that over repeats.
TEST(StudySlow, AsksHowFarThePatientDecides) {
  test::TemporaryFolder folder;
  StudyOptions options = OnPatients(folder.Path());
  options.repeats = 1;
  const auto attempts = RunStudy(options);
  ASSERT_TRUE(attempts.ok()) << attempts.error().Text();
  ASSERT_EQ(attempts->size(), 6u);
  std::map<std::string, std::map<int, double>> paths;
  for (const StudyAttempt& attempt : *attempts) {
    EXPECT_EQ(attempt.task, "gallbladder_retraction");
    EXPECT_TRUE(attempt.is_completed) << attempt.group << " on patient " << attempt.patient;
    EXPECT_EQ(attempt.seed, attempts->front().seed) << "the same hands";
    for (const StudyValue& value : attempt.values) {
      if (value.metric == "path_length" && value.hand == "left")
        paths[attempt.group][attempt.patient] = value.value;
    }
  }
  for (const auto& [group, of] : paths) {
    ASSERT_EQ(of.size(), 2u) << group;
    EXPECT_NE(of.at(0), of.at(1)) << group << ": another patient, other ways";
  }
  const auto findings = FindOutOfStudy(options, *attempts);
  ASSERT_EQ(findings.size(), 1u);
  const auto time = std::find_if(findings[0].metrics.begin(), findings[0].metrics.end(),
                                 [](const auto& f) { return f.metric == "time"; });
  ASSERT_NE(time, findings[0].metrics.end());
  EXPECT_TRUE(time->patient_icc.has_value());
  EXPECT_FALSE(time->icc.has_value()) << "nobody repeated";
  EXPECT_THAT(FormatStudyPage(options, findings, *attempts, "a machine"), HasSubstr("ICC over patients"));
  EXPECT_EQ(RunStudy(options)->size(), 6u) << "what was done is read, patient for patient";
}

TEST(Study, RefusesWhatIsNoTaskOfItsOwn) {
  test::TemporaryFolder folder;
  StudyOptions options = SmallStudy(folder.Path());
  options.tasks = {"juggling"};
  EXPECT_EQ(RunStudy(options).error().code, base::ErrorCode::kUnknownName);
}

/// Attempts with numbers that are known.
std::vector<StudyAttempt> MadeUp(int people) {
  std::vector<StudyAttempt> attempts;
  math::Random random(5);
  const std::map<std::string, double> levels = {{"novice", 60}, {"intermediate", 40}, {"expert", 20}};
  for (const auto& [level, seconds] : levels) {
    for (int person = 0; person < people; ++person) {
      for (int repeat = 0; repeat < 2; ++repeat) {
        StudyAttempt attempt{"made_up", level, person, repeat, 1};
        attempt.is_completed = true;
        const double time = seconds + 0.2 * person + 0.05 * repeat;
        attempt.values = {
            {"time", "", time}, {"coach:time", "", 2 * time}, {"coach:tremor", "", random.Uniform()}};
        if (level == "novice") attempt.values.push_back({"coach:detour", "", 1});
        attempts.push_back(attempt);
      }
    }
  }
  return attempts;
}

// A number that belongs to the person is reliable over patients, one that belongs to the anatomy is not.
TEST(Findings, TellPeopleFromPatients) {
  StudyOptions options;
  options.people = 10;
  options.repeats = 2;
  options.patients = 3;
  std::vector<StudyAttempt> attempts;
  math::Random random(7);
  for (const StudyAttempt& one : MadeUp(10)) {
    for (int patient = 0; patient < options.patients; ++patient) {
      StudyAttempt attempt{one.task, one.group, one.person, one.repeat, one.seed, patient};
      attempt.values = {{"time", "", one.values[0].value + 0.1 * random.Uniform()},
                        {"coach:detour", "", 10.0 * patient + 0.1 * random.Uniform() + 0.001 * one.person}};
      attempts.push_back(attempt);
    }
  }
  const auto findings = FindOutOfStudy(options, attempts);
  const auto find = [&](const std::string& metric) {
    return *std::find_if(findings[0].metrics.begin(), findings[0].metrics.end(),
                         [&](const auto& f) { return f.metric == metric; });
  };
  EXPECT_GT(*find("time").patient_icc, 0.99);
  EXPECT_LT(*find("coach:detour").patient_icc, 0.1);
  EXPECT_FALSE(FindOutOfStudy({}, MadeUp(10))[0].metrics[0].patient_icc.has_value());
}

TEST(Findings, SeparateRepeatAndClusterAsTheNumbersWereMade) {
  StudyOptions options;
  options.people = 40;
  const auto findings = FindOutOfStudy(options, MadeUp(40));
  ASSERT_EQ(findings.size(), 1u);
  const TaskFindings& task = findings[0];
  const auto find = [&](const std::string& metric) {
    return *std::find_if(task.metrics.begin(), task.metrics.end(),
                         [&](const auto& f) { return f.metric == metric; });
  };
  EXPECT_TRUE(find("coach:time").separates);
  EXPECT_TRUE(find("coach:time").is_ordered);
  EXPECT_EQ(find("coach:time").auc, 1);
  EXPECT_GT(*find("coach:time").icc, 0.99);
  EXPECT_NEAR(find("coach:time").expert_mean, 2 * (20 + 0.2 * 19.5 + 0.025), 1e-9);
  EXPECT_FALSE(find("coach:tremor").separates);
  EXPECT_NEAR(find("coach:tremor").auc, 0.5, 0.15);
  EXPECT_LT(*find("coach:tremor").icc, 0.5);
  EXPECT_THAT(task.left_out, testing::ElementsAre("coach:detour"));
  ASSERT_EQ(task.clusters.size(), 1u);
  EXPECT_THAT(task.clusters[0], testing::UnorderedElementsAre("time", "coach:time"));
  const auto validity = training::ParseValidity(FormatValidityJson(options, findings), "study");
  ASSERT_TRUE(validity.ok()) << validity.error().Text();
  EXPECT_EQ(training::ValidityWords(validity->FindTask("made_up"), "coach:time", ""), "separates");
  EXPECT_EQ(training::ValidityWords(validity->FindTask("made_up"), "coach:tremor", ""), "does not separate");
  const std::string page = FormatStudyPage(options, findings, MadeUp(40), "a machine");
  EXPECT_THAT(page, HasSubstr("does not separate"));
  EXPECT_THAT(page, HasSubstr("<svg"));
  EXPECT_THAT(page, testing::Not(HasSubstr("http")));
  EXPECT_THAT(FormatStudyCsv(findings), HasSubstr("made_up,normal,coach:time,,yes,yes,1,"));
}

// --- the coach

/// By what the coach calls a weakness.
const std::map<Weakness, std::string> kTopics = {
    {Weakness::kTremor, "tremor"},      {Weakness::kIdleHand, "idle_hand"}, {Weakness::kForce, "force"},
    {Weakness::kEnergyInAir, "energy"}, {Weakness::kPoorCamera, "camera"},  {Weakness::kWandering, "path"}};

struct CoachSetting {
  training::CoachRules rules;
  training::Validity validity;
};

CoachSetting ReadCoach() {
  const auto data = host::FindDataFolder();
  const auto rules_text = host::ReadFile(*data / "assets" / training::kCoachRulesFile);
  const auto validity_text = host::ReadFile(*data / "assets" / training::kValidityFile);
  auto rules = training::ParseCoachRules(*rules_text, training::kCoachRulesFile);
  auto validity = training::ParseValidity(*validity_text, training::kValidityFile);
  EXPECT_TRUE(rules.ok()) << rules.error().Text();
  EXPECT_TRUE(validity.ok()) << validity.error().Text();
  return {std::move(*rules), std::move(*validity)};
}

/// Of an able person with that weakness, whom no study has seen.
std::vector<training::Advice> CoachOne(const CoachSetting& coach, const std::string& task,
                                       std::optional<Weakness> weakness, std::uint64_t seed) {
  const auto path = files::FindTask(task);
  auto read = files::ReadTask(*path, {"normal", seed, {}});
  EXPECT_TRUE(read.ok());
  const auto scene = std::make_shared<const scene::Scene>(std::move(*read));
  agent::SurgeonSkill skill = agent::SampleSkill(agent::LevelSkill(agent::SkillLevel::kExpert), 0.2, seed);
  math::Random random(seed);
  if (weakness) skill = agent::PlantWeakness(skill, *weakness, random.Uniform(0.7, 1.3));
  auto person = agent::MakeSkilledSurgeon(scene, skill, seed);
  auto simulation = simulation::Simulation::Make(scene);
  EXPECT_TRUE(person.ok() && simulation.ok());
  record::TraceBuilder builder(*simulation);
  builder.Add(simulation->GetSnapshot());
  while (!(*person)->HasFinished() && simulation->GetSnapshot().time < 400) {
    const scene::Input input = (*person)->Act(simulation->GetSnapshot());
    simulation->Step(input);
    builder.Add(simulation->GetSnapshot(), input.controls);
  }
  const training::AttemptTrace trace = builder.Calc();
  const auto metrics = training::CalcAttemptMetrics(trace);
  EXPECT_TRUE(metrics.ok());
  return training::CoachAttempt(trace, *metrics, coach.rules, coach.validity.FindTask(task));
}

/// \return how many of so many attempts the coach names right
int CountNamed(int attempts, std::string& misses) {
  const CoachSetting coach = ReadCoach();
  const std::vector<std::pair<Weakness, std::vector<std::string>>> plans = {
      {Weakness::kTremor, {"instrument_navigation", "object_transport", "hook_dissection"}},
      {Weakness::kIdleHand, {"object_transport", "instrument_navigation"}},
      {Weakness::kForce, {"object_transport"}},
      {Weakness::kEnergyInAir, {"hook_dissection"}},
      {Weakness::kPoorCamera,
       {"object_transport", "hook_dissection"}},  // eight seconds are too short for a drift
      {Weakness::kWandering, {"instrument_navigation", "object_transport", "hook_dissection"}}};
  int named = 0;
  for (int n = 0; n < attempts; ++n) {
    const auto& [weakness, tasks] = plans[static_cast<std::size_t>(n) % plans.size()];
    const std::string& task = tasks[static_cast<std::size_t>(n) / plans.size() % tasks.size()];
    const auto advice = CoachOne(coach, task, weakness, 500000 + static_cast<std::uint64_t>(n));
    const std::string first = advice.empty() ? "nothing" : advice[0].topic;
    if (first == kTopics.at(weakness)) {
      ++named;
    } else {
      misses += std::string(agent::NameOf(weakness)) + " in " + task + ", attempt " + std::to_string(n) +
                ", was called " + first + "\n";
    }
  }
  return named;
}

TEST(CoachOfPeople, NamesThePlantedWeaknessFirst) {
  std::string misses;
  EXPECT_GE(CountNamed(18, misses), 17) << misses;
  std::fputs(misses.c_str(), stderr);
}

TEST(CoachOfPeopleSlow, NamesThePlantedWeaknessFirstIn450Of500) {
  std::string misses;
  const int named = CountNamed(500, misses);
  RecordProperty("named", named);
  EXPECT_GE(named, 450) << misses;
  std::fputs(misses.c_str(), stderr);
}

// Control: of whom nothing is planted in, nothing is said, or something mild.
TEST(CoachOfPeople, SaysLittleOfTheAble) {
  const CoachSetting coach = ReadCoach();
  int quiet = 0;
  for (std::uint64_t seed = 600000; seed < 600008; ++seed) {
    const auto advice = CoachOne(coach, "object_transport", std::nullopt, seed);
    quiet += advice.empty() ? 1 : 0;
    for (const training::Advice& one : advice) EXPECT_LT(one.numbers.deviation, 8) << one.sentence;
  }
  EXPECT_GE(quiet, 5);
}

}  // namespace
}  // namespace trocar::bench
