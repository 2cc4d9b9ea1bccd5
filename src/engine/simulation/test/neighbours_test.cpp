// SPDX-License-Identifier: Apache-2.0
// What lies beside the operated organs: tools stop at it, it gives way, and a patient brings ports and table with it.
#include <gtest/gtest.h>

#include <algorithm>

#include "small_scene.h"
#include "trocar/files/patient_file.h"
#include "trocar/patient/patient.h"
#include "trocar/simulation/simulation.h"

namespace trocar::simulation {

using math::Vec3;
using scene::Input;
using scene::SmallScene;

namespace {

class Neighbours : public SmallScene {
 protected:
  /// The left hand's tip starts 12 mm in front of the fundus; a ball lies to its right side, clear of it.
  static constexpr Vec3 kCentre{-0.050, 0.056, -0.110};
  static constexpr double kRadius = 0.020;

  Simulation Make(const std::vector<patient::Neighbour>& neighbours) {
    patient::Patient patient = MakePatient();
    patient.neighbours = neighbours;
    EXPECT_TRUE(files::WritePatient(folder_ / "patient", patient).ok());
    auto read = Read();
    EXPECT_TRUE(read.ok()) << read.error().Text();
    auto made = Simulation::Make(std::make_shared<const scene::Scene>(std::move(*read)));
    EXPECT_TRUE(made.ok()) << made.error().Text();
    return std::move(*made);
  }
  static std::vector<patient::Neighbour> Stomach() {
    return {{"stomach", geometry::MakeSphere(kCentre, kRadius, 3)}};
  }
  /// Drives the left tip from its home to the ball's middle and holds it there.
  static Input Drive(const Simulation& simulation, int tick) {
    Input input = scene::CalcScriptInput(simulation.GetScene(), 0.0);
    const auto& setup = simulation.GetScene().instruments[instrument::kLeft];
    const Vec3 from{-0.050, 0.056, -0.070};
    const double t = std::min(1.0, tick / 120.0);
    input.hands[instrument::kLeft] =
        instrument::FindJoints(setup.p_world_port, math::Lerp(from, kCentre, t), 0.0, 0.0);
    return input;
  }
};

TEST_F(Neighbours, StopAToolAndAreDented) {
  Simulation simulation = Make(Stomach());
  for (int tick = 0; tick < 200; ++tick) simulation.Step(Drive(simulation, tick));
  const Snapshot& snapshot = simulation.GetSnapshot();
  const InstrumentSnapshot& tool = snapshot.instruments[instrument::kLeft];
  // the hand is at the middle, the tool that is seen is not in the ball but for what this gives way
  EXPECT_LT(math::Distance(tool.X_world_device.translation, kCentre), 0.001);
  EXPECT_GT(math::Distance(tool.X_world_tool.translation, kCentre), kRadius - 0.0125);
  EXPECT_GT(math::Norm(tool.force), 0.5);
  EXPECT_EQ(snapshot.dents[instrument::kLeft].neighbour, 0);
  EXPECT_GT(math::Norm(snapshot.dents[instrument::kLeft].push), 0.003);
  EXPECT_LE(math::Norm(snapshot.dents[instrument::kLeft].push), 0.0100001);
  EXPECT_EQ(snapshot.dents[instrument::kRight].neighbour, -1);
  EXPECT_LT(tool.overlap, 0.0015);

  // and is at rest, to the force on the hand
  const Vec3 force = tool.force;
  for (int tick = 200; tick < 230; ++tick) simulation.Step(Drive(simulation, tick));
  EXPECT_LT(math::Distance(simulation.GetSnapshot().instruments[instrument::kLeft].force, force),
            0.02 * math::Norm(force));
}

TEST_F(Neighbours, WithoutThemTheToolGoesThere) {
  Simulation simulation = Make({});
  for (int tick = 0; tick < 200; ++tick) simulation.Step(Drive(simulation, tick));
  const InstrumentSnapshot& tool = simulation.GetSnapshot().instruments[instrument::kLeft];
  EXPECT_LT(math::Distance(tool.X_world_tool.translation, kCentre), 0.001);
  EXPECT_EQ(math::Norm(tool.force), 0.0);
}

TEST_F(Neighbours, ThatNobodyTouchesChangeNothing) {
  Simulation with = Make({{"stomach", geometry::MakeSphere({0.2, 0, -0.1}, 0.02, 2)}});
  Simulation without = Make({});
  EXPECT_NE(with.ModelFingerprint(), without.ModelFingerprint());
  for (int tick = 0; tick < 60; ++tick) {
    const Input input = scene::CalcScriptInput(with.GetScene(), 0.01 * tick);
    with.Step(input);
    without.Step(input);
  }
  EXPECT_EQ(with.GetSnapshot().positions, without.GetSnapshot().positions);
  EXPECT_EQ(with.GetSnapshot().instruments[0].force, without.GetSnapshot().instruments[0].force);
}

TEST_F(Neighbours, GoOnTheSameFromASavedState) {
  Simulation simulation = Make(Stomach());
  for (int tick = 0; tick < 110; ++tick) simulation.Step(Drive(simulation, tick));
  ASSERT_GT(math::Norm(simulation.GetSnapshot().dents[instrument::kLeft].push), 0.001);
  std::vector<std::byte> saved;
  simulation.Save(saved);
  for (int tick = 110; tick < 125; ++tick) simulation.Step(Drive(simulation, tick));
  const auto hash = simulation.Hash(StatePart::kAll);
  for (int tick = 0; tick < 30; ++tick) simulation.Step(Drive(simulation, 0));
  ASSERT_TRUE(simulation.Restore(saved).ok());
  for (int tick = 110; tick < 125; ++tick) simulation.Step(Drive(simulation, tick));
  EXPECT_EQ(simulation.Hash(StatePart::kAll), hash);
  // and from the start
  simulation.Reset();
  EXPECT_EQ(simulation.GetSnapshot().dents[instrument::kLeft].neighbour, -1);
  for (int tick = 0; tick < 125; ++tick) simulation.Step(Drive(simulation, tick));
  EXPECT_EQ(simulation.Hash(StatePart::kAll), hash);
}

TEST_F(Neighbours, APatientsPortsAndTableTakeThePlaceOfTheScenes) {
  patient::Patient patient = MakePatient();
  patient.ports = {{patient::PortUse::kLaparoscope, {0.001, -0.01, 0.002}, "test"},
                   {patient::PortUse::kLeftHand, {-0.04, 0.05, 0.003}, "test"}};
  patient.table = patient::Table{0.2, 0.1, "test"};
  ASSERT_TRUE(files::WritePatient(folder_ / "patient", patient).ok());
  const auto read = Read();
  ASSERT_TRUE(read.ok()) << read.error().Text();
  const auto is_at = [](const Vec3& a, const Vec3& b) { return math::Distance(a, b) < 1e-9; };
  EXPECT_TRUE(is_at(read->laparoscope.p_world_port, {0.001, -0.01, 0.002}));
  EXPECT_TRUE(is_at(read->instruments[instrument::kLeft].p_world_port, {-0.04, 0.05, 0.003}));
  EXPECT_TRUE(is_at(read->instruments[instrument::kRight].p_world_port, {0.03, 0.06, 0.0}));  // the scene's
  EXPECT_NEAR(read->settings.head_up, 0.2, 1e-9);
  EXPECT_NEAR(read->settings.right_up, 0.1, 1e-9);
}

}  // namespace
}  // namespace trocar::simulation
