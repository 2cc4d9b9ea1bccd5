// SPDX-License-Identifier: Apache-2.0
// The table of goals over a made-up patient: what is planned while a goal is not reached, and what where it cannot be.
#include "cholecystectomy_goals.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <deque>
#include <string>
#include <vector>

#include "careless_cholecystectomy.h"
#include "made_up_patient.h"

#include "trocar/cholecystectomy/cholecystectomy.h"

namespace trocar::agent {

using instrument::kLeft;
using instrument::kRight;

namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using Kind = SurgeonAct::Kind;

class Goals : public testing::Test, protected MadeUpPatient {
 protected:
  /// What is planned when an act is reached.
  std::vector<Kind> Plan(const SurgeonAct& act) {
    plan.acts.clear();
    const SurgeonView view = View();
    Planning on{view, memory, plan};
    PlanOn(on, act);
    return Kinds();
  }
  std::vector<Kind> Kinds() const {
    std::vector<Kind> kinds;
    for (const SurgeonAct& act : plan.acts) kinds.push_back(act.kind);
    return kinds;
  }
  static SurgeonAct Goal(Kind kind, int rounds) {
    SurgeonAct act;
    act.kind = kind;
    act.count = rounds;
    return act;
  }
};

TEST_F(Goals, StandInTheOrderOfTheOperation) {
  WritePlan(CholecystectomyGoals(), known, plan);
  std::vector<Kind> goals;
  for (const SurgeonAct& act : plan.acts)
    if (act.IsDecision() && act.kind != Kind::kTake) goals.push_back(act.kind);
  EXPECT_THAT(goals, ElementsAre(Kind::kChooseHold, Kind::kClearTriangle, Kind::kFreeLowerThird,
                                 Kind::kShowCriticalView, Kind::kTimeOut, Kind::kDivide, Kind::kStopBleeding,
                                 Kind::kCheckStumps, Kind::kFreeFromBed));
  EXPECT_EQ(plan.acts.front().command, scene::AssistantCommand::kRetract);
  EXPECT_EQ(plan.acts.back().kind, Kind::kTakeOut);
}

// What the plan means is the truth that recognised phases are judged by.
TEST_F(Goals, EachPlansItsOwnPhase) {
  WritePlan(CholecystectomyGoals(), known, plan);
  std::deque<SurgeonAct> acts(plan.acts.begin(), plan.acts.end());
  std::vector<std::string> phases;
  for (; !acts.empty(); acts.pop_front()) {
    const auto phase = FindPlannedPhase(acts, scene.instruments);
    ASSERT_TRUE(phase);
    if (phases.empty() || phases.back() != NameOf(*phase)) phases.emplace_back(NameOf(*phase));
  }
  EXPECT_THAT(phases, ElementsAre("Preparation", "CalotTriangleDissection", "ClippingCutting",
                                  "GallbladderDissection", "GallbladderPackaging", "GallbladderRetraction"));
  // acts of a round stand before their goal, which comes again
  acts = {Goal(Kind::kSpread, 0), Goal(Kind::kClearTriangle, 3)};
  EXPECT_EQ(FindPlannedPhase(acts, scene.instruments), cholecystectomy::Phase::kCalotTriangleDissection);
  acts = {Goal(Kind::kCheckClip, 0), Goal(Kind::kShowCriticalView, 3)};
  EXPECT_EQ(FindPlannedPhase(acts, scene.instruments), cholecystectomy::Phase::kClippingCutting)
      << "an extra artery";
}

TEST_F(Goals, WhoLeavesStonesOpensTheGallbladderBeforeItIsBroughtOut) {
  WritePlan(CholecystectomyGoals(), known, plan);
  const std::vector<Kind> usual = Kinds();
  plan.acts.clear();
  WriteErrorPlan(OperationErrorScenario::kLeavesStones, known, {}, plan);
  EXPECT_EQ(plan.acts.size(), usual.size() + 4) << "reach, burn and wait, and a wait at the end";
  std::size_t burn = 0, bed = 0;
  for (std::size_t i = 0; i < plan.acts.size(); ++i) {
    if (plan.acts[i].kind == Kind::kBurn) burn = i;
    if (plan.acts[i].kind == Kind::kFreeFromBed) bed = i;
  }
  EXPECT_GT(burn, bed);
}

TEST_F(Goals, EveryScenarioHasAPlanOfItsOwn) {
  for (int scenario = 1; scenario <= static_cast<int>(OperationErrorScenario::kRinses); ++scenario) {
    plan.acts.clear();
    WriteErrorPlan(static_cast<OperationErrorScenario>(scenario), known, {}, plan);
    EXPECT_GE(plan.acts.size(), 3u) << scenario;
  }
}

TEST_F(Goals, TheTriangleIsSpreadThenHookedUntilItIsClear) {
  EXPECT_THAT(Plan(Goal(Kind::kClearTriangle, 4)),
              ElementsAre(Kind::kTake, Kind::kSpread, Kind::kCheckTriangle));
  EXPECT_EQ(memory.spreading.strands.size(), known.window_strands.size());
  SurgeonAct check = plan.acts.back();
  EXPECT_THAT(Plan(check), ElementsAre(Kind::kTake, Kind::kDissect, Kind::kClearTriangle));
  EXPECT_EQ(plan.acts.back().count, 3);
  EXPECT_EQ(memory.dissection.goal.what, "the hepatocystic triangle");
  PartTriangle();
  EXPECT_THAT(Plan(Goal(Kind::kClearTriangle, 4)), IsEmpty());
  EXPECT_THAT(Plan(check), ElementsAre(Kind::kClearTriangle)) << "nothing is left for the hook";
}

TEST_F(Goals, WithoutRoundsTheNeckIsTurnedAsFarAsWaysAreLeft) {
  for (int way = 0; way < WaysLeft::kTriangleWays; ++way) {
    const auto kinds = Plan(Goal(Kind::kClearTriangle, 0));
    ASSERT_GE(kinds.size(), 2u);
    EXPECT_EQ(kinds.front() == Kind::kChooseHold, way >= 2) << "the last two by another hold";
    const SurgeonAct& turn = plan.acts[plan.acts.size() - 2];
    EXPECT_EQ(turn.kind, Kind::kTurnNeck);
    EXPECT_EQ(turn.side, way % 2 == 0 ? 1 : -1);
  }
  memory.ways.sharp = 0;
  EXPECT_THAT(Plan(Goal(Kind::kClearTriangle, 0)), IsEmpty());
}

TEST_F(Goals, AFreeGallbladderIsSwungOffTheHooksWay) {
  SurgeonAct check = Goal(Kind::kCheckTriangle, 2);
  check.strands = known.window_strands;
  PartBed(kNodes);
  EXPECT_THAT(Plan(check), ElementsAre(Kind::kAssist, Kind::kChooseHold, Kind::kTake, Kind::kDissect,
                                       Kind::kClearTriangle));
  EXPECT_GT(memory.dissection.goal.traction, 0.0);
}

TEST_F(Goals, TheLowerThirdIsFreedFromTheInfundibulumOnThenFromTheFundus) {
  EXPECT_THAT(Plan(Goal(Kind::kFreeLowerThird, 4)),
              ElementsAre(Kind::kTake, Kind::kChooseHold, Kind::kDraw, Kind::kWait, Kind::kDissect,
                          Kind::kFreeLowerThird));
  EXPECT_EQ(plan.acts.back().count, 3);
  EXPECT_EQ(plan.acts[1].may.kind, HoldFilter::Kind::kNeck);
  EXPECT_THAT(Plan(Goal(Kind::kFreeLowerThird, 0)),
              ElementsAre(Kind::kAssist, Kind::kFundusFirst, Kind::kAssist));
  EXPECT_THAT(Plan(Goal(Kind::kFreeLowerThird, 0)), IsEmpty()) << "once";
  seen.operation.procedure.view.criteria[cholecystectomy::kPlate] = 2;
  EXPECT_THAT(Plan(Goal(Kind::kFreeLowerThird, 4)), IsEmpty());
}

TEST_F(Goals, FundusFirstEndsWhereARoundPartedNothing) {
  ASSERT_FALSE(Plan(Goal(Kind::kFundusFirst, 12)).empty());
  const SurgeonAct again = plan.acts.back();
  EXPECT_EQ(again.kind, Kind::kFundusFirst);
  EXPECT_EQ(again.count, 11);
  EXPECT_THAT(Plan(again), IsEmpty());
  seen.operation.strand_is_intact[8] = 0;
  EXPECT_FALSE(Plan(again).empty());
}

TEST_F(Goals, TheBedIsFoldedBackRoundByRoundOrTheOperationEnds) {
  PartBed(4);
  EXPECT_THAT(Plan(Goal(Kind::kFreeFromBed, 12)),
              ElementsAre(Kind::kTake, Kind::kLook, Kind::kChooseHold, Kind::kDraw, Kind::kWait,
                          Kind::kDissect, Kind::kFreeFromBed));
  EXPECT_EQ(plan.acts[2].may.kind, HoldFilter::Kind::kFree);
  EXPECT_NEAR(plan.acts[2].may.peels, 0.040, 1e-12) << "where the first fibre is left";
  EXPECT_FALSE(memory.stops);
  EXPECT_THAT(Plan(Goal(Kind::kFreeFromBed, 0)), IsEmpty());
  EXPECT_TRUE(memory.stops);
  EXPECT_THAT(memory.bail_out, HasSubstr("bed"));
  memory.stops = false;
  PartBed(kNodes);
  EXPECT_THAT(Plan(Goal(Kind::kFreeFromBed, 0)), IsEmpty());
  EXPECT_FALSE(memory.stops);
}

TEST_F(Goals, WithoutTheViewTheTimeOutEndsTheOperationAndSaysWhatIsMissing) {
  seen.operation.procedure.measures = {0.62, 0.11, 3};
  memory.controls[kRight].coagulate = true;
  EXPECT_THAT(Plan(Goal(Kind::kTimeOut, 0)), IsEmpty());
  EXPECT_TRUE(memory.stops);
  EXPECT_FALSE(memory.controls[kRight].coagulate);
  EXPECT_THAT(memory.bail_out,
              testing::AllOf(HasSubstr("62 %"), HasSubstr("11 %"), HasSubstr("3 structures")));
  memory.stops = false;
  memory.has_view = true;
  EXPECT_THAT(Plan(Goal(Kind::kTimeOut, 0)), IsEmpty());
  EXPECT_FALSE(memory.stops);
}

TEST_F(Goals, TheViewIsLookedForFromBothSidesAfterWhatIsMissing) {
  EXPECT_THAT(Plan(Goal(Kind::kShowCriticalView, kViewRounds)),
              ElementsAre(Kind::kClearTriangle, Kind::kFreeLowerThird, Kind::kDivideExtraArtery, Kind::kReach,
                          Kind::kFollowWithCamera, Kind::kLookFromSide, Kind::kLookFromSide, Kind::kLook,
                          Kind::kFollowWithCamera, Kind::kShowCriticalView));
  EXPECT_EQ(plan.acts[5].side, -plan.acts[6].side);
  EXPECT_FALSE(plan.acts[0].is_on);
  (void)Plan(Goal(Kind::kShowCriticalView, kViewRounds - 1));
  EXPECT_TRUE(plan.acts[0].is_on) << "the second look is harder on the last fibres";
  seen.operation.procedure.view = {{2, 2, 2}, {1, 1}};
  EXPECT_THAT(Plan(Goal(Kind::kShowCriticalView, kViewRounds)), IsEmpty());
}

TEST_F(Goals, EachTubeThatEntersIsClippedThenCut) {
  SurgeonAct divide = Goal(Kind::kDivide, kDivisionRounds);
  divide.tubes = known.entering;
  EXPECT_THAT(Plan(divide), ElementsAre(Kind::kGoOnDividing, Kind::kDivide));
  EXPECT_EQ(memory.division.tubes, known.entering);
  (void)Plan(Goal(Kind::kGoOnDividing, 0));
  ASSERT_FALSE(plan.acts.empty());
  EXPECT_EQ(plan.acts.front().tool_kind, instrument::ToolKind::kClipApplier);
  for (const double x : {-0.010, -0.018, -0.024}) AddClip({x, 0, 0.004}), AddClip({x, 0.010, 0.004});
  (void)Plan(Goal(Kind::kGoOnDividing, 0));
  ASSERT_FALSE(plan.acts.empty());
  EXPECT_EQ(plan.acts.front().tool_kind, instrument::ToolKind::kScissors);
  DivideTube(0);
  DivideTube(1);
  EXPECT_THAT(Plan(divide), IsEmpty());
}

TEST_F(Goals, ASecondRoundOfClipsHoldsTheGallbladderOtherwise) {
  SurgeonAct divide = Goal(Kind::kDivide, kDivisionRounds - 1);
  divide.tubes = known.entering;
  EXPECT_EQ(Plan(divide).front(), Kind::kChooseHold);
  EXPECT_LT(memory.division.care, 1.0);
}

TEST_F(Goals, AStumpThatIsMissingEndsTheOperation) {
  DivideTube(0);
  (void)Plan(Goal(Kind::kCheckStumps, 0));
  EXPECT_TRUE(memory.stops);
  memory.stops = false;
  DivideTube(1);
  (void)Plan(Goal(Kind::kCheckStumps, 0));
  EXPECT_FALSE(memory.stops);
}

TEST_F(Goals, ALeakIsCoagulatedUnlessADuctThatMustStayIsNear) {
  EXPECT_THAT(Plan(Goal(Kind::kStopBleeding, 4)), IsEmpty());
  seen.operation.flow.leak_count = 1;
  seen.operation.flow.leaks[0].fluid = surgery::Fluid::kBlood;
  seen.operation.flow.leaks[0].position = {0, 0, 0.004};
  EXPECT_THAT(Plan(Goal(Kind::kStopBleeding, 4)),
              ElementsAre(Kind::kTake, Kind::kCoagulate, Kind::kStopBleeding));
  EXPECT_THAT(Plan(Goal(Kind::kStopBleeding, 0)), IsEmpty());
  seen.operation.flow.leaks[0].position = known.rest[known.main_nodes[4]];
  EXPECT_THAT(Plan(Goal(Kind::kStopBleeding, 4)), IsEmpty());
}

TEST_F(Goals, AMissedHoldIsTriedElsewhereAndAGoodOneKept) {
  SurgeonAct check = Goal(Kind::kCheckHold, 3);
  check.node = 4;
  seen.instruments[kLeft].is_grasping = true;
  seen.instruments[kLeft].organ = known.gallbladder;
  EXPECT_THAT(Plan(check), IsEmpty());
  seen.instruments[kLeft].organ = known.liver;
  EXPECT_EQ(Plan(check).back(), Kind::kChooseHold);
  EXPECT_EQ(plan.acts.back().count, 2);
  EXPECT_THAT(memory.missed_holds, ElementsAre(4u));
  EXPECT_THAT(Plan(Goal(Kind::kChooseHold, 0)), IsEmpty()) << "no try is left";
}

TEST_F(Goals, AToolIsExchangedOnlyForAnother) {
  SurgeonAct take = Goal(Kind::kTake, 0);
  take.tool_kind = instrument::ToolKind::kScissors;
  EXPECT_THAT(Plan(take), ElementsAre(Kind::kReach, Kind::kExchange, Kind::kJaw));
  EXPECT_EQ(plan.acts[1].tool, 3);
  seen.operation.tools[kRight] = 3;
  EXPECT_THAT(Plan(take), IsEmpty());
}

}  // namespace
}  // namespace trocar::agent
