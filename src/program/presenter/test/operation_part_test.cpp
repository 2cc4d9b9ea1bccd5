// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/operation_part.h"

#include <gtest/gtest.h>

#include <cmath>

#include "trocar/presenter/scene_choice.h"
#include "trocar/procedures/find_procedure.h"
#include "trocar/scene/scene.h"

namespace trocar::presenter {
namespace {

using assessment::Milestone;
using Reason = OperationEnd::Reason;

scene::Scene MakeScene(double limit, double part_limit) {
  scene::Scene scene;
  scene.operation.emplace();
  scene.operation->procedure = procedures::FindProcedure(procedures::kUsualProcedure);
  scene.operation->level.time_limit = limit;
  scene.operation->level.part_time_limit = part_limit;
  return scene;
}

simulation::Snapshot MakeMoment(double time, int entering = 3) {
  simulation::Snapshot now;
  now.time = time;
  now.operation.procedure.measures = {0, 0, static_cast<double>(entering)};
  return now;
}

TEST(OperationParts, AreTheStepsOfTheCourse) {
  const auto parts = ListOperationParts();
  ASSERT_TRUE(parts.ok()) << parts.error().Text();
  ASSERT_EQ(parts->size(), 3u);
  EXPECT_EQ(parts->at(0).key, "critical-view");
  EXPECT_EQ(parts->at(0).until, Milestone::kCriticalView);
  EXPECT_EQ(parts->at(1).key, "clip-and-cut");
  EXPECT_EQ(parts->at(1).from, Milestone::kCriticalView);
  EXPECT_EQ(parts->at(2).until, Milestone::kFree);
}

TEST(OperationParts, TheFirstBeginsAtOnceAtItsLevel) {
  Options options;
  options.task = kOperationTask;
  options.operation.part = "critical-view";
  options.level = "hard";
  const auto start = PreparePart(options, {});
  ASSERT_TRUE(start.ok()) << start.error().Text();
  EXPECT_TRUE(start->state.empty()) << "nobody operates before it";
  EXPECT_EQ(start->description.level, "hard");
  EXPECT_EQ(start->until, Milestone::kCriticalView);
  options.level = "normal";
  EXPECT_EQ(PreparePart(options, {})->description.level, "") << "as recordings before there were levels";
}

TEST(OperationParts, APatientThatIsNotThereAndAnUnknownPartAreSaid) {
  Options options;
  options.task = kOperationTask;
  options.operation.part = "appendix";
  EXPECT_EQ(PreparePart(options, {}).error().code, base::ErrorCode::kUnknownName);
  options.operation.part = "bed";
  options.operation.patient = "/nowhere/seed-7";
  EXPECT_EQ(PreparePart(options, {}).error().code, base::ErrorCode::kFileMissing);
  options = {};
  options.task = "peg_transfer";
  options.operation.part = "bed";
  EXPECT_EQ(MakeChosenScene(options, {}).error().code, base::ErrorCode::kUnknownName);
}

// The expert operates for minutes; whoever does not want to wait is not kept.
TEST(OperationParts, ThePreparationCanBeGivenUp) {
  Options options;
  options.task = kOperationTask;
  options.operation.part = "clip-and-cut";
  options.threads = 1;
  ::setenv("TROCAR_CACHE_HOME", "/nowhere", 1);
  int told = 0;
  double before = 0;
  const auto start = PreparePart(options, [&](const std::string& doing, double share) {
    EXPECT_NE(doing.find("expert"), std::string::npos);
    EXPECT_NE(doing.find(" %"), std::string::npos) << doing;
    EXPECT_GT(share, before);
    EXPECT_LT(share, 1);
    before = share;
    return ++told < 3;
  });
  ::unsetenv("TROCAR_CACHE_HOME");
  ASSERT_FALSE(start.ok());
  EXPECT_EQ(start.error().code, base::ErrorCode::kCancelled);
  EXPECT_EQ(told, 3);
}

TEST(OperationEnds, WithThePartsLastMilestone) {
  OperationEnd end;
  end.Begin(MakeScene(HUGE_VAL, HUGE_VAL), Milestone::kCriticalView, Milestone::kDivided, MakeMoment(100));
  EXPECT_EQ(end.See(MakeMoment(200, 1)), Reason::kNone);
  EXPECT_EQ(end.See(MakeMoment(300, 0)), Reason::kPartDone);
  EXPECT_EQ(end.See(MakeMoment(301, 0)), Reason::kPartDone) << "for as long as it holds";
  EXPECT_EQ(end.See(MakeMoment(100, 3)), Reason::kNone) << "begun anew";
  end.Begin(MakeScene(HUGE_VAL, HUGE_VAL), Milestone::kStart, Milestone::kCompleted, MakeMoment(0));
  EXPECT_EQ(end.See(MakeMoment(300, 0)), Reason::kNone) << "no critical view, and more to do";
  simulation::Snapshot last = MakeMoment(400, 0);
  last.operation.is_completed = true;
  EXPECT_EQ(end.See(last), Reason::kCompleted);
}

TEST(OperationEnds, WithTheTimeOfItsLevel) {
  OperationEnd end;
  end.Begin(MakeScene(2700, 900), Milestone::kCriticalView, Milestone::kDivided, MakeMoment(100));
  EXPECT_EQ(end.TimeLimit(), 900);
  EXPECT_EQ(end.See(MakeMoment(999)), Reason::kNone) << "counted from where the part began";
  EXPECT_EQ(end.See(MakeMoment(1000)), Reason::kTimeOver);
  end.Begin(MakeScene(2700, 900), Milestone::kStart, Milestone::kCompleted, MakeMoment(0));
  EXPECT_EQ(end.TimeLimit(), 2700);
}

}  // namespace
}  // namespace trocar::presenter
