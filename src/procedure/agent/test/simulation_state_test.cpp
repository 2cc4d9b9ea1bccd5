// SPDX-License-Identifier: Apache-2.0
// A state that was saved goes on to the same bits, and is seen the same: in the same simulation, in a fresh one, and whoever
// looks on or not.
// The simulation in a process of its own is played by tests/command/state_file_test.cpp; the control that leaves fields out is
// state_fields_test.cpp.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "course.h"
#include "trocar/host/threads.h"

namespace trocar::agent {

using simulation::MakeSimulationModel;
using simulation::Simulation;
using simulation::StatePart;

namespace {

void GoOn(const Recording& recording, const Point& point, Simulation& simulation) {
  for (std::size_t tick = point.tick; tick < point.tick + kGoesOn; ++tick)
    simulation.Step(recording.inputs[tick]);
}

/// A hurried tester's: at TROCAR_STATE_POINTS random ticks, and after as many events.
Course Limit(Course course) {
  if (const char* most = std::getenv("TROCAR_STATE_POINTS"))
    course.points = std::min(course.points, std::atoi(most)),
    course.events = std::min(course.events, std::atoi(most));
  return course;
}

void CheckCourse(const Course& whole) {
  const Course course = Limit(whole);
  const auto scene = ReadCourse(course);
  const Recording recording = Record(course, scene);
  ASSERT_GE(recording.points.size(), 2U) << course.name;
  testing::Test::RecordProperty("points", std::to_string(recording.points.size()));
  Simulation used = std::move(*Simulation::Make(recording.model, {.threads = host::UseThreads(2)}));
  // backwards, so that every state is one of another past
  for (std::size_t i = recording.points.size(); i-- > 0;) {
    const Point& point = recording.points[i];
    Simulation fresh = std::move(*Simulation::Make(recording.model));
    for (Simulation* simulation : {&used, &fresh}) {
      const base::Status restored = simulation->Restore(point.bytes);
      ASSERT_TRUE(restored.ok()) << restored.error().Text();
      const std::string where = course.name + ", tick " + std::to_string(point.tick) +
                                (simulation == &fresh ? ", in a fresh simulation" : "");
      ASSERT_EQ(simulation->Hash(), point.hash) << where;
      ASSERT_EQ(CalcPublishedHash(*simulation), point.published) << where;
      ASSERT_EQ(CalcPatchHash(*simulation), point.patches) << where << ", for the haptic loop";
      GoOn(recording, point, *simulation);
      ASSERT_EQ(simulation->Hash(), point.hash_after) << where << ", " << kGoesOn << " ticks later";
      ASSERT_EQ(CalcPublishedHash(*simulation), point.published_after)
          << where << ", " << kGoesOn << " ticks later";
    }
  }
}

class SimulationState : public testing::TestWithParam<Course> {};
TEST_P(SimulationState, GoesOnToTheSameBits) {
  CheckCourse(GetParam());
}
INSTANTIATE_TEST_SUITE_P(Scenes, SimulationState,
                         testing::Values(Course{"retraction", "", 700, 2},
                                         Course{"demonstration", "", 700, 2}, Course{"tearing", "", 500, 2},
                                         Course{"cholecystectomy", "", 120, 2}),
                         NameOf);
INSTANTIATE_TEST_SUITE_P(Tasks, SimulationState,
                         testing::Values(Course{"camera_navigation_0", "expert", 900, 3},
                                         Course{"camera_navigation_30", "expert", 900, 3},
                                         Course{"clip_and_cut", "crosses_clips", 1700, 3},
                                         Course{"hook_dissection", "expert", 1000, 3},
                                         Course{"instrument_navigation", "clashes", 900, 3},
                                         Course{"lift_and_grasp", "drops", 1200, 3},
                                         Course{"object_transport", "pulls_apart", 1200, 3},
                                         Course{"pattern_cut", "expert", 2000, 3},
                                         Course{"peg_transfer", "expert", 1500, 3},
                                         Course{"wire_run", "touches_wire", 1200, 3}),
                         NameOf);

class SimulationStateSlow : public testing::TestWithParam<Course> {};
TEST_P(SimulationStateSlow, GoesOnToTheSameBits) {
  CheckCourse(GetParam());
}
INSTANTIATE_TEST_SUITE_P(
    Courses, SimulationStateSlow,
    testing::Values(
        Course{"retraction", "", 6000, 20}, Course{"demonstration", "", 2000, 20},
        Course{"tearing", "", 1500, 20}, Course{"cholecystectomy", "expert", 40'000, 20},
        Course{"cholecystectomy", "leaves_stones", 60'000, 20},
        Course{"camera_navigation_0", "expert", 1600, 20}, Course{"camera_navigation_30", "expert", 1600, 20},
        Course{"clip_and_cut", "expert", 1800, 20}, Course{"hook_dissection", "burns_spared", 1100, 20},
        Course{"instrument_navigation", "expert", 2400, 20}, Course{"lift_and_grasp", "expert", 4000, 20},
        Course{"object_transport", "expert", 4000, 20}, Course{"pattern_cut", "cuts_aside", 2200, 20},
        Course{"peg_transfer", "loses", 9000, 20}, Course{"wire_run", "expert", 4000, 20},
        Course{"cholecystectomy", "fumbler", 1500, 20, 0}, Course{"retraction", "fumbler", 1500, 20, 0},
        Course{"clip_and_cut", "fumbler", 1500, 20, 0}, Course{"peg_transfer", "fumbler", 1500, 20, 0}),
    NameOf);

// A bad tick is taken back to the last good one, which is of the state as well.
TEST(SimulationStateGuard, TakesABadTickBackAfterRestoringAsBefore) {
  const auto model = MakeSimulationModel(ReadCourse({"retraction", "", 0, 0}));
  ASSERT_TRUE(model.ok());
  Simulation simulation = std::move(*Simulation::Make(*model));
  Simulation fresh = std::move(*Simulation::Make(*model));
  for (int tick = 0; tick < 120; ++tick)
    simulation.Step(scene::CalcScriptInput(simulation.GetScene(), simulation.GetSnapshot().time));
  std::vector<std::byte> bytes;
  simulation.Save(bytes);
  ASSERT_TRUE(fresh.Restore(bytes).ok());
  scene::Input input = scene::CalcScriptInput(simulation.GetScene(), simulation.GetSnapshot().time);
  input.settings.solver = DivergingSolver();
  for (Simulation* each : {&simulation, &fresh}) each->Step(input);
  const simulation::Snapshot& seen = simulation.GetSnapshot();
  ASSERT_GT(seen.event_count, 0U);
  EXPECT_EQ(seen.events[(seen.event_count - 1) % seen.events.size()].kind, surgery::FactKind::kStateRestored);
  EXPECT_EQ(fresh.Hash(), simulation.Hash());
  EXPECT_EQ(CalcPublishedHash(fresh), CalcPublishedHash(simulation));

  // and after it the haptic loop knows of it
  simulation.Save(bytes);
  ASSERT_TRUE(fresh.Restore(bytes).ok());
  const auto patch = std::make_unique<tissue::LocalPatch>();
  for (Simulation* each : {&simulation, &fresh}) {
    each->CutPatch(instrument::kRight, *patch);
    EXPECT_FALSE(patch->is_healthy) << (each == &fresh ? "restored" : "as it was");
  }
}

// Judging, publishing and task rules change nothing of the world.
TEST(SimulationWorld, IsTheSameWithoutThoseWhoLook) {
  for (const Course& course :
       {Course{"pattern_cut", "expert", 1200, 1}, Course{"clip_and_cut", "crosses_clips", 1200, 1},
        Course{"peg_transfer", "expert", 600, 1}}) {
    const Recording recording = Record(course, ReadCourse(course));
    Simulation judged = std::move(*Simulation::Make(recording.model));
    Simulation alone = std::move(*Simulation::Make(recording.model));
    for (const scene::Input& input : recording.inputs) {
      judged.Step(input);
      alone.StepWorld(input);
    }
    EXPECT_EQ(alone.Hash(StatePart::kWorld), judged.Hash(StatePart::kWorld)) << course.name;
    EXPECT_NE(alone.Hash(), judged.Hash()) << course.name << ": the control; nothing was judged";
  }
}

TEST(SimulationStateBytes, RefusesWhatIsDamagedOrOfAnotherModel) {
  const auto scene = ReadDelivered("hook_dissection");
  Simulation simulation = std::move(*Simulation::Make(scene));
  std::vector<std::byte> bytes;
  simulation.Save(bytes);
  const std::uint64_t hash = simulation.Hash();
  const auto refuses = [&](std::span<const std::byte> damaged) {
    const base::Status restored = simulation.Restore(damaged);
    return !restored.ok() && restored.error().code == base::ErrorCode::kStateInvalid;
  };
  for (std::size_t length = 0; length < bytes.size(); length += 1 + bytes.size() / 97)
    EXPECT_TRUE(refuses(std::span(bytes).first(length))) << length;
  for (std::size_t at = 0; at < bytes.size(); at += 1 + bytes.size() / 101) {
    bytes[at] ^= std::byte{0x10};
    EXPECT_TRUE(refuses(bytes)) << "byte " << at;
    bytes[at] ^= std::byte{0x10};
  }
  std::vector<std::byte> longer = bytes;
  longer.push_back({});
  EXPECT_TRUE(refuses(longer));
  Simulation other = std::move(*Simulation::Make(ReadDelivered("clip_and_cut")));
  EXPECT_FALSE(other.Restore(bytes).ok());
  EXPECT_EQ(simulation.Hash(), hash) << "what was refused has changed nothing";
  EXPECT_TRUE(simulation.Restore(bytes).ok());
}

std::size_t ResidentBytes() {
  std::ifstream file("/proc/self/statm");
  std::size_t pages = 0, resident = 0;
  file >> pages >> resident;
  return resident * 4096;
}

// One more simulation of a model adds its state and scratch alone.
TEST(SimulationModelMemory, IsShared) {
  const auto scene = ReadCourse({"cholecystectomy", "", 0, 0});
  auto model = MakeSimulationModel(scene);
  ASSERT_TRUE(model.ok());
  std::vector<Simulation> simulations;
  simulations.push_back(std::move(*Simulation::Make(*model)));
  const std::size_t before = ResidentBytes();
  constexpr std::size_t kMore = 8;
  for (std::size_t i = 0; i < kMore; ++i) simulations.push_back(std::move(*Simulation::Make(*model)));
  const double each_mb = static_cast<double>(ResidentBytes() - before) / kMore * 1e-6;
  std::vector<std::byte> bytes;
  simulations.back().Save(bytes);
  RecordProperty("mb_each", std::to_string(each_mb));
  RecordProperty("state_bytes", std::to_string(bytes.size()));
  EXPECT_LT(each_mb, 30.0);
  EXPECT_LT(bytes.size(), 5'000'000U);
  EXPECT_EQ(&simulations.front().Surfaces()[0], &simulations.back().Surfaces()[0]);
}

}  // namespace
}  // namespace trocar::agent
