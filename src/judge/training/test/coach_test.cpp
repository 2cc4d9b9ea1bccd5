// SPDX-License-Identifier: Apache-2.0
// Each habit alone in a made-up attempt: the coach's measure finds it and its moment, and the rule that is meant speaks.
#include "trocar/training/coach.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>

#include "trocar/host/safe_file.h"
#include "trocar/training/attempt_metrics.h"
#include "trocar/training/coach_measures.h"
#include "trocar/training/validity.h"

namespace trocar::training {
namespace {

using testing::HasSubstr;

constexpr double kDt = 1.0 / 120;
constexpr double kReachSeconds = 1.0, kReach = 0.08;

/// From 0 to 1 in a minimum-jerk reach.
double Blend(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * t * (10 + t * (-15 + 6 * t));
}

/// Both hands go to and fro by 80 mm, a second each way, with half a second of rest between.
AttemptTrace MakeAttempt(double seconds) {
  AttemptTrace trace;
  trace.dt = kDt;
  const auto ticks = static_cast<std::size_t>(seconds / kDt) + 1;
  for (std::size_t h = 0; h < 2; ++h) {
    for (std::size_t i = 0; i < ticks; ++i) {
      const double period = kReachSeconds + 0.5, time = static_cast<double>(i) * kDt;
      const auto legs = static_cast<int>(time / period);
      const double s = Blend((time - legs * period) / kReachSeconds);
      ToolSample sample;
      sample.tip = {(h == 0 ? -0.1 : 0.02) + kReach * (legs % 2 == 0 ? s : 1 - s), 0, -0.1};
      trace.hands[h].push_back(sample);
    }
  }
  return trace;
}

const CoachMeasure& Get(const std::vector<CoachMeasure>& measures, const std::string& name) {
  return *std::find_if(measures.begin(), measures.end(),
                       [&](const CoachMeasure& one) { return one.name == name; });
}

TEST(CoachMeasures, AreQuietForASteadyAttempt) {
  const auto measures = CalcCoachMeasures(MakeAttempt(30));
  EXPECT_LT(Get(measures, "tremor").value, 0.1e-3);
  EXPECT_EQ(Get(measures, "one_hand_waits").value, 0);
  EXPECT_EQ(Get(measures, "peak_force").value, 0);
  EXPECT_EQ(Get(measures, "energy_in_air").value, 0);
  EXPECT_EQ(Get(measures, "tips_unseen").value, 0);
  EXPECT_LT(Get(measures, "detour").value, 1e-3);
  EXPECT_EQ(Get(measures, "corrections").value, 0);
  EXPECT_NEAR(Get(measures, "time").value, 30, 1e-9);
}

TEST(CoachMeasures, SayNothingOfAnEmptyAttempt) {
  AttemptTrace trace;
  trace.dt = kDt;
  for (const CoachMeasure& measure : CalcCoachMeasures(trace)) {
    EXPECT_EQ(measure.value, 0) << measure.name;
    EXPECT_FALSE(measure.moment.has_value()) << measure.name;
  }
}

// A sine of amplitude A has the root mean square A / sqrt 2.
TEST(CoachMeasures, TremorIsItsRootMeanSquareAndTheHandThatTrembles) {
  AttemptTrace trace = MakeAttempt(30);
  for (std::size_t i = 0; i < trace.Ticks(); ++i)
    trace.hands[1][i].tip.y += 0.001 * std::sin(2 * M_PI * 10 * static_cast<double>(i) * kDt);
  const CoachMeasure tremor = Get(CalcCoachMeasures(trace), "tremor");
  EXPECT_NEAR(tremor.value, 0.001 / std::sqrt(2.0), 0.15e-3);
  ASSERT_TRUE(tremor.moment.has_value());
  EXPECT_EQ(tremor.moment->hand, instrument::kRight);
  // slower than any tremor
  AttemptTrace slow = MakeAttempt(30);
  for (std::size_t i = 0; i < slow.Ticks(); ++i)
    slow.hands[1][i].tip.y += 0.001 * std::sin(2 * M_PI * 1.5 * static_cast<double>(i) * kDt);
  EXPECT_LT(Get(CalcCoachMeasures(slow), "tremor").value, 0.1e-3);
}

TEST(CoachMeasures, AHandThatWaitsIsNamedWithItsLongestWait) {
  AttemptTrace trace = MakeAttempt(30);
  const math::Vec3 rest = trace.hands[0][0].tip;
  // ticks 1200 to 2400, and to the end of the leg in which it stopped
  for (std::size_t i = 1200; i < trace.Ticks(); ++i) trace.hands[0][i].tip = rest;
  const CoachMeasure waits = Get(CalcCoachMeasures(trace), "one_hand_waits");
  EXPECT_NEAR(waits.value, 0.66, 0.05);
  ASSERT_TRUE(waits.moment.has_value());
  EXPECT_EQ(waits.moment->hand, instrument::kLeft);
  EXPECT_NEAR(waits.moment->time, 10, 0.7);
}

TEST(CoachMeasures, ForceEnergyAndViewAreFoundWhereTheyAre) {
  AttemptTrace trace = MakeAttempt(30);
  for (std::size_t i = 600; i < 720; ++i) trace.hands[1][i].force = 4;
  trace.hands[0][700].force = 6;
  for (std::size_t i = 900; i < 1020; ++i) {
    trace.hands[1][i].pedal = true;
    trace.hands[1][i].has_current = i >= 960;
  }
  for (std::size_t i = 1800; i < 2160; ++i) trace.hands[0][i].in_view = false;
  const auto measures = CalcCoachMeasures(trace);
  EXPECT_NEAR(Get(measures, "peak_force").value, 4, 0.5);
  EXPECT_EQ(Get(measures, "peak_force").most, 6) << "what a plot of the force peaks at";
  EXPECT_NEAR(Get(measures, "peak_force").moment->time, 700 * kDt, 1e-9);
  EXPECT_EQ(Get(measures, "peak_force").moment->hand, instrument::kLeft);
  EXPECT_NEAR(Get(measures, "energy_in_air").value, 0.5, 1e-9);
  EXPECT_NEAR(Get(measures, "energy_in_air").moment->time, 7.5, 1e-9);
  EXPECT_NEAR(Get(measures, "tips_unseen").value, 360.0 / static_cast<double>(trace.Ticks()), 1e-9);
  EXPECT_NEAR(Get(measures, "tips_unseen").moment->seconds, 3, 1e-9);
}

// A half circle is longer than its diameter by pi / 2 - 1.
TEST(CoachMeasures, DetourIsTheExtraWay) {
  AttemptTrace trace = MakeAttempt(30);
  for (std::size_t h = 0; h < 2; ++h) {
    const double from = trace.hands[h][0].tip.x;
    for (ToolSample& sample : trace.hands[h]) {
      const double angle = M_PI * (sample.tip.x - from) / kReach;
      sample.tip.x = from + 0.5 * kReach * (1 - std::cos(angle));
      sample.tip.z += 0.5 * kReach * std::sin(angle);
    }
  }
  EXPECT_NEAR(Get(CalcCoachMeasures(trace), "detour").value, M_PI / 2 - 1, 0.02);
}

TEST(CoachMeasures, CorrectionsAreShortWaysBackAtOnce) {
  AttemptTrace trace = MakeAttempt(30);
  for (std::size_t h = 0; h < 2; ++h) {
    for (std::size_t i = 0; i < trace.Ticks(); ++i) {
      const double period = kReachSeconds + 0.5, time = static_cast<double>(i) * kDt;
      const auto legs = static_cast<int>(time / period);
      const double in_leg = time - legs * period, sense = legs % 2 == 0 ? 1 : -1;
      // past the end by 6 mm, and back in the rest
      trace.hands[h][i].tip.x +=
          sense * 0.006 * (Blend(in_leg / kReachSeconds) - Blend((in_leg - kReachSeconds) / 0.3));
    }
  }
  const CoachMeasure corrections = Get(CalcCoachMeasures(trace), "corrections");
  EXPECT_GT(corrections.value, 0.85);
  EXPECT_TRUE(corrections.moment.has_value());
}

TEST(CoachMeasures, EventsAreCountedByKindAndTheFirstIsShown) {
  AttemptTrace trace = MakeAttempt(10);
  trace.events = {{3, "dropped", 1}, {5, "dropped", 0}, {6, "grasp", 0}};
  trace.events[0].is_error = trace.events[1].is_error = true;
  const CoachMeasure dropped = CountEvents(trace, "dropped");
  EXPECT_EQ(dropped.value, 2);
  EXPECT_EQ(dropped.moment->time, 3);
  EXPECT_EQ(dropped.moment->hand, 1);
  EXPECT_EQ(CountEvents(trace, "grasp").value, 0) << "no error";
}

constexpr const char* kRules = R"({"format": "trocar-coach-rules", "version": 1, "most": 2, "rules": [
  {"id": "shakes", "topic": "tremor", "measure": "coach:tremor", "threshold_sd": 3, "sd_floor": 0.00002, "shown_scale": 1000,
   "decimals": 2, "sentence": "{hand} trembled by {value} mm, experts by {expert} mm.", "why": "w", "exercise": "peg_transfer",
   "practise": "p", "source": "s"},
  {"id": "fell", "topic": "grip", "measure": "event:dropped", "absolute": 1, "weight": 2, "decimals": 0, "sentence": "Fell {times}.",
   "sentence_alone": "Fell {times}.", "why": "w", "exercise": "peg_transfer", "practise": "p", "source": "s"},
  {"id": "fell_often", "topic": "grip", "measure": "event:dropped", "absolute": 1, "decimals": 0, "sentence": "Again.",
   "sentence_alone": "Again.", "why": "w", "exercise": "peg_transfer", "practise": "p", "source": "s"},
  {"id": "roams", "topic": "path", "measure": "metric:path_length/left", "threshold_sd": 2, "sentence": "{value} m.", "why": "w",
   "exercise": "peg_transfer", "practise": "p", "source": "s"}]})";

TaskValidity MakeReference() {
  return {
      "peg_transfer",
      "normal",
      {{"coach:tremor", "", true, 1, 0.00005, 0.00001, 50}, {"path_length", "left", true, 1, 2.0, 0.5, 50}}};
}

TEST(Coach, SaysWhatItsNumbersSayInTheOrderOfTheirCost) {
  const auto rules = ParseCoachRules(kRules, "test");
  ASSERT_TRUE(rules.ok()) << rules.error().Text();
  AttemptTrace trace = MakeAttempt(30);
  for (std::size_t i = 0; i < trace.Ticks(); ++i)
    trace.hands[1][i].tip.y += 0.001 * std::sin(2 * M_PI * 10 * static_cast<double>(i) * kDt);
  trace.events = {{3, "dropped", 1}};
  trace.events[0].is_error = true;
  const AttemptMetrics metrics{{{"path_length", "left", "", 4.0, ""}}};
  const TaskValidity reference = MakeReference();
  const auto advice = CoachAttempt(trace, metrics, *rules, &reference);
  ASSERT_EQ(advice.size(), 2u) << "two at most";
  EXPECT_EQ(advice[0].rule, "shakes");
  EXPECT_THAT(advice[0].sentence, HasSubstr("experts by 0.05 mm"));
  EXPECT_THAT(advice[0].sentence, HasSubstr("the right hand trembled"));
  EXPECT_THAT(advice[0].look, HasSubstr("the right hand"));
  // the numbers lead back to the sentence: the floor counts where experts hardly vary
  EXPECT_NEAR(advice[0].numbers.deviation, (advice[0].numbers.value - 0.00005) / 0.00002, 1e-9);
  EXPECT_EQ(advice[0].numbers.cost, advice[0].numbers.deviation);
  EXPECT_EQ(advice[1].rule, "roams") << "4 deviations cost more than a fall, which costs 2";
  EXPECT_NEAR(advice[1].numbers.deviation, 4, 1e-12);
}

TEST(Coach, SpeaksOnceOfATopicAndOnlyOfAbsolutesWithoutExperts) {
  const auto rules = ParseCoachRules(kRules, "test");
  ASSERT_TRUE(rules.ok());
  AttemptTrace trace = MakeAttempt(10);
  trace.events = {{3, "dropped", 1}, {4, "dropped", 1}};
  for (AttemptEvent& event : trace.events) event.is_error = true;
  const auto advice = CoachAttempt(trace, {}, *rules, nullptr);
  ASSERT_EQ(advice.size(), 1u);
  EXPECT_EQ(advice[0].rule, "fell");
  EXPECT_EQ(advice[0].sentence, "Fell twice.");
  EXPECT_EQ(advice[0].look, "Look at 0:03: the right hand.");
  EXPECT_FALSE(advice[0].numbers.expert_mean.has_value());
  EXPECT_TRUE(CoachAttempt(MakeAttempt(10), {}, *rules, nullptr).empty());
}

// The report's plot peaks at the greatest force; the coach judges by what is passed in a hundredth of the loaded time, and says both.
TEST(Coach, SaysThePeakOfThePlotBesideTheForceThatItJudgesBy) {
  const auto text = host::ReadFile(std::filesystem::path(TROCAR_SOURCE_DIR) / "assets" / kCoachRulesFile);
  ASSERT_TRUE(text.ok());
  const auto rules = ParseCoachRules(*text, kCoachRulesFile);
  ASSERT_TRUE(rules.ok()) << rules.error().Text();
  AttemptTrace trace = MakeAttempt(30);
  for (std::size_t i = 600; i < 1200; ++i) trace.hands[1][i].force = 14;
  trace.hands[1][900].force = 24;
  const auto metrics = CalcAttemptMetrics(trace);
  ASSERT_TRUE(metrics.ok());
  EXPECT_EQ(*metrics->Find("max_force", "right"), 24);
  const TaskValidity reference{"any", "normal", {{"coach:peak_force", "", true, 1, 0.5, 0.1, 50}}};
  const auto advice = CoachAttempt(trace, *metrics, *rules, &reference);
  const auto force =
      std::find_if(advice.begin(), advice.end(), [](const Advice& one) { return one.rule == "force"; });
  ASSERT_NE(force, advice.end());
  EXPECT_THAT(force->sentence, HasSubstr("more than 14.0 N"));
  EXPECT_THAT(force->sentence, HasSubstr("once with 24.0 N"));
  EXPECT_EQ(force->numbers.most, 24);
  EXPECT_NEAR(*force->time, 900 * kDt, 1e-9) << "the moment is that of the peak";
}

TEST(CoachRules, RefuseWhatTheyCannotSay) {
  const auto refuses = [](const std::string& from, const std::string& to) {
    std::string text = kRules;
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
    const auto rules = ParseCoachRules(text, "test");
    return !rules.ok() && rules.error().code == base::ErrorCode::kJsonField;
  };
  EXPECT_TRUE(refuses("coach:tremor", "coach:humour"));
  EXPECT_TRUE(refuses("{expert} mm.", "{surgeon} mm."));
  EXPECT_TRUE(refuses("\"sentence_alone\": \"Fell {times}.\"", "\"sentence_alone\": \"Fell {expert}.\""));
  EXPECT_TRUE(refuses("\"absolute\": 1, \"weight\": 2,", "\"weight\": 2,"));
  EXPECT_TRUE(refuses("\"fell_often\"", "\"fell\""));
  EXPECT_TRUE(refuses("\"threshold_sd\": 3", "\"treshold_sd\": 3"));
  EXPECT_TRUE(refuses("\"version\": 1", "\"version\": 2"));
  EXPECT_FALSE(ParseCoachRules("{", "test").ok());
}

/// The delivered rules and expert sets are read, and no sentence claims what nobody can claim.
TEST(CoachRules, DeliveredOnesAreWholeAndClaimNoCompetence) {
  const std::filesystem::path assets = std::filesystem::path(TROCAR_SOURCE_DIR) / "assets";
  const auto text = host::ReadFile(assets / kCoachRulesFile);
  ASSERT_TRUE(text.ok());
  const auto rules = ParseCoachRules(*text, kCoachRulesFile);
  ASSERT_TRUE(rules.ok()) << rules.error().Text();
  EXPECT_GE(rules->rules.size(), 20u);
  for (const CoachRule& rule : rules->rules) {
    EXPECT_TRUE(std::filesystem::exists(std::filesystem::path(TROCAR_SOURCE_DIR) / "scenes/tasks" /
                                        (rule.exercise + ".json")))
        << rule.id << ": " << rule.exercise;
    for (const std::string& words : {rule.sentence, rule.sentence_alone, rule.why, rule.practise}) {
      for (const char* claim : {"competen", "certif", "qualified", "ready to operate"})
        EXPECT_EQ(words.find(claim), std::string::npos) << rule.id << ": " << words;
    }
    EXPECT_FALSE(rule.source.empty()) << rule.id;
  }
  const auto sets = host::ReadFile(assets / kValidityFile);
  ASSERT_TRUE(sets.ok());
  const auto validity = ParseValidity(*sets, kValidityFile);
  ASSERT_TRUE(validity.ok()) << validity.error().Text();
  EXPECT_FALSE(validity->tasks.empty());
}

TEST(Validity, KnowsWhatSeparatesWhatDoesNotAndWhatNobodyStudied) {
  const auto validity = ParseValidity(
      R"({"format": "trocar-validity", "version": 1, "tasks": [{"task": "a", "level": "normal", "measures": [
        {"metric": "time", "separates": true, "auc": 1, "expert_mean": 20, "expert_sd": 2, "experts": 50},
        {"metric": "sparc", "hand": "left", "separates": false, "auc": 0.6, "expert_mean": -2, "expert_sd": 0.1, "experts": 50}]}]})",
      "test");
  ASSERT_TRUE(validity.ok()) << validity.error().Text();
  const TaskValidity* task = validity->FindTask("a");
  ASSERT_NE(task, nullptr);
  EXPECT_EQ(ValidityWords(task, "time", ""), "separates");
  EXPECT_EQ(ValidityWords(task, "sparc", "left"), "does not separate");
  EXPECT_EQ(ValidityWords(task, "sparc", "right"), "not studied");
  EXPECT_EQ(ValidityWords(validity->FindTask("b"), "time", ""), "not studied");
  const auto refused = ParseValidity(
      R"({"format": "trocar-validity", "version": 1, "tasks": [{"task": "a", "level": "n", "measures": [{"metric": "t", "auc": 2,
        "expert_mean": 1, "expert_sd": 1, "experts": 2}]}]})",
      "test");
  ASSERT_FALSE(refused.ok());
  EXPECT_THAT(refused.error().Text(), HasSubstr("tasks[0].measures[0].auc"));
}

TEST(Coach, MomentsAreMinutesAndSeconds) {
  EXPECT_EQ(FormatMoment(0), "0:00");
  EXPECT_EQ(FormatMoment(67.9), "1:07");
  EXPECT_EQ(FormatMoment(3605), "60:05");
}

}  // namespace
}  // namespace trocar::training
