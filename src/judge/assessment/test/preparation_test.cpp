// SPDX-License-Identifier: Apache-2.0
#include "trocar/assessment/preparation.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "trocar/agent/surgeon.h"
#include "trocar/assessment/play_state.h"
#include "trocar/assessment/preparation_forecast.h"
#include "trocar/base/state_archive.h"
#include "trocar/files/scene_file.h"
#include "trocar/files/state_file.h"
#include "trocar/host/safe_file.h"
#include "trocar/simulation/engine_bits.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::assessment {
namespace {

namespace fs = std::filesystem;
using base::ErrorCode;

TEST(PreparePatient, MakesAPatientOnceAndAnotherForOtherSettings) {
  test::TemporaryFolder folder;
  PatientChoice choice;
  EXPECT_TRUE(PreparePatient(choice, folder.Path())->empty()) << "the scene's own";
  choice.seed = 7;
  const auto first = PreparePatient(choice, folder.Path());
  ASSERT_TRUE(first.ok()) << first.error().Text();
  EXPECT_TRUE(fs::is_regular_file(*first / "patient.json"));
  const auto made_at = fs::last_write_time(*first / "patient.json");
  EXPECT_EQ(*PreparePatient(choice, folder.Path()), *first);
  EXPECT_EQ(fs::last_write_time(*first / "patient.json"), made_at);
  choice.settings = {{"moynihan_hump", "yes"}};
  EXPECT_NE(*PreparePatient(choice, folder.Path()), *first);
}

Step MakePart(Milestone from) {
  Step step;
  step.key = "part";
  step.operation = "cholecystectomy";
  step.from = from;
  return step;
}

/// States of an expert who has operated for some ticks, as if a part began there.
class PreparedStates : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(delivered_);
    settings_.cache = folder_.Path() / "cache";
    settings_.delivered = delivered_;
    settings_.progress = [this](const PreparationProgress& now) {
      told_.push_back(now);
      return false;  // the way is long
    };
  }
  /// \param bits  of the engine that the file names
  void Save(const fs::path& in, Milestone from, std::size_t ticks, int bits = simulation::kEngineBits) {
    auto operation = files::FindOperation("cholecystectomy", {}, settings_.surgeon_seed);
    ASSERT_TRUE(operation.ok() && operation->has_value());
    const auto scene = std::make_shared<const scene::Scene>(std::move(**operation));
    auto simulation = simulation::Simulation::Make(scene);
    auto surgeon = agent::MakeSurgeon("expert", scene, settings_.surgeon_seed);
    ASSERT_TRUE(simulation.ok() && surgeon.ok());
    for (std::size_t tick = 0; tick < ticks; ++tick)
      simulation->Step((*surgeon)->Act(simulation->GetSnapshot()));
    std::vector<std::byte> player;
    base::StateArchive archive = base::StateArchive::ForSave(player);
    std::string who = "expert, seed 1";
    archive.Field("who", who);
    archive.Field("engine_bits", bits);
    (*surgeon)->VisitState(archive);
    ASSERT_TRUE(files::WriteStateFile(in / PreparedFileName(*simulation, from, settings_.surgeon_seed),
                                      *simulation, player)
                    .ok());
    seconds_ = simulation->GetSnapshot().time;
  }

  test::TemporaryFolder folder_;
  fs::path delivered_ = folder_.Path() / "parts";
  PreparationSettings settings_;
  std::vector<PreparationProgress> told_;
  double seconds_ = 0;  // simulated time of what was saved last [s]
};

TEST_F(PreparedStates, ThatWereDeliveredAreUsedAndNothingIsComputed) {
  Save(delivered_, Milestone::kDivided, 12);
  const auto prepared = PrepareStep(MakePart(Milestone::kDivided), settings_);
  ASSERT_TRUE(prepared.ok()) << prepared.error().Text();
  EXPECT_TRUE(prepared->was_cached);
  EXPECT_TRUE(prepared->was_delivered);
  EXPECT_EQ(prepared->state.parent_path(), delivered_);
  EXPECT_EQ(prepared->seconds, seconds_);
  EXPECT_EQ(prepared->surgeon, "expert, seed 1");
  EXPECT_TRUE(told_.empty());
  EXPECT_FALSE(fs::exists(settings_.cache)) << "nothing is kept a second time";
}

TEST_F(PreparedStates, OfTheCacheAreUsedWhereNoneWasDelivered) {
  Save(settings_.cache / "starts", Milestone::kDivided, 12);
  const auto prepared = PrepareStep(MakePart(Milestone::kDivided), settings_);
  ASSERT_TRUE(prepared.ok()) << prepared.error().Text();
  EXPECT_TRUE(prepared->was_cached);
  EXPECT_FALSE(prepared->was_delivered);
  EXPECT_TRUE(told_.empty());
}

// Whoever updates the program and not its data is not led to a moment of another engine.
TEST_F(PreparedStates, OfAnotherEngineAreRefusedAndComputed) {
  Save(delivered_, Milestone::kDivided, 12, simulation::kEngineBits + 1);
  const auto prepared = PrepareStep(MakePart(Milestone::kDivided), settings_);
  ASSERT_FALSE(prepared.ok());
  EXPECT_EQ(prepared.error().code, ErrorCode::kCancelled);
  ASSERT_EQ(told_.size(), 1u) << "the expert operates";
  EXPECT_GT(told_[0].seconds, seconds_) << "from the first tick on";
  EXPECT_LT(told_[0].seconds, 1);
}

TEST_F(PreparedStates, ThatAreDamagedAreComputed) {
  Save(delivered_, Milestone::kDivided, 12);
  for (const auto& file : fs::directory_iterator(delivered_)) {
    auto content = host::ReadFile(file.path());
    ASSERT_TRUE(content.ok());
    content->at(content->size() / 2) = static_cast<char>(content->at(content->size() / 2) ^ 1);
    ASSERT_TRUE(host::WriteFile(file.path(), *content).ok());
  }
  EXPECT_EQ(PrepareStep(MakePart(Milestone::kDivided), settings_).error().code, ErrorCode::kCancelled);
  EXPECT_EQ(told_.size(), 1u);
}

TEST_F(PreparedStates, OfAnotherPatientOrLevelAreNotUsed) {
  Save(delivered_, Milestone::kDivided, 12);
  Step hard = MakePart(Milestone::kDivided);
  hard.level = "hard";
  EXPECT_EQ(PrepareStep(hard, settings_).error().code, ErrorCode::kCancelled);
  EXPECT_EQ(told_.size(), 1u);
}

// The bed comes after clip and cut: the expert goes on from there.
TEST_F(PreparedStates, OfAnEarlierMomentAreWhereTheExpertGoesOn) {
  Save(delivered_, Milestone::kCriticalView, 90);
  EXPECT_EQ(PrepareStep(MakePart(Milestone::kDivided), settings_).error().code, ErrorCode::kCancelled);
  ASSERT_EQ(told_.size(), 1u);
  EXPECT_GT(told_[0].seconds, seconds_);
  EXPECT_LT(told_[0].share, 0.1) << "counted from there";
}

TEST_F(PreparedStates, OfATaskAreNotNeeded) {
  Step task;
  task.task = "peg_transfer", task.level = "normal";
  const auto prepared = PrepareStep(task, settings_);
  ASSERT_TRUE(prepared.ok());
  EXPECT_TRUE(prepared->patient.empty());
  EXPECT_TRUE(prepared->state.empty());
}

TEST_F(PreparedStates, AreNotKeptWhenTheWayIsGivenUp) {
  const auto prepared = PrepareStep(MakePart(Milestone::kDivided), settings_);
  ASSERT_FALSE(prepared.ok());
  EXPECT_EQ(prepared.error().code, ErrorCode::kCancelled);
  EXPECT_FALSE(fs::exists(settings_.cache / "starts"));
}

TEST(ListPreparedSteps, AreThePartsThatBeginLaterAtEachLevel) {
  const auto course = FindCourse("cholecystectomy");
  ASSERT_TRUE(course.ok());
  const auto steps = ListPreparedSteps(*course);
  ASSERT_TRUE(steps.ok()) << steps.error().Text();
  std::string text;
  for (const Step& step : *steps) text += step.level + " " + std::string(NameOf(step.from)) + "; ";
  EXPECT_EQ(text,
            "easy critical_view; easy divided; normal critical_view; normal divided; hard critical_view; "
            "hard divided; ");
  const auto basic = FindCourse("basic-skills");
  ASSERT_TRUE(basic.ok());
  EXPECT_TRUE(ListPreparedSteps(*basic)->empty());
  // of two that begin alike one is enough
  Course twice = *course;
  twice.steps.push_back(twice.steps[1]);
  EXPECT_EQ(ListPreparedSteps(twice)->size(), steps->size());
}

// --- the forecast, without a clock

TEST(PreparationForecast, SaysPercentAndTimeOfASteadyExpert) {
  const double end = TypicalTime(Milestone::kCriticalView);
  PreparationForecast forecast(Milestone::kStart, Milestone::kCriticalView, 0, 100);
  forecast.See(Milestone::kStart, 0.01 * end, 101);
  EXPECT_FALSE(forecast.SecondsLeft()) << "a second tells no pace";
  forecast.See(Milestone::kStart, 0.25 * end, 120);
  EXPECT_NEAR(forecast.Share(), 0.25, 1e-12);
  ASSERT_TRUE(forecast.SecondsLeft());
  EXPECT_NEAR(*forecast.SecondsLeft(), 60, 1e-9) << "a quarter took 20 s";
  EXPECT_FALSE(forecast.IsLate());
}

TEST(PreparationForecast, NeverGoesBackAndReachesTheWholeOnlyAtTheTarget) {
  // the expert is quicker than foreseen, slower, and much slower
  for (const double pace : {0.5, 1.0, 3.0, 20.0}) {
    PreparationForecast forecast(Milestone::kStart, Milestone::kDivided, 0, 0);
    const double view = pace * TypicalTime(Milestone::kCriticalView);
    const double end = pace * TypicalTime(Milestone::kDivided);
    double before = 0;
    for (double seconds = 0; seconds < end; seconds += end / 500) {
      forecast.See(seconds < view ? Milestone::kStart : Milestone::kCriticalView, seconds, 2 * seconds);
      EXPECT_GE(forecast.Share(), before) << "at " << seconds << " s, pace " << pace;
      EXPECT_LT(forecast.Share(), 1) << "at " << seconds << " s, pace " << pace;
      if (forecast.SecondsLeft()) EXPECT_GT(*forecast.SecondsLeft(), 0);
      before = forecast.Share();
    }
    forecast.See(Milestone::kDivided, end, 2 * end);
    EXPECT_EQ(forecast.Share(), 1);
    EXPECT_EQ(forecast.SecondsLeft(), 0);
  }
}

TEST(PreparationForecast, OfWhoeverIsLateTellsNoTime) {
  PreparationForecast forecast(Milestone::kStart, Milestone::kCriticalView, 0, 0);
  forecast.See(Milestone::kStart, 1.1 * TypicalTime(Milestone::kCriticalView), 60);
  EXPECT_TRUE(forecast.IsLate());
  EXPECT_FALSE(forecast.SecondsLeft());
  EXPECT_LT(forecast.Share(), 1);
  // with the critical view the way that is left is known again
  PreparationForecast further(Milestone::kStart, Milestone::kDivided, 0, 0);
  const double view = 2 * TypicalTime(Milestone::kCriticalView);
  further.See(Milestone::kCriticalView, view, view);
  ASSERT_TRUE(further.SecondsLeft());
  EXPECT_NEAR(*further.SecondsLeft(),
              TypicalTime(Milestone::kDivided) - TypicalTime(Milestone::kCriticalView), 1e-9);
}

TEST(PreparationForecast, CountsFromWhereTheExpertGoesOn) {
  const double view = TypicalTime(Milestone::kCriticalView), end = TypicalTime(Milestone::kDivided);
  PreparationForecast forecast(Milestone::kCriticalView, Milestone::kDivided, 500, 0);
  forecast.See(Milestone::kCriticalView, 500 + 0.5 * (end - view), 30);
  EXPECT_NEAR(forecast.Share(), 0.5, 1e-12);
  EXPECT_NEAR(*forecast.SecondsLeft(), 30, 1e-9);
}

}  // namespace
}  // namespace trocar::assessment
