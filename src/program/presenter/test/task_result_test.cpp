// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/task_result.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace trocar::presenter {
namespace {

scene::Scene MakeScene() {
  scene::Scene scene;
  scene.seed = 7;
  scene.objects.resize(1);
  scene.objects[0].name = "ring";
  scene::Task task;
  task.name = "Rings <on> pegs";
  task.level = "hard";
  task.goals.resize(2);
  task.goals[0].name = "Ring 1";
  task.goals[1].name = "Ring 2";
  task.errors.resize(1);
  task.errors[0].name = "dropped";
  task.errors[0].about = "A ring \"fell\" & rolled";
  task.errors[0].severity = surgery::Severity::kMajor;
  task.errors[0].penalty = 12.5;
  task.reference_points = 200;
  task.best_score = 85;
  scene.task = task;
  return scene;
}

scene::TaskSnapshot MakeEnd() {
  scene::TaskSnapshot now;
  now.phase = scene::TaskPhase::kTimeOver;
  now.time = 83.26;
  now.score = 41.24;
  now.goals.resize(2);
  now.goals[0].is_done = true;
  return now;
}

TEST(TaskErrorLog, KeepsEveryErrorOnceAndForgetsThoseOfTheRunBefore) {
  TaskErrorLog log;
  scene::TaskSnapshot now;
  const auto happen = [&](double time) {
    now.last_errors[now.error_count % now.last_errors.size()] = {0, time, {}, -1, -1};
    ++now.error_count;
  };
  for (int i = 0; i < 20; ++i) {
    happen(i);
    log.Add(now);
    log.Add(now);
  }
  ASSERT_EQ(log.Errors().size(), 20u) << "more than the snapshot's ring holds";
  for (int i = 0; i < 20; ++i) EXPECT_EQ(log.Errors()[static_cast<std::size_t>(i)].time, i);
  // more at once than the ring holds: the newest
  for (int i = 20; i < 45; ++i) happen(i);
  log.Add(now);
  EXPECT_EQ(log.Errors().back().time, 44);
  EXPECT_EQ(log.Errors().size(), 36u);
  now = {};
  log.Add(now);
  EXPECT_TRUE(log.Errors().empty());
  happen(1);
  log.Add(now);
  EXPECT_EQ(log.Errors().size(), 1u);
}

TEST(TaskResult, SaysGoalsErrorsTimeAndScore) {
  const auto result =
      MakeTaskResult(MakeScene(), MakeEnd(), {{0, 12.34, {0.01, 0, -0.1}, 0, instrument::kRight}});
  EXPECT_EQ(result.verdict, "The time is over");
  EXPECT_EQ(FormatScore(result), "35.1 of 85");
  ASSERT_EQ(result.goals.size(), 2u);
  EXPECT_TRUE(result.goals[0].is_done);
  EXPECT_FALSE(result.goals[1].is_done);
  ASSERT_EQ(result.errors.size(), 1u);
  EXPECT_EQ(result.errors[0].by, "ring, right hand");
  EXPECT_EQ(result.errors[0].severity, "major");
}

TEST(TaskResult, IsWrittenAsJson) {
  const auto result =
      MakeTaskResult(MakeScene(), MakeEnd(), {{0, 12.34, {0.01, 0, -0.1}, -1, instrument::kLeft}});
  const auto json = nlohmann::json::parse(FormatTaskResultJson(result));
  EXPECT_EQ(json.at("format"), "trocar-task-result");
  EXPECT_EQ(json.at("task"), "Rings <on> pegs");
  EXPECT_EQ(json.at("level"), "hard");
  EXPECT_EQ(json.at("seed"), 7);
  EXPECT_EQ(json.at("demonstration"), false);
  EXPECT_EQ(json.at("phase"), "time_over");
  EXPECT_EQ(json.at("score_unit"), "of_best_score");
  EXPECT_EQ(json.at("goals").at(1).at("done"), false);
  EXPECT_EQ(json.at("errors").at(0).at("error"), "dropped");
  EXPECT_NEAR(json.at("errors").at(0).at("at_mm").at(2).get<double>(), -100, 1e-9);
  EXPECT_EQ(json.at("errors").at(0).at("by"), "left hand");
}

TEST(TaskResult, IsWrittenAsAPageWithNothingUnescaped) {
  const auto html = FormatTaskResultHtml(MakeTaskResult(MakeScene(), MakeEnd(), {{0, 12.34, {}, -1, -1}}));
  EXPECT_NE(html.find("Rings &lt;on&gt; pegs"), std::string::npos);
  EXPECT_EQ(html.find("<on>"), std::string::npos);
  EXPECT_NE(html.find("A ring &quot;fell&quot; &amp; rolled"), std::string::npos);
  EXPECT_NE(html.find("1:23.3"), std::string::npos);
  EXPECT_NE(html.find("0:12.3"), std::string::npos);
  EXPECT_NE(html.find("-12.5"), std::string::npos);
  EXPECT_NE(html.find("not certified"), std::string::npos);
  const auto clean = FormatTaskResultHtml(MakeTaskResult(MakeScene(), MakeEnd(), {}));
  EXPECT_NE(clean.find("None."), std::string::npos);
}

}  // namespace
}  // namespace trocar::presenter
