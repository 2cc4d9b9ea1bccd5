// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/read_outs.h"

#include <gtest/gtest.h>

#include <cmath>

#include "trocar/procedures/find_procedure.h"

namespace trocar::presenter {
namespace {

scene::Scene TwoOrgans() {
  scene::Scene scene;
  scene.patient.organs.resize(2);
  scene.patient.organs[0].name = "liver";
  scene.patient.organs[1].name = "gallbladder";
  return scene;
}

TEST(ReadOuts, NumbersCarryUnits) {
  EXPECT_EQ(FormatForce(2.14), "2.1 N");
  EXPECT_EQ(FormatForce(NAN), "— N");
  EXPECT_EQ(FormatMilliseconds(0.004213), "4.21 ms");
  EXPECT_EQ(FormatTime(67.26), "1:07.3");
  EXPECT_EQ(FormatTime(59.96), "1:00.0") << "rounds over the minute";
  EXPECT_EQ(FormatTime(-1), "—");
  EXPECT_EQ(FormatCount(0), "0");
  EXPECT_EQ(FormatCount(999), "999");
  EXPECT_EQ(FormatCount(1234567), "1,234,567");
  EXPECT_EQ(FormatResidual(3.21e-5), "3.2e-05");
}

TEST(ReadOuts, ForceIsJudgedByTheOrgan) {
  const ForceThresholds liver = FindForceThresholds(roles::OrganRole::kLiver),
                        gallbladder = FindForceThresholds(roles::OrganRole::kGallbladder);
  EXPECT_EQ(JudgeForce(2.9, liver), ForceLevel::kCalm);
  EXPECT_EQ(JudgeForce(3.0, liver), ForceLevel::kWarning);
  EXPECT_EQ(JudgeForce(6.0, liver), ForceLevel::kDanger);
  EXPECT_EQ(JudgeForce(7.9, gallbladder), ForceLevel::kCalm);
  EXPECT_EQ(JudgeForce(8.0, gallbladder), ForceLevel::kWarning);
  EXPECT_EQ(JudgeForce(12.0, gallbladder), ForceLevel::kDanger);
  EXPECT_EQ(FindForceThresholds(roles::OrganRole::kOther).warning, liver.warning)
      << "unknown tissue is treated gently";
  EXPECT_EQ(JudgeForce(NAN, gallbladder), ForceLevel::kDanger);
  EXPECT_GT(kForceBarEnd, gallbladder.danger) << "both marks lie on the bar";
}

TEST(ReadOuts, ContactIsSaidInWords) {
  const scene::Scene scene = TwoOrgans();
  simulation::InstrumentSnapshot instrument;
  EXPECT_EQ(DescribeContact(instrument, scene.patient), "free");
  instrument.is_touching = true;
  instrument.organ = 0;
  EXPECT_EQ(DescribeContact(instrument, scene.patient), "touches the liver");
  instrument.is_grasping = true;
  instrument.organ = 1;
  EXPECT_EQ(DescribeContact(instrument, scene.patient), "holds the gallbladder");
  instrument.organ = 9;
  EXPECT_EQ(DescribeContact(instrument, scene.patient), "holds the tissue") << "an index of nothing";
}

TEST(ReadOuts, EventsAreSaidInWords) {
  const scene::Scene scene = TwoOrgans();
  using surgery::FactKind;
  EXPECT_EQ(DescribeEvent({surgery::FactKind::kGrasp, 10, instrument::kLeft, 1, 2.1}, scene),
            "Left grasper: grasped the gallbladder, 2.1 N");
  EXPECT_EQ(DescribeEvent({surgery::FactKind::kRelease, 10, instrument::kRight, 1, 0}, scene),
            "Right grasper: let the gallbladder go");
  EXPECT_EQ(DescribeEvent({surgery::FactKind::kSlip, 10, instrument::kRight, 0, 4.0}, scene),
            "Right grasper: the liver slipped, 4.0 N");
  EXPECT_EQ(DescribeEvent({surgery::FactKind::kPinchDamage, 10, instrument::kRight, 0, 3.0}, scene),
            "Right grasper: pinched the liver too hard, 3.0 N");
  EXPECT_EQ(DescribeEvent({surgery::FactKind::kToolsTouch, 10, -1, -1, 0}, scene), "The instruments met");
  EXPECT_EQ(DescribeEvent({surgery::FactKind::kStateRestored, 10, -1, 0, 0}, scene),
            "Liver: was not finite, last good state restored (E-SIM-001)");
  EXPECT_EQ(DescribeEvent({surgery::FactKind::kGrasp, 10, instrument::kLeft, 0, 0.01}, scene),
            "Left grasper: grasped the liver");
  scene::Scene rings = TwoOrgans();
  rings.objects.resize(2);
  rings.objects[1].name = "ring_2";
  EXPECT_EQ(DescribeEvent({surgery::FactKind::kGrasp, 10, instrument::kLeft, -1, 1.2, 1}, rings),
            "Left grasper: grasped ring 2, 1.2 N");
  EXPECT_EQ(DescribeEvent({surgery::FactKind::kRelease, 10, instrument::kRight, -1, 0, 1}, rings),
            "Right grasper: let ring 2 go");
  EXPECT_TRUE(IsWarning({surgery::FactKind::kSlip, 10, instrument::kRight, 0, 4.0}));
  EXPECT_FALSE(IsWarning({surgery::FactKind::kGrasp, 10, instrument::kRight, 0, 4.0}));
}

// What tears in blunt dissection is no duct, and no fault.
TEST(ReadOuts, TornFibresAndTornDuctsAreToldApart) {
  scene::Scene scene = TwoOrgans();
  scene.patient.tubes.resize(1);
  const auto tear = [](std::int32_t organ) {
    return scene::Event{surgery::FactKind::kTear, 10, -1, organ, 0};
  };
  EXPECT_EQ(DescribeEvent(tear(-1), scene), "Fibres of connective tissue tore");
  EXPECT_FALSE(IsWarning(tear(-1)));
  EXPECT_EQ(DescribeEvent(tear(1), scene), "Gallbladder: an attachment tore");
  EXPECT_TRUE(IsWarning(tear(1)));
  EXPECT_EQ(DescribeEvent(tear(2), scene), "A duct or vessel was torn off");
  EXPECT_TRUE(IsWarning(tear(2)));
}

TEST(ReadOuts, StagesHaveNamesForPeople) {
  EXPECT_EQ(StageLabel(simulation::Stage::kFindContacts), "Find contacts");
}

TEST(StageMeter, SmoothsAndCountsATickOnce) {
  StageMeter meter;
  simulation::Snapshot snapshot;
  snapshot.tick = 1;
  snapshot.stage_seconds.fill(0.002);
  meter.Add(snapshot);
  EXPECT_DOUBLE_EQ(meter.Seconds()[0], 0.002) << "the first is taken as it is";
  snapshot.stage_seconds.fill(0.062);
  meter.Add(snapshot);
  EXPECT_DOUBLE_EQ(meter.Seconds()[0], 0.002) << "the same tick again";
  snapshot.tick = 2;
  meter.Add(snapshot);
  EXPECT_NEAR(meter.Seconds()[0], 0.003, 1e-15);
}

TEST(FrameMeter, CountsTheLastSecond) {
  FrameMeter meter;
  EXPECT_EQ(meter.Rate(0), 0.0);
  for (int i = 0; i <= 100; ++i) meter.Add(0.02 * i);
  EXPECT_NEAR(meter.Rate(2.0), 50.0, 1e-9);
  EXPECT_EQ(meter.Count(), 101u);
  EXPECT_EQ(meter.Rate(10.0), 0.0) << "nothing was drawn lately";
}

TEST(FrameMeter, HoldsMoreFramesThanItKeeps) {
  FrameMeter meter;
  for (int i = 0; i < 5000; ++i) meter.Add(0.001 * i);
  EXPECT_NEAR(meter.Rate(4.999), 1000.0, 1.0);
}

TEST(DescribeEvent, ARefusedExchangeSaysWhatToDo) {
  const scene::Scene scene;
  EXPECT_EQ(DescribeEvent({surgery::FactKind::kExchangeRefused, 1, instrument::kLeft, -1, 0.0}, scene),
            "Left grasper: open the jaws and let go before the tool is exchanged");
}

TEST(DescribeEvent, ImpossibleActsAndSurgerysErrorsAreAnsweredInWords) {
  scene::Scene scene;
  scene.instruments[instrument::kRight].tool = *instrument::FindTool("clip_applier");
  const auto text = [&](surgery::FactKind kind, int error = -1) {
    scene::Event event{kind, 1, instrument::kRight, -1, 0.0};
    event.error = error;
    return DescribeEvent(event, scene);
  };
  EXPECT_EQ(text(surgery::FactKind::kNoClipsLeft),
            "Right clip applier: there is no clip left; exchange the tool for a full one");
  scene.instruments[instrument::kRight].tray = {*instrument::FindTool("clip_applier"),
                                                *instrument::FindTool("scissors")};
  EXPECT_EQ(text(surgery::FactKind::kTubeCut), "Right hand: cut the tissue") << "whichever tool it has now";
  EXPECT_EQ(text(surgery::FactKind::kStoneTaken), "Right hand: took a stone");
  EXPECT_EQ(text(surgery::FactKind::kStoneRetrieved), "Right hand: retrieved a stone");
  EXPECT_EQ(text(surgery::FactKind::kStoneSpilled), "A stone spilled out of the gallbladder");
  EXPECT_TRUE(IsWarning({surgery::FactKind::kStoneSpilled, 1, instrument::kRight, -1, 0.0}));
  EXPECT_EQ(text(surgery::FactKind::kClipSlipped), "A clip slipped off the tissue");
  EXPECT_NE(text(surgery::FactKind::kUsedOutside).find("push it in"), std::string::npos);
  const scene::Procedure& procedure = *procedures::FindProcedure(procedures::kUsualProcedure);
  scene.operation.emplace().procedure = &procedure;
  EXPECT_EQ(text(surgery::FactKind::kVerdict, 3), procedure.errors[3].explanation);
  EXPECT_TRUE(IsWarning({surgery::FactKind::kVerdict, 1, instrument::kRight, -1, 0.0}));
  EXPECT_FALSE(IsWarning({surgery::FactKind::kClipClosed, 1, instrument::kRight, -1, 0.0}));
}

TEST(ToolLabel, NamesTheToolInUseAndItsClips) {
  scene::Scene scene;
  scene.instruments[instrument::kRight].tray = {*instrument::FindTool("hook"),
                                                *instrument::FindTool("clip_applier")};
  simulation::Snapshot snapshot;
  EXPECT_EQ(ToolLabel(scene, snapshot, instrument::kRight), "hook");
  snapshot.operation.tools[instrument::kRight] = 1;
  snapshot.operation.clips_left[instrument::kRight] = 12;
  EXPECT_EQ(ToolLabel(scene, snapshot, instrument::kRight), "clip applier, 12 clips");
  snapshot.operation.clips_left[instrument::kRight] = 1;
  EXPECT_EQ(ToolLabel(scene, snapshot, instrument::kRight), "clip applier, 1 clip");
}

TEST(DescribeStones, CountsWhatCameOutOfTheGallbladder) {
  using surgery::StonePlace;
  std::vector<surgery::StoneSnapshot> stones(5);
  EXPECT_EQ(DescribeStones({}), "none spilled");
  EXPECT_EQ(DescribeStones(stones), "none spilled");
  stones[0].place = StonePlace::kSpilled, stones[1].place = StonePlace::kHeld;
  EXPECT_EQ(DescribeStones(stones), "2 in the abdomen, 0 retrieved");
  stones[0].place = StonePlace::kAspirated, stones[2].place = StonePlace::kInBag;
  stones[3].place = StonePlace::kTakenOut;
  EXPECT_EQ(DescribeStones(stones), "1 in the abdomen, 3 retrieved");
}

TEST(DescribeFluid, SaysWhatWasLostAndWhatLiesThere) {
  surgery::FluidLedger fluids;
  fluids.Leak(surgery::Fluid::kBlood, 12e-6);
  fluids.Aspirate(8.5e-6);
  EXPECT_EQ(DescribeFluid(fluids, surgery::Fluid::kBlood), "12.0 mL, 3.5 mL in the abdomen");
  EXPECT_EQ(DescribeFluid(fluids, surgery::Fluid::kBile), "0.0 mL, 0.0 mL in the abdomen");
}

TEST(DescribeTask, SaysClockProgressErrorsAndResult) {
  scene::Task task;
  task.goals.resize(2);
  task.goals[0].name = "First";
  task.goals[1].name = "Second";
  task.errors.resize(1);
  task.errors[0].about = "It fell";
  task.time_limit = 90;
  scene::TaskSnapshot now;
  now.phase = scene::TaskPhase::kRunning;
  now.goals.resize(2);
  now.goals[0].is_done = true;
  now.goals[1].is_open = true;
  now.errors = {2};
  now.time = 12.34;
  now.score = 55.5;
  TaskReadOut text = DescribeTask(task, now);
  EXPECT_EQ(text.time, "0:12.3 / 1:30.0");
  EXPECT_EQ(text.progress, "1 of 2");
  EXPECT_EQ(text.score, "—");
  EXPECT_EQ(text.next, "Next: Second");
  EXPECT_EQ(text.errors, "2 × It fell");
  now.phase = scene::TaskPhase::kCompleted;
  text = DescribeTask(task, now);
  EXPECT_EQ(text.score, "55.5");
  EXPECT_NE(text.next.find("Completed"), std::string::npos);
}

}  // namespace
}  // namespace trocar::presenter
