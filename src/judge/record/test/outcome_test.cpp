// SPDX-License-Identifier: Apache-2.0
#include "trocar/record/outcome.h"

#include <gtest/gtest.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "trocar/files/find_scene.h"
#include "trocar/files/task_file.h"
#include "trocar/simulation/attempt_end.h"

namespace trocar::record {
namespace {

using nlohmann::json;
using scene::TaskPhase;

/// As a simulation of it says before anything was done.
json FirstOutcome(const std::string& name) {
  auto scene = files::FindScene(name);
  EXPECT_TRUE(scene.ok()) << (scene.ok() ? "" : scene.error().Text());
  if (!scene.ok()) return {};
  auto simulation = simulation::Simulation::Make(std::make_shared<const scene::Scene>(std::move(*scene)));
  EXPECT_TRUE(simulation.ok());
  return simulation.ok() ? json::parse(CalcOutcome(*simulation)) : json();
}

TEST(Outcome, OfEachDeliveredTaskIsReadByItsOwnGoals) {
  const auto tasks = files::ListTasks();
  ASSERT_TRUE(tasks.ok());
  ASSERT_GE(tasks->size(), 10u);
  int with_an_operation = 0;
  for (const files::TaskEntry& task : *tasks) {
    SCOPED_TRACE(task.key);
    json outcome = FirstOutcome(task.key);
    ASSERT_TRUE(outcome.contains("task"));
    with_an_operation += outcome.contains("operation") ? 1 : 0;
    for (const TaskPhase phase : {TaskPhase::kReady, TaskPhase::kRunning, TaskPhase::kCompleted,
                                  TaskPhase::kTimeOver, TaskPhase::kEnded}) {
      outcome["task"]["phase"] = scene::PhaseName(phase);
      const auto read = ReadOutcome(outcome.dump());
      ASSERT_TRUE(read);
      EXPECT_EQ(read->is_completed, phase == TaskPhase::kCompleted) << scene::PhaseName(phase);
      // as what follows the simulation itself decides
      EXPECT_EQ(read->is_completed, simulation::HasCompleted(phase, false));
      EXPECT_TRUE(read->score);
    }
  }
  EXPECT_GT(with_an_operation, 0) << "no task has an organ to operate on: this tests nothing";
}

TEST(Outcome, OfAnOperationIsReadByItsEnd) {
  json outcome = FirstOutcome("cholecystectomy");
  ASSERT_TRUE(outcome.contains("operation"));
  ASSERT_FALSE(outcome.contains("task"));
  for (const bool is_completed : {false, true}) {
    outcome["operation"]["completed"] = is_completed;
    const auto read = ReadOutcome(outcome.dump());
    ASSERT_TRUE(read);
    EXPECT_EQ(read->is_completed, is_completed);
    EXPECT_EQ(read->is_completed, simulation::HasCompleted(TaskPhase::kNone, is_completed));
    EXPECT_FALSE(read->score);
  }
}

TEST(Outcome, OfAnythingElseIsNone) {
  for (const char* text : {"", "[]", "1", "{", "null"}) EXPECT_FALSE(ReadOutcome(text)) << text;
  for (const char* text : {R"({})", R"({"task":1})", R"({"operation":{"completed":"true"}})",
                           R"({"task":{"phase":7,"score":"9"},"operation":{"completed":true}})"}) {
    const auto read = ReadOutcome(text);
    ASSERT_TRUE(read) << text;
    EXPECT_FALSE(read->is_completed) << text;
    EXPECT_FALSE(read->score) << text;
  }
}

TEST(Outcome, KeepsTheStepOfACourse) {
  const CourseStep step{"basic-skills", "instruments"};
  const std::string with = WithCourseStep(R"({"seconds":2.5,"task":{"phase":"completed"}})", step);
  EXPECT_EQ(
      with,
      R"({"seconds":2.5,"task":{"phase":"completed"},"course":{"course":"basic-skills","step":"instruments"}})");
  EXPECT_EQ(FindCourseStep(with), step);
  EXPECT_EQ(FindCourseStep(WithCourseStep("no JSON", step)), step);
  for (const char* text : {"", "[]", "{}", R"({"course": 3})", R"({"course": {"course": 3, "step": []}})"})
    EXPECT_EQ(FindCourseStep(text), CourseStep()) << text;
}

}  // namespace
}  // namespace trocar::record
