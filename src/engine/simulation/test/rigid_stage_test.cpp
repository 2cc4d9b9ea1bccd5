// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "trocar/files/task_file.h"
#include "trocar/instrument/tool.h"
#include "trocar/scene/scene.h"
#include "trocar/simulation/simulation.h"

namespace trocar::simulation {
namespace {

using math::Vec3;

constexpr double kBoardTop = -0.140;  // of peg transfer [m]
constexpr double kSlack = 0.0015;     // that limits give way [m]

struct PegTransfer {
  std::shared_ptr<const scene::Scene> scene;
  Simulation simulation;
  scene::Input input;

  static PegTransfer Make() {
    auto read = files::ReadTask(*files::FindTask("peg_transfer"));
    EXPECT_TRUE(read.ok());
    auto scene = std::make_shared<const scene::Scene>(std::move(read).value());
    auto simulation = Simulation::Make(scene);
    EXPECT_TRUE(simulation.ok());
    scene::Input input;
    input.settings = scene->settings;
    for (const int hand : {instrument::kLeft, instrument::kRight})
      input.hands[hand] = scene->instruments[hand].home;
    input.laparoscope = scene->laparoscope.home;
    return {scene, std::move(simulation).value(), input};
  }

  /// Takes the right hand to a place in even steps. \return lowest that the jaws' tips came [m]
  double Press(const Vec3& p_world, double jaw, int ticks) {
    const auto from = input.hands[instrument::kRight];
    const auto to =
        instrument::FindJoints(scene->instruments[instrument::kRight].p_world_port, p_world, from.spin, jaw);
    const instrument::Tool& tool = scene->instruments[instrument::kRight].tool;
    double lowest = 0;
    for (int tick = 1; tick <= ticks; ++tick) {
      const double t = static_cast<double>(tick) / ticks;
      auto& now = input.hands[instrument::kRight];
      now.pan = from.pan + t * (to.pan - from.pan);
      now.tilt = from.tilt + t * (to.tilt - from.tilt);
      now.depth = from.depth + t * (to.depth - from.depth);
      now.jaw = from.jaw + t * (to.jaw - from.jaw);
      simulation.Step(input);
      const auto& seen = simulation.GetSnapshot().instruments[instrument::kRight];
      for (const int side : {-1, 1})
        lowest = std::min(lowest, (seen.X_world_tool * instrument::JawTip(tool, seen.joints.jaw, side)).z);
    }
    return lowest;
  }
};

class RigidStage : public testing::TestWithParam<double> {};

// The hand goes on far below the board, whose thickness is 10 mm; what is seen of the tool lies on it.
TEST_P(RigidStage, StopsJawsAtTheBoard) {
  PegTransfer bench = PegTransfer::Make();
  const double jaw = GetParam();
  EXPECT_GT(bench.Press({0.005, 0.03, -0.165}, jaw, 120), kBoardTop - kSlack);
  EXPECT_GT(bench.Press({0.005, 0.03, -0.185}, jaw, 60), kBoardTop - kSlack);
  const auto& pressed = bench.simulation.GetSnapshot().instruments[instrument::kRight];
  EXPECT_LT(pressed.X_world_device.translation.z, kBoardTop - 0.03);
  EXPECT_GT(pressed.force.z, 4.0);  // of the board on the tool
  // and it comes back with the hand
  bench.Press({0.005, 0.03, -0.120}, jaw, 120);
  const auto& back = bench.simulation.GetSnapshot().instruments[instrument::kRight];
  EXPECT_LT(math::Distance(back.X_world_tool.translation, back.X_world_device.translation), 1e-4);
}

TEST_P(RigidStage, StopsFastJawsAtTheBoard) {
  PegTransfer bench = PegTransfer::Make();
  EXPECT_GT(bench.Press({0.005, 0.03, -0.175}, GetParam(), 12), kBoardTop - kSlack);
}

INSTANTIATE_TEST_SUITE_P(Jaws, RigidStage, testing::Values(0.0, 0.6));

}  // namespace
}  // namespace trocar::simulation
