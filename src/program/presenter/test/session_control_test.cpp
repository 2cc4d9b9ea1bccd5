// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/session_control.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <functional>
#include <span>
#include <thread>

#include "trocar/files/scene_file.h"
#include "trocar/record/recording.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::presenter {
namespace {

using device::Motion;

/// The built-in scene, running on its own thread; waits are for events, never for a time that must suffice.
class SessionControlTest : public testing::Test {
 protected:
  void SetUp() override { Open(std::string(TROCAR_SOURCE_DIR) + "/scenes/demonstration.json"); }
  void Open(const std::filesystem::path& path, const session::SessionOptions& options = {}) {
    base::Result<scene::Scene> scene = files::ReadScene(path);
    ASSERT_TRUE(scene.ok()) << scene.error().Text();
    for (scene::InstrumentSetup& setup : scene->instruments) setup.tray.resize(3, setup.tray.front());
    base::Result<simulation::Simulation> simulation =
        simulation::Simulation::Make(std::make_shared<const scene::Scene>(std::move(scene).value()));
    ASSERT_TRUE(simulation.ok()) << simulation.error().Text();
    base::Result<std::unique_ptr<SessionControl>> made =
        SessionControl::Make(std::move(simulation).value(), options);
    ASSERT_TRUE(made.ok()) << made.error().Text();
    control = std::move(made).value();
  }
  /// Frames of 1/60 s until the snapshot satisfies `is_reached`; gives up after a minute.
  bool AdvanceUntil(const std::function<bool(const simulation::Snapshot&)>& is_reached) {
    for (int frame = 0; frame < 6000; ++frame) {
      if (is_reached(control->Advance(1.0 / 60))) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
  }
  bool AdvanceTicks(std::uint64_t count) {
    const std::uint64_t goal = control->Advance(0).tick + count;
    return AdvanceUntil([goal](const simulation::Snapshot& now) { return now.tick >= goal; });
  }
  scene::Input Last() const { return control->LastInput(); }
  /// The left hand of the newest tick; inputs are rounded by half a nanoradian.
  bool IsLeftAt(double pan) const { return std::fabs(Last().hands[instrument::kLeft].pan - pan) < 1e-9; }
  std::unique_ptr<SessionControl> control;
};

TEST_F(SessionControlTest, StartsPausedAtHomeWithTheScenesSettings) {
  EXPECT_TRUE(control->IsPaused());
  control->Device().SetKey(Motion::kIn, true);
  EXPECT_EQ(control->Advance(0.05).tick, 0u);
  EXPECT_EQ(control->GetInput().hands[instrument::kRight].depth,
            control->GetScene().instruments[instrument::kRight].home.depth)
      << "paused hands stand still";
  EXPECT_EQ(control->GetSettings(), control->GetScene().settings);
}

// A mouse feels no board: its hand goes not far below, and comes back at once.
TEST_F(SessionControlTest, TheHandStaysNearAToolThatSomethingStops) {
  Open(std::string(TROCAR_SOURCE_DIR) + "/scenes/tasks/peg_transfer.json");
  control->SetPaused(false);
  // to the lower part of the picture, where the line of sight meets the board steeply
  control->Device().SetKey(Motion::kDown, true);
  ASSERT_TRUE(AdvanceUntil([&](const simulation::Snapshot& now) {
    const math::Vec3 p =
        math::Inverse(control->CalcView(now)) * now.instruments[instrument::kRight].X_world_tool.translation;
    return p.y < 0.15 * p.z;  // z < 0 ahead of the lens: below the middle
  }));
  control->Device().SetKey(Motion::kDown, false);
  control->Device().SetKey(Motion::kIn, true);
  const auto lead = [](const simulation::Snapshot& now) {
    const auto& hand = now.instruments[instrument::kRight];
    return math::Distance(hand.X_world_device.translation, hand.X_world_tool.translation);
  };
  ASSERT_TRUE(AdvanceUntil([&](const simulation::Snapshot& now) { return lead(now) > 0.018; })) << "pressed";
  double most = 0;
  for (int frame = 0; frame < 120; ++frame) {
    most = std::max(most, lead(control->Advance(1.0 / 60)));
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  EXPECT_LT(most, 0.032);
  control->Device().SetKey(Motion::kIn, false);
  const double depth = control->GetInput().hands[instrument::kRight].depth;
  control->Device().SetKey(Motion::kOut, true);
  EXPECT_TRUE(AdvanceUntil([&](const simulation::Snapshot& now) { return lead(now) < 1e-3; }));
  EXPECT_LT(control->GetInput().hands[instrument::kRight].depth, depth);
}

// The issue: the wheel moved the tip off the spot that was aimed at.
TEST_F(SessionControlTest, TheWheelKeepsTheTipOnItsSpotOfThePicture) {
  control->SetPaused(false);
  control->SetDepthSnap(false);
  const auto spot = [&] {
    const simulation::Snapshot& now = control->Advance(1.0 / 60);
    const math::Vec3& port = control->GetScene().instruments[instrument::kRight].p_world_port;
    const math::Vec3 p =
        math::Inverse(control->CalcView(now)) *
        instrument::CalcToolPose(port, control->GetInput().hands[instrument::kRight]).translation;
    return math::Vec3{p.x / -p.z, p.y / -p.z, -p.z};
  };
  const math::Vec3 before = spot();
  for (int turn = 0; turn < 5; ++turn) {
    control->Scroll(-1);
    for (int frame = 0; frame < 20; ++frame) control->Advance(1.0 / 60);
  }
  const math::Vec3 after = spot();
  EXPECT_LT(after.z, before.z - 0.015) << "back towards the lens";
  // a thousandth of the picture: the joints go in steps of a frame
  EXPECT_NEAR(after.x, before.x, 1e-3);
  EXPECT_NEAR(after.y, before.y, 1e-3);
}

// A beginner turns the wheel until something is reached: the tip ends before it, and a further turn presses.
TEST_F(SessionControlTest, TheWheelStopsBeforeWhatTheTipMeets) {
  Open(std::string(TROCAR_SOURCE_DIR) + "/scenes/tasks/peg_transfer.json");
  const auto turn_down = [&](int turns) {
    for (int turn = 0; turn < turns; ++turn) {
      control->Scroll(1);
      for (int frame = 0; frame < 12; ++frame) control->Advance(1.0 / 60);
    }
    const math::Vec3& port = control->GetScene().instruments[instrument::kRight].p_world_port;
    return instrument::CalcToolPose(port, control->GetInput().hands[instrument::kRight]).translation.z;
  };
  constexpr double kBoard = -0.140;  // [m]
  control->SetPaused(false);
  control->SetDepthSnap(true);
  int turns = 0;
  double z = 0, former = 1;
  for (; turns < 40; ++turns) {
    z = turn_down(1);
    if (std::fabs(z - former) < 0.0015 && z < kBoard + 0.01) break;
    former = z;
  }
  EXPECT_GT(z, kBoard) << "it ends above the board";
  EXPECT_LT(z, kBoard + 0.005);
  EXPECT_GT(turns, 5);
  EXPECT_LT(turn_down(2), z - 0.003) << "and then goes on";
  control->Reset();
  control->SetDepthSnap(false);
  EXPECT_LT(turn_down(turns + 4), kBoard - 0.003) << "without it the hand goes on at once";
}

// Looking round with a straight scope does not roll the picture, and the tip goes up with the mouse as it is seen.
TEST_F(SessionControlTest, TheHorizonStaysLevelWithAStraightScope) {
  Open(std::string(TROCAR_SOURCE_DIR) + "/scenes/tasks/peg_transfer.json");
  control->SetPaused(false);
  control->HoldLaparoscope(true);
  control->Device().SetKey(Motion::kRight, true);
  ASSERT_TRUE(
      AdvanceUntil([](const simulation::Snapshot& now) { return std::fabs(now.laparoscope.pan) > 0.25; }));
  control->Device().SetKey(Motion::kRight, false);
  const simulation::Snapshot& now = control->Now();
  const math::Vec3 side{1, 0, 0};
  EXPECT_GT(std::fabs(math::Rotate(now.X_world_laparoscope.rotation, side).z), 0.1) << "the scope has rolled";
  EXPECT_NEAR(math::Rotate(control->CalcView(now).rotation, side).z, 0.0, 1e-9);
}

TEST_F(SessionControlTest, PedalsBelongToTheChosenHandAndAPauseReleasesThem) {
  control->SetPaused(false);
  control->ChooseHand(device::kLeftHand);
  control->SetPedal(Pedal::kCut, true);
  control->SetPedal(Pedal::kRinse, true);
  const auto& controls = control->GetInput().controls;
  EXPECT_TRUE(controls[instrument::kLeft].cut && controls[instrument::kLeft].rinse);
  EXPECT_FALSE(controls[instrument::kRight].cut || controls[instrument::kLeft].coagulate);
  control->SwitchHand();
  EXPECT_FALSE(controls[instrument::kLeft].cut || controls[instrument::kRight].cut)
      << "no foot stays on a pedal";
  control->SetPedal(Pedal::kCoagulate, true);
  EXPECT_TRUE(controls[instrument::kRight].coagulate);
  control->SetPaused(true);
  EXPECT_FALSE(controls[instrument::kRight].coagulate);
  control->SetPedal(Pedal::kCoagulate, true);
  EXPECT_FALSE(controls[instrument::kRight].coagulate) << "a pedal does nothing while paused";
}

/// What a device says, set by the test; lost while `is_plugged` is false.
struct FakeDevice : device::Driver {
  struct Shared {
    std::atomic<std::uint32_t> buttons{0};
    std::atomic<double> pan{0};
    std::atomic<bool> is_plugged{true}, is_seen{true};
  };
  explicit FakeDevice(Shared& state) : Driver("fake", device::kChannelCount), shared(state) {}
  base::Status DoConfigure() override {
    if (shared.is_plugged) return {};
    return base::Error{base::ErrorCode::kDeviceLost, "not plugged in"};
  }
  base::Status DoActivate() override { return {}; }
  void DoDeactivate() noexcept override {}
  void DoCleanup() noexcept override {}
  device::ReadStatus DoRead(std::span<device::HandSample> samples) noexcept override {
    if (!shared.is_plugged) return device::ReadStatus::kLost;
    samples[0] = {shared.pan, 0, 0, 0.12, 1.0, 0, shared.is_seen, shared.buttons};
    return device::ReadStatus::kFresh;
  }
  Shared& shared;
};

// cut and coagulate, tools, clutch: from the button to the simulation's input; a lost device leaves nothing pressed
TEST_F(SessionControlTest, ADevicesButtonsReachTheOperationAndALossLetsGo) {
  FakeDevice::Shared shared;
  control->UseDevice(std::make_unique<FakeDevice>(shared));
  control->SetPaused(false);
  const auto left = [&] { return Last().controls[instrument::kLeft]; };
  const auto until = [&](const std::function<bool()>& claim) {
    return AdvanceUntil([&](const simulation::Snapshot&) { return claim(); });
  };
  shared.pan = 0.2;
  ASSERT_TRUE(until([&] { return IsLeftAt(0.2); }));
  shared.buttons = 1;
  ASSERT_TRUE(until([&] { return left().cut; }));
  EXPECT_FALSE(control->GetInput().controls[instrument::kLeft].cut) << "no key";
  EXPECT_FALSE(Last().controls[instrument::kRight].cut);
  shared.buttons = 8;
  ASSERT_TRUE(until([&] { return left().tool == 1; }));
  EXPECT_FALSE(left().cut);
  EXPECT_TRUE(until([&] { return control->GetInput().controls[instrument::kLeft].tool == 1; }))
      << "the panel shows it";
  shared.pan = 0.5;
  shared.buttons = 2;
  ASSERT_TRUE(until([&] { return left().coagulate; }));
  shared.is_plugged = false;
  ASSERT_TRUE(until([&] { return !left().coagulate; }));
  EXPECT_TRUE(control->IsPaused());
  EXPECT_EQ(left().tool, 1) << "the tool stays";
  shared.is_plugged = true;
  control->SetPaused(false);
  ASSERT_TRUE(until([&] { return IsLeftAt(0.5); }));
  ASSERT_TRUE(AdvanceTicks(10));
  EXPECT_FALSE(left().coagulate) << "the foot that stayed does not count";
  // a tool that is far behind its hand would draw it back where the device is out of sight for a moment
  ASSERT_TRUE(AdvanceUntil([](const simulation::Snapshot& now) {
    return std::fabs(now.instruments[instrument::kLeft].joints.pan - 0.5) < 0.01;
  }));
  control->ChooseHand(device::kLeftHand);
  control->SetPedal(Pedal::kClutch, true);
  ASSERT_TRUE(AdvanceTicks(2));
  shared.pan = 0.9;
  device::SystemClock().Sleep(0.02);
  ASSERT_TRUE(AdvanceTicks(4));
  EXPECT_TRUE(IsLeftAt(0.5));
  control->SetPedal(Pedal::kClutch, false);
  ASSERT_TRUE(AdvanceTicks(2));
  EXPECT_TRUE(IsLeftAt(0.5)) << "it goes on from there";
}

TEST_F(SessionControlTest, ADevicesPedalsDoNothingWhilePaused) {
  FakeDevice::Shared shared;
  control->UseDevice(std::make_unique<FakeDevice>(shared));
  shared.pan = 0.2;
  ASSERT_TRUE(AdvanceUntil([&](const simulation::Snapshot&) { return IsLeftAt(0.2); }));
  shared.buttons = 1 | 8;
  for (int frame = 0; frame < 20; ++frame) {
    device::SystemClock().Sleep(0.005);
    control->Advance(0.01);
  }
  EXPECT_FALSE(Last().controls[instrument::kLeft].cut);
  control->SetPaused(false);
  ASSERT_TRUE(AdvanceTicks(2));
  EXPECT_TRUE(Last().controls[instrument::kLeft].cut) << "it is held";
  EXPECT_EQ(Last().controls[instrument::kLeft].tool, 0) << "that press was for nothing";
}

// Between two frames a pedal goes down and up: one tick has it, the one that was promised.
TEST_F(SessionControlTest, APedalThatIsShorterThanAFrameReachesItsTick) {
  const test::TemporaryFolder folder;
  session::SessionOptions options;
  options.keeping = session::AttemptKeeping{folder.Path(), {}, {}, {}};
  options.keeping->description.name = std::string(TROCAR_SOURCE_DIR) + "/scenes/demonstration.json";
  Open(options.keeping->description.name, options);
  control->SetPaused(false);
  ASSERT_TRUE(AdvanceTicks(130));
  control->ChooseHand(device::kLeftHand);
  control->SetPedal(Pedal::kCoagulate, true);
  control->SetPedal(Pedal::kCoagulate, false);
  ASSERT_TRUE(AdvanceTicks(10));
  const auto path = control->Recording().value().path;
  control.reset();
  const auto recording = record::ReadRecording(path);
  ASSERT_TRUE(recording.ok()) << recording.error().Text();
  EXPECT_EQ(
      std::count_if(recording->inputs.begin(), recording->inputs.end(),
                    [](const scene::Input& input) { return input.controls[instrument::kLeft].coagulate; }),
      1);
}

// The mouse takes a hand up where a device has left it.
TEST_F(SessionControlTest, TheMouseGoesOnWhereADeviceLostAHand) {
  FakeDevice::Shared shared;
  control->UseDevice(std::make_unique<FakeDevice>(shared));
  control->SetPaused(false);
  control->ChooseHand(device::kLeftHand);
  shared.pan = 0.2;
  ASSERT_TRUE(AdvanceUntil([&](const simulation::Snapshot& now) {
    return std::fabs(now.instruments[instrument::kLeft].joints.pan - 0.2) < 0.01 && IsLeftAt(0.2);
  })) << "there, not nearly there";
  shared.is_seen = false;
  ASSERT_TRUE(AdvanceUntil([&](const simulation::Snapshot&) {
    return !control->GetSession().Input().IsHeldByDevice(instrument::kLeft);
  }));
  control->Device().SetKey(Motion::kSpinRight, true);
  const double spin = control->GetInput().hands[instrument::kLeft].spin;
  ASSERT_TRUE(AdvanceUntil([&](const simulation::Snapshot&) {
    return std::fabs(control->GetInput().hands[instrument::kLeft].spin - spin) > 0.05;
  }));
  EXPECT_TRUE(IsLeftAt(0.2));
}

TEST_F(SessionControlTest, ToolsGoRoundTheTrayAndTheAssistantObeys) {
  const auto& tray = control->GetScene().instruments[instrument::kRight].tray;
  ASSERT_FALSE(tray.empty());
  control->ChooseHand(device::kRightHand);
  for (std::size_t i = 0; i < tray.size(); ++i) {
    EXPECT_EQ(control->GetInput().controls[instrument::kRight].tool, i);
    control->StepTool(1);
  }
  EXPECT_EQ(control->GetInput().controls[instrument::kRight].tool, 0);
  control->StepTool(-1);
  EXPECT_EQ(control->GetInput().controls[instrument::kRight].tool, tray.size() - 1);
  control->ChooseTool(instrument::kRight, tray.size());
  EXPECT_EQ(control->GetInput().controls[instrument::kRight].tool, tray.size() - 1) << "no such place";
  control->StepAssistant();
  EXPECT_EQ(control->GetInput().assistant, scene::AssistantCommand::kRetract);
  control->Reset();
  EXPECT_EQ(control->GetInput().assistant, scene::AssistantCommand::kWait);
  EXPECT_EQ(control->GetInput().controls[instrument::kRight].tool, 0);
}

TEST_F(SessionControlTest, HeldKeyMovesTheToolOfTheSimulation) {
  control->SetPaused(false);
  control->ChooseHand(device::kLeftHand);
  ASSERT_TRUE(AdvanceUntil([](const simulation::Snapshot& now) { return now.tick > 2; }));
  const math::Vec3 start = control->Advance(0).instruments[instrument::kLeft].X_world_tool.translation;
  const math::Pose X_world_view = control->CalcView(control->Advance(0));
  const math::Vec3 right = math::Rotate(X_world_view.rotation, {1, 0, 0});
  control->Device().SetKey(Motion::kRight, true);
  EXPECT_TRUE(AdvanceUntil([&](const simulation::Snapshot& now) {
    return math::Dot(now.instruments[instrument::kLeft].X_world_tool.translation - start, right) > 0.005;
  })) << "the tip goes to the right in the picture";
  const math::Vec3 moved =
      control->Advance(0).instruments[instrument::kLeft].X_world_tool.translation - start;
  EXPECT_GT(math::Dot(moved, right), 0.95 * math::Norm(moved)) << "and nowhere else";
}

TEST_F(SessionControlTest, SettingsReachTheRunningSimulation) {
  control->SetPaused(false);
  scene::LiveSettings settings = control->GetSettings();
  settings.gravity = 3.0;
  control->SetSettings(settings);
  EXPECT_TRUE(AdvanceUntil(
      [](const simulation::Snapshot& now) { return std::abs(math::Norm(now.gravity) - 3.0) < 1e-9; }));
  settings.gravity = 1e9;
  control->SetSettings(settings);
  EXPECT_EQ(control->GetSettings().gravity, 30.0) << "clamped";
  control->RestoreSettings();
  EXPECT_EQ(control->GetSettings(), control->GetScene().settings);
}

TEST_F(SessionControlTest, DemonstrationMovesTheHandsAndIsTakenOverWithoutAJump) {
  ASSERT_TRUE(control->HasScript());
  control->SetDemonstration(true);
  control->SetPaused(false);
  const double home = control->GetScene().instruments[instrument::kLeft].home.depth;
  ASSERT_TRUE(AdvanceUntil([&](const simulation::Snapshot& now) {
    return std::abs(now.instruments[instrument::kLeft].joints.depth - home) > 0.01;
  }));
  const simulation::InstrumentSnapshot before = control->Advance(0).instruments[instrument::kLeft];
  control->SetDemonstration(false);
  control->Advance(0);
  EXPECT_NEAR(control->GetInput().hands[instrument::kLeft].depth, before.joints.depth, 0.005);
  EXPECT_NEAR(control->GetInput().hands[instrument::kLeft].pan, before.joints.pan, 0.05);
}

TEST_F(SessionControlTest, ATaskWithoutAScriptIsShownByTheExpertAndTakenOverWithTheToolInUse) {
  Open(std::string(TROCAR_SOURCE_DIR) + "/scenes/tasks/clip_and_cut.json");
  ASSERT_TRUE(control->HasScript());
  control->SetDemonstration(true);
  control->SetPaused(false);
  EXPECT_TRUE(AdvanceUntil([](const simulation::Snapshot& now) {
    return now.operation.tools[instrument::kRight] == 1;
  })) << "three clips, then the scissors";
  EXPECT_EQ(control->Advance(0).operation.clip_count, 3u);
  EXPECT_FALSE(control->IsDemonstrationOver());
  control->SetDemonstration(false);
  EXPECT_EQ(control->GetInput().controls[instrument::kRight].tool, 1) << "it is not exchanged back";
  control->SetDemonstration(true);
  EXPECT_TRUE(AdvanceUntil([&](const simulation::Snapshot& now) {
    return now.task.IsOver() && control->IsDemonstrationOver();
  })) << "from the beginning to the end";
}

TEST_F(SessionControlTest, TheExpertsLaparoscopeIsTakenOverWhereItIs) {
  Open(std::string(TROCAR_SOURCE_DIR) + "/scenes/tasks/camera_navigation_0.json");
  control->SetDemonstration(true);
  control->SetPaused(false);
  const double home = control->GetScene().laparoscope.home.pan;
  ASSERT_TRUE(AdvanceUntil(
      [&](const simulation::Snapshot& now) { return std::abs(now.laparoscope.pan - home) > 0.05; }));
  const instrument::TrocarJoints before = control->Advance(0).laparoscope;
  control->SetDemonstration(false);
  control->Advance(0);
  EXPECT_NEAR(control->GetInput().laparoscope.pan, before.pan, 0.02);
}

TEST_F(SessionControlTest, ResetGoesHomeAndToTheFirstTick) {
  control->SetPaused(false);
  control->Device().SetKey(Motion::kIn, true);
  ASSERT_TRUE(AdvanceUntil([](const simulation::Snapshot& now) { return now.tick > 30; }));
  control->SetPaused(true);
  control->Reset();
  EXPECT_TRUE(AdvanceUntil([](const simulation::Snapshot& now) { return now.tick == 0; }));
  EXPECT_EQ(control->GetInput().hands[instrument::kRight].depth,
            control->GetScene().instruments[instrument::kRight].home.depth);
}

TEST_F(SessionControlTest, LaparoscopeIsHeldAndGivenBackToTheSameHand) {
  control->ChooseHand(device::kLeftHand);
  control->HoldLaparoscope(true);
  EXPECT_TRUE(control->IsLaparoscopeHeld());
  control->SwitchHand();
  EXPECT_TRUE(control->IsLaparoscopeHeld()) << "switching hands does not drop the scope";
  control->HoldLaparoscope(false);
  EXPECT_EQ(control->Device().GetChosen(), device::kRightHand);
  control->ChooseHand(device::kLaparoscope);
  EXPECT_EQ(control->GetHand(), device::kRightHand) << "no hand";
}

TEST_F(SessionControlTest, TheAutomaticCameraIsTakenOverWhereItIs) {
  control->SetCameraHolder(true);
  control->SetPaused(false);
  control->ChooseHand(device::kRightHand);
  // a tool goes aside until the holder has to follow
  control->Device().SetKey(Motion::kRight, true);
  const instrument::TrocarJoints home = control->GetScene().laparoscope.home;
  ASSERT_TRUE(AdvanceUntil([&](const simulation::Snapshot& now) {
    return std::abs(now.laparoscope.pan - home.pan) + std::abs(now.laparoscope.tilt - home.tilt) > 0.05;
  }));
  control->Device().SetKey(Motion::kRight, false);
  control->SetPaused(true);
  device::SystemClock().Sleep(0.05);  // the tick under way
  const instrument::TrocarJoints before = control->Advance(0).laparoscope;
  control->HoldLaparoscope(true);
  EXPECT_FALSE(control->HasCameraHolder());
  control->Advance(0);
  EXPECT_NEAR(control->GetInput().laparoscope.pan, before.pan, 1e-6);
  EXPECT_NEAR(control->GetInput().laparoscope.tilt, before.tilt, 1e-6);
  EXPECT_NEAR(control->GetInput().laparoscope.depth, before.depth, 1e-6);
}

}  // namespace
}  // namespace trocar::presenter
