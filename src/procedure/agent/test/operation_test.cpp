// SPDX-License-Identifier: Apache-2.0
// The operation on the built-in patient: what tools do, and whether every careless surgeon is caught.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "connective_tissue.h"
#include "operation_harness.h"
#include "trocar/agent/surgeon.h"
#include "trocar/agent/taking_over.h"
#include "trocar/anatomy/generate_patient.h"
#include "trocar/cholecystectomy/operation_judge.h"
#include "trocar/files/patient_file.h"
#include "trocar/files/scene_file.h"
#include "trocar/math/rotation_angle.h"
#include "trocar/patient/patient.h"
#include "trocar/procedures/operation_end.h"
#include "trocar/simulation/simulation.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::agent {

using files::ReadScene;
using instrument::kHandCount;
using instrument::kLeft;
using instrument::kRight;
using math::Vec3;
using scene::CalcScriptInput;
using scene::ConnectiveTissue;
using scene::Event;
using scene::Fibre;
using scene::FibreEnd;
using scene::Input;
using scene::MakeConnectiveTissue;
using simulation::Operation;
using simulation::OperationResult;
using simulation::OperationScene;
using simulation::Simulation;
using simulation::Snapshot;
using surgery::FactKind;

namespace {

Simulation MakeOperation() {
  auto made = Simulation::Make(OperationScene());
  EXPECT_TRUE(made.ok()) << (made.ok() ? "" : made.error().Text());
  return std::move(*made);
}

/// Between the line of sight and the shaft of a tool that is looked past [rad].
constexpr double kLeastPastShaft = 0.5;

/// Runs a surgeon to the end, or for that long.
OperationResult Play(const std::string& name, Simulation& simulation, double most_seconds = 120) {
  auto surgeon = MakeSurgeon(name, OperationScene(), 1);
  EXPECT_TRUE(surgeon.ok());
  while (!(*surgeon)->HasFinished() && simulation.GetSnapshot().time < most_seconds)
    simulation.Step((*surgeon)->Act(simulation.GetSnapshot()));
  return *simulation.GetOperationResult();
}

TEST(ConnectiveTissue, FillsTheTriangleWithThousandsOfFibres) {
  const patient::Patient& patient = OperationScene()->patient;
  const ConnectiveTissue fat = MakeConnectiveTissue(patient, 0.0022, 1);
  EXPECT_GT(fat.lobules.size(), 150u);
  EXPECT_GT(fat.fibres.size(), 1000u);
  EXPECT_TRUE(
      std::any_of(fat.fibres.begin(), fat.fibres.end(), [](const Fibre& f) { return f.is_peritoneum; }));
  for (const Fibre& fibre : fat.fibres) {
    EXPECT_GT(fibre.length, 0.0);
    EXPECT_LT(fibre.length, 0.008);
    ASSERT_EQ(fibre.a.of, FibreEnd::Of::kLobule);
    ASSERT_LT(fibre.a.which, fat.lobules.size());
  }
  // nothing lies in a duct
  for (const patient::Tube& tube : patient.tubes) {
    for (std::size_t k = 0; k < tube.line.points.size(); ++k) {
      for (const Vec3& lobule : fat.lobules)
        ASSERT_GE(math::Distance(lobule, tube.line.points[k]), tube.line.radii[k]);
    }
  }
  const ConnectiveTissue again = MakeConnectiveTissue(patient, 0.0022, 1);
  EXPECT_EQ(again.lobules, fat.lobules);
  EXPECT_NE(MakeConnectiveTissue(patient, 0.0022, 2).lobules, fat.lobules);
}

TEST(ConnectiveTissue, NeedsDucts) {
  patient::Patient patient = OperationScene()->patient;
  patient.tubes.clear();
  EXPECT_TRUE(MakeConnectiveTissue(patient, 0.0022, 1).lobules.empty());
}

TEST(Operation, ExchangesToolsButNotWhileHolding) {
  Simulation simulation = MakeOperation();
  Input input = CalcScriptInput(*OperationScene(), 0.0);
  input.controls[kRight].tool = 3;
  double least_depth = 1;
  for (int tick = 0; tick < 240; ++tick) {
    simulation.Step(input);
    least_depth = std::min(least_depth, simulation.GetSnapshot().instruments[kRight].joints.depth);
  }
  EXPECT_EQ(simulation.GetSnapshot().operation.tools[kRight], 3);
  EXPECT_EQ(OperationScene()->instruments[kRight].tray[3].name, "scissors");
  EXPECT_LT(least_depth, 0.035) << "it was drawn out";
  EXPECT_NEAR(simulation.GetSnapshot().instruments[kRight].joints.depth, input.hands[kRight].depth, 1e-6)
      << "and the next one went in";

  // with the gallbladder in the jaws there is no exchange
  simulation.Reset();
  (void)Play("grasps_liver", simulation, 4.0);
  ASSERT_TRUE(simulation.GetSnapshot().instruments[kLeft].is_grasping);
  Input held = CalcScriptInput(*OperationScene(), 0.0);
  for (int hand = 0; hand < kHandCount; ++hand)
    held.hands[hand] = simulation.GetSnapshot().instruments[hand].joints;
  held.controls[kLeft].tool = 1;
  for (int tick = 0; tick < 120; ++tick) simulation.Step(held);
  EXPECT_EQ(simulation.GetSnapshot().operation.tools[kLeft], 0);
  const Snapshot& after = simulation.GetSnapshot();
  EXPECT_TRUE(std::any_of(after.events.begin(), after.events.end(),
                          [](const Event& event) { return event.kind == FactKind::kExchangeRefused; }));
}

/// Share of the ticks in which the recognised phase is the surgeon's own.
double PlayForAgreement(std::uint64_t seed, double most_seconds) {
  Simulation simulation = MakeOperation();
  auto surgeon = MakeSurgeon("expert", OperationScene(), seed);
  EXPECT_TRUE(surgeon.ok());
  int ticks = 0, agreed = 0;
  while (!(*surgeon)->HasFinished() && simulation.GetSnapshot().time < most_seconds) {
    simulation.Step((*surgeon)->Act(simulation.GetSnapshot()));
    const auto own = (*surgeon)->OwnPhase();
    if (!own) continue;
    ++ticks;
    agreed += simulation.GetSnapshot().operation.procedure.phase == *own ? 1 : 0;
  }
  EXPECT_GT(ticks, 0);
  return static_cast<double>(agreed) / ticks;
}

// issue 47: the expert spread the triangle from 8 s on, and it was said to prepare until 106 s
TEST(OperationWhole, PhasesAgreeWithTheSurgeonsOwn) {
  for (std::uint64_t seed = 1; seed <= 2; ++seed)
    EXPECT_GE(PlayForAgreement(seed, 1200.0), 0.95) << "seed " << seed;
}

TEST(Operation, BloodAndBileAreAccountedFor) {
  Simulation simulation = MakeOperation();
  const OperationResult result = Play("bleeds", simulation, 30.0);
  const auto& blood = result.fluids.fluids[static_cast<std::size_t>(surgery::Fluid::kBlood)];
  EXPECT_GT(blood.left, 10e-6) << "half a minute of an open cystic artery";
  for (const auto& account : result.fluids.fluids)
    EXPECT_NEAR(account.left, account.pooled + account.aspirated, 1e-3 * account.left);
  EXPECT_GT(simulation.GetSnapshot().operation.flow.leak_count, 0u);
}

TEST(Operation, WhoRinsesTakesUpWaterAndBlood) {
  Simulation simulation = MakeOperation();
  const OperationResult result = Play("rinses", simulation, 45.0);
  const auto& blood = result.fluids.fluids[static_cast<std::size_t>(surgery::Fluid::kBlood)];
  EXPECT_TRUE(std::ranges::any_of(result.procedure.errors.Entries(), [&](const surgery::ErrorEntry& entry) {
    return result.procedure.errors.RowOf(entry).name == "bleeding";
  }));
  EXPECT_GT(result.fluids.rinse_aspirated, 10e-6);
  EXPECT_GT(blood.aspirated, 0.5 * blood.left) << "more than half of what has run out";
  EXPECT_NEAR(blood.left, blood.pooled + blood.aspirated, 1e-3 * blood.left);
}

TEST(Operation, BeginsAgainAsItBeganAndRepeats) {
  Simulation simulation = MakeOperation();
  const std::uint64_t start = simulation.Hash();
  (void)Play("cuts_unclipped", simulation, 5.0);
  ASSERT_GT(simulation.GetSnapshot().operation.topology.version, 0u) << "something was cut";
  const std::uint64_t end = simulation.Hash();
  simulation.Reset();
  EXPECT_EQ(simulation.Hash(), start);
  (void)Play("cuts_unclipped", simulation, 5.0);
  EXPECT_EQ(simulation.Hash(), end);
}

// Making the solver anew takes its part of the tick.
TEST(Operation, ATickThatCutsSolvesHalfAsMuch) {
  Simulation simulation = MakeOperation();
  const int most = OperationScene()->settings.solver.newton.max_steps;
  ASSERT_EQ(most, 3);
  auto surgeon = MakeSurgeon("cuts_unclipped", OperationScene(), 1);
  ASSERT_TRUE(surgeon.ok());
  std::uint32_t topology = 0;
  int cuts = 0, most_without = 0;
  while (!(*surgeon)->HasFinished() && simulation.GetSnapshot().time < 5.0) {
    simulation.Step((*surgeon)->Act(simulation.GetSnapshot()));
    const Snapshot& seen = simulation.GetSnapshot();
    if (seen.operation.topology.version == topology) {
      most_without = std::max(most_without, seen.iterations);
      continue;
    }
    topology = seen.operation.topology.version;
    ++cuts;
    EXPECT_LE(seen.iterations, (most + 1) / 2);
    EXPECT_GT(seen.iterations, 0);
  }
  EXPECT_GT(cuts, 0);
  EXPECT_EQ(most_without, most);
}

/// The neck is held: hands that went back to where an operation begins would tear it.
TEST(Operation, WhoTakesOverBeginsWhereTheHandsAre) {
  Simulation simulation = MakeOperation();
  auto first = MakeSurgeon("expert", OperationScene(), 1);
  ASSERT_TRUE(first.ok());
  const Snapshot& seen = simulation.GetSnapshot();
  while (!seen.instruments[kLeft].is_grasping && seen.time < 30) simulation.Step((*first)->Act(seen));
  for (int tick = 0; tick < 120; ++tick) simulation.Step((*first)->Act(seen));
  ASSERT_TRUE(seen.instruments[kLeft].is_grasping);
  const auto place = [&](int hand) {
    return seen.instruments[static_cast<std::size_t>(hand)].X_world_device.translation;
  };
  const Vec3 left = place(kLeft), right = place(kRight), eye = seen.X_world_laparoscope.translation;
  auto second = MakeSurgeonTakingOver("expert", simulation.GetScene(), seen, 2);
  ASSERT_TRUE(second.ok());
  simulation.Step((*second)->Act(seen));
  EXPECT_LT(math::Distance(place(kLeft), left), 5e-4);
  EXPECT_LT(math::Distance(place(kRight), right), 5e-4);
  EXPECT_LT(math::Distance(seen.X_world_laparoscope.translation, eye), 5e-4);
  EXPECT_TRUE(seen.instruments[kLeft].is_grasping);
}

/// What the surgeon does about fat of the triangle that nothing parts, while the left hand seems to hold.
struct AboutTheTriangle {
  scene::AssistantCommand assistant = scene::AssistantCommand::kWait;
  double left_moved = 0;  ///< farthest, while the hook works there at one time [m]
};

AboutTheTriangle PlayOnStillTriangle(bool is_bed_free) {
  Simulation simulation = MakeOperation();
  auto surgeon = MakeSurgeon("expert", OperationScene(), 1);
  EXPECT_TRUE(surgeon.ok());
  simulation.Step((*surgeon)->Act(simulation.GetSnapshot()));
  Snapshot seen = simulation.GetSnapshot();
  const auto strands = simulation.Strands();
  for (std::size_t i = 0; is_bed_free && i < strands.size(); ++i) {
    if (strands[i].kind == scene::StrandInfo::Kind::kBed) seen.operation.strand_is_intact[i] = 0;
  }
  seen.instruments[kLeft].is_grasping = true;
  seen.instruments[kLeft].organ = scene::FindSurface(simulation.Surfaces(), roles::OrganRole::kGallbladder);
  AboutTheTriangle found;
  std::optional<Vec3> held;
  for (int rest = 60 * 120; rest > 0 && !(*surgeon)->HasFinished(); ++seen.tick) {
    const Input input = (*surgeon)->Act(seen);
    seen.operation.assistant.is_holding = input.assistant == scene::AssistantCommand::kRetract;
    if ((*surgeon)->Doing() != "dissect the hepatocystic triangle") {
      held.reset();
      continue;
    }
    const Vec3 left =
        instrument::CalcToolPose(OperationScene()->instruments[kLeft].p_world_port, input.hands[kLeft])
            .translation;
    if (!held) held = left;
    found.left_moved = std::max(found.left_moved, math::Distance(left, *held));
    found.assistant = input.assistant;
    --rest;
  }
  return found;
}

TEST(Operation, AFreeGallbladderIsSwungOutOfTheHooksWay) {
  const AboutTheTriangle free = PlayOnStillTriangle(true), tied = PlayOnStillTriangle(false);
  EXPECT_EQ(free.assistant, scene::AssistantCommand::kRelease);
  EXPECT_GT(free.left_moved, 0.010);
  EXPECT_EQ(tied.assistant, scene::AssistantCommand::kRetract);
  EXPECT_LT(tied.left_moved, 0.001);
}

TEST(OperationWhole, AnExpertGoesFromTheFirstLookToTheBag) {
  Simulation simulation = MakeOperation();
  auto surgeon = MakeSurgeon("expert", OperationScene(), 1);
  ASSERT_TRUE(surgeon.ok());
  const Snapshot& seen = simulation.GetSnapshot();
  std::size_t clips = 0;
  while (!(*surgeon)->HasFinished() && seen.time < 900.0) {
    simulation.Step((*surgeon)->Act(seen));
    if (seen.operation.clip_count == clips) continue;
    const Vec3 clip = seen.operation.clips[clips++].X_world_clip.translation;
    EXPECT_TRUE(
        instrument::IsInView(seen.X_world_laparoscope, OperationScene()->laparoscope.field_of_view, clip));
    const Vec3 shaft = OperationScene()->instruments[kRight].p_world_port - clip;
    EXPECT_GT(math::AngleBetween(seen.X_world_laparoscope.translation - clip, shaft), kLeastPastShaft)
        << "the applier hides clip " << clips;
  }
  EXPECT_GT(clips, 0u);
  const OperationResult result = *simulation.GetOperationResult();
  EXPECT_TRUE(result.is_completed);
  EXPECT_TRUE(result.procedure.was_view_achieved);
  for (const surgery::ErrorEntry& error : result.procedure.errors.Entries())
    EXPECT_NE(result.procedure.errors.RowOf(error).severity, surgery::Severity::kCritical)
        << result.procedure.errors.RowOf(error).name;
  EXPECT_LT(cholecystectomy::FindDetail(result.procedure)->injuries.strasberg,
            cholecystectomy::Strasberg::kD);
}

/// Goes through the whole operation before it errs.
TEST(OperationWhole, WhoLeavesStonesIsCaught) {
  Simulation simulation = MakeOperation();
  const OperationResult result = Play("leaves_stones", simulation, 900.0);
  EXPECT_TRUE(result.is_completed);
  EXPECT_EQ(result.procedure.errors.Count(cholecystectomy::OperationError::kStonesLeft), 1u);
  EXPECT_GT(result.stones.spilled, 0);
}

/// Hands that move nothing: no hold is taken, no fibre parts. A careful surgeon tries otherwise, and then stops.
TEST(OperationWhole, AnExpertWhoGetsNowhereBailsOutAndSaysWhy) {
  Simulation simulation = MakeOperation();
  auto surgeon = MakeSurgeon("expert", OperationScene(), 1);
  ASSERT_TRUE(surgeon.ok());
  simulation.Step((*surgeon)->Act(simulation.GetSnapshot()));
  Snapshot seen = simulation.GetSnapshot();
  constexpr double kMostSeconds = 3000;
  bool was_current_on = false;
  std::set<std::string, std::less<>> done;
  for (; !(*surgeon)->HasFinished() && seen.time < kMostSeconds; ++seen.tick) {
    const Input input = (*surgeon)->Act(seen);
    was_current_on = input.controls[kRight].coagulate;
    done.emplace((*surgeon)->Doing());
    seen.time += OperationScene()->tick_seconds;
  }
  EXPECT_TRUE((*surgeon)->HasFinished());
  EXPECT_FALSE(was_current_on) << "the foot is off the pedal";
  EXPECT_THAT(std::string((*surgeon)->BailOutReason()),
              testing::AllOf(testing::HasSubstr("no critical view"), testing::HasSubstr("fat"),
                             testing::HasSubstr("cystic plate")));
  for (const char* tried : {"turn the neck", "fundus first"}) EXPECT_TRUE(done.contains(tried)) << tried;
  for (const char* not_done : {"close the clip", "cut"}) EXPECT_FALSE(done.contains(not_done)) << not_done;
}

/// Patients from nowhere, with the variants that they are drawn with; figure of the issue: 18 of 20. The others end with a
/// reason, none by time.
TEST(OperationWhole, AnExpertOperatesOnGeneratedPatients) {
  constexpr int kPatients = 20, kWanted = 18;
  constexpr double kMostSeconds = 3600;
  int good = 0, unfinished = 0;
  std::size_t critical = 0;
  for (int seed = 1; seed <= kPatients; ++seed) {
    const test::TemporaryFolder temporary;
    const auto folder = temporary.Path() / "patient";
    const auto patient = anatomy::GeneratePatient(static_cast<std::uint64_t>(seed));
    ASSERT_TRUE(patient.ok()) << patient.error().Text();
    ASSERT_TRUE(files::WritePatient(folder, *patient).ok());
    auto read = ReadScene(std::filesystem::path(TROCAR_SOURCE_DIR) / "scenes/cholecystectomy.json", folder);
    ASSERT_TRUE(read.ok()) << read.error().Text();
    const auto scene = std::make_shared<const scene::Scene>(std::move(*read));
    auto simulation = Simulation::Make(scene);
    ASSERT_TRUE(simulation.ok()) << simulation.error().Text();
    auto surgeon = MakeSurgeon("expert", scene, 1);
    ASSERT_TRUE(surgeon.ok());
    while (!(*surgeon)->HasFinished() && simulation->GetSnapshot().time < kMostSeconds)
      simulation->Step((*surgeon)->Act(simulation->GetSnapshot()));
    const OperationResult result = *simulation->GetOperationResult();
    const std::size_t own = result.procedure.errors.Count(surgery::Severity::kCritical);
    const bool is_good = result.is_completed && result.procedure.was_view_achieved && own == 0;
    const std::string bail_out((*surgeon)->BailOutReason());
    const procedures::OperationEnd end = procedures::JudgeEnd(result, !bail_out.empty());
    std::printf("patient %d: %s, critical view %d, critical errors %zu, %.0f s %s\n", seed,
                std::string(procedures::NameOf(end)).c_str(), result.procedure.was_view_achieved, own,
                simulation->GetSnapshot().time, bail_out.c_str());
    unfinished += end == procedures::OperationEnd::kUnfinished ? 1 : 0;
    good += is_good ? 1 : 0;
    critical += own;
  }
  EXPECT_GE(good, kWanted);
  EXPECT_EQ(critical, 0u) << "no expert commits a critical error";
  EXPECT_EQ(unfinished, 0) << "who does not finish says why";
}

/// Each careless surgeon commits the error that it is listed with.
class CarelessSurgeon : public testing::TestWithParam<std::string> {};

TEST_P(CarelessSurgeon, IsCaught) {
  const auto all = ListSurgeons();
  const auto entry = std::find_if(all.begin(), all.end(), [&](const SurgeonEntry& surgeon) {
    return surgeon.name == GetParam() && surgeon.suits(*OperationScene());
  });
  ASSERT_NE(entry, all.end());
  Simulation simulation = MakeOperation();
  const OperationResult result = Play(GetParam(), simulation);
  std::string found;
  for (const surgery::ErrorEntry& error : result.procedure.errors.Entries())
    found += std::string(result.procedure.errors.RowOf(error).name) + " ";
  EXPECT_NE(found.find(entry->error), std::string::npos) << "found only: " << found;
}

INSTANTIATE_TEST_SUITE_P(All, CarelessSurgeon,
                         testing::Values("clips_main_duct", "cuts_main_duct", "burns_main_duct",
                                         "cuts_unclipped", "clips_early", "too_few_clips", "crosses_clips",
                                         "clips_partly", "bleeds", "slips_clip", "perforates", "burns_liver",
                                         "burns_near_duct", "burns_unseen", "burns_air", "drops_clip",
                                         "grasps_liver", "pulls_hard", "cuts_liver", "inserts_blind"),
                         [](const auto& surgeon) { return surgeon.param; });

}  // namespace
}  // namespace trocar::agent
