// SPDX-License-Identifier: Apache-2.0
#include "camera_holder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <utility>

#include "small_scene.h"
#include "trocar/files/scene_file.h"
#include "trocar/simulation/simulation.h"

namespace trocar::simulation {

using files::ReadScene;
using instrument::kRight;
using math::Vec3;
using scene::CalcLaparoscopePose;
using scene::CalcScriptInput;
using scene::FindView;
using scene::Scene;
using scene::SmallScene;
using scene::ViewRequest;

namespace {

constexpr double kTick = 1.0 / 120;

class CameraHolderTest : public testing::TestWithParam<double> {
 protected:
  CameraHolderTest() {
    setup_.p_world_port = {0, -0.1, 0};
    setup_.view_angle = GetParam();
    ViewRequest request;
    request.p_world = kField;
    request.distance = 0.08;
    setup_.home = FindView(setup_, request).value();
    holder_.Reset(setup_.home);
  }
  bool AreInView(std::span<const Vec3> tips, const instrument::TrocarJoints& joints) const {
    const math::Pose X = CalcLaparoscopePose(setup_, joints);
    return std::ranges::all_of(
        tips, [&](const Vec3& tip) { return instrument::IsInView(X, setup_.field_of_view, tip); });
  }
  /// How far the picture's horizontal leans towards the patient's head [rad].
  double CalcRoll(const instrument::TrocarJoints& joints) const {
    return std::asin(math::Rotate(CalcLaparoscopePose(setup_, joints).rotation, {1, 0, 0}).y);
  }
  static constexpr Vec3 kField{0, 0.02, -0.12};
  scene::LaparoscopeSetup setup_;
  CameraHolder holder_;
};
INSTANTIATE_TEST_SUITE_P(Scopes, CameraHolderTest, testing::Values(0.0, M_PI / 6));

// Two tools wander through the abdomen at the speed of a calm surgeon.
TEST_P(CameraHolderTest, KeepsBothTipsAndTheHorizonInView) {
  int out = 0, out_without = 0;
  double fastest = 0, roll = 0;
  const double roll_at_home = CalcRoll(setup_.home);
  Vec3 lens = CalcLaparoscopePose(setup_, setup_.home).translation;
  for (int tick = 0; tick < 60 * 120; ++tick) {
    const double t = tick * kTick;
    const Vec3 middle =
        kField + Vec3{0.05 * std::sin(0.30 * t), 0.04 * std::sin(0.23 * t), 0.02 * std::sin(0.17 * t)};
    const Vec3 apart{0.01 + 0.008 * std::sin(0.4 * t), 0.004 * std::cos(0.6 * t), 0};
    const Vec3 tips[] = {middle + apart, middle - apart};
    const auto& joints = holder_.Follow(setup_, tips, kTick);
    out += !AreInView(tips, joints);
    out_without += !AreInView(tips, setup_.home);
    const Vec3 now = CalcLaparoscopePose(setup_, joints).translation;
    fastest = std::max(fastest, math::Distance(now, lens) / kTick);
    lens = now;
    roll = std::max(roll, std::fabs(CalcRoll(joints) - roll_at_home));
  }
  EXPECT_EQ(out, 0);
  EXPECT_GT(out_without, 120) << "negative control: a still laparoscope loses them";
  EXPECT_LT(fastest, 0.09) << "smoothly";
  EXPECT_LT(roll, 0.1);
}

TEST_P(CameraHolderTest, HoldsStillWhileTheToolsWorkInTheMiddle) {
  for (int tick = 0; tick < 1200; ++tick) {
    const double t = tick * kTick;
    const Vec3 tips[] = {kField + 0.008 * Vec3{std::sin(9 * t), std::cos(7 * t), 0},
                         kField + Vec3{0.012, 0, 0}};
    const auto before = holder_.Now();
    const auto& now = holder_.Follow(setup_, tips, kTick);
    if (tick > 240) {
      ASSERT_EQ(now, before) << tick;
    }
  }
  const auto before = holder_.Now();
  for (int tick = 0; tick < 240; ++tick)
    ASSERT_EQ(holder_.Follow(setup_, {}, kTick), before) << "no tool at all";
}

TEST_P(CameraHolderTest, GoesNearForFineWorkAndBackForWideWork) {
  const auto settle = [&](double apart) {
    const Vec3 tips[] = {kField + Vec3{apart, 0, 0}, kField - Vec3{apart, 0, 0}};
    for (int tick = 0; tick < 1200; ++tick) (void)holder_.Follow(setup_, tips, kTick);
    EXPECT_TRUE(AreInView(tips, holder_.Now()));
    return math::Distance(CalcLaparoscopePose(setup_, holder_.Now()).translation, kField);
  };
  const double wide = settle(0.04), fine = settle(0.003);
  EXPECT_GT(wide, fine + 0.02);
  EXPECT_GT(fine, 0.035);
}

class AutomaticCamera : public SmallScene {};

TEST_F(AutomaticCamera, IsASettingOfTheSceneAndMovesTheSnapshotsLaparoscope) {
  std::string text = SceneText();
  text.insert(text.find(R"("depth_mm": 50)"), R"("holder": "robot", )");
  Write("scene.json", text);
  EXPECT_EQ(Read().error().code, base::ErrorCode::kUnknownName);
  text.replace(text.find("robot"), 5, "automatic");
  Write("scene.json", text);
  auto scene = Read();
  ASSERT_TRUE(scene.ok()) << scene.error().Text();
  EXPECT_TRUE(scene->settings.holds_camera);
  const auto shared = std::make_shared<const Scene>(std::move(*scene));
  auto simulation = Simulation::Make(shared);
  ASSERT_TRUE(simulation.ok());
  scene::Input input = CalcScriptInput(*shared, 0.0);
  // both hands go aside; what the trainee's laparoscope does is not looked at
  for (int hand = 0; hand < instrument::kHandCount; ++hand)
    input.hands[hand] = instrument::FindJoints(shared->instruments[hand].p_world_port,
                                               Vec3{0.06 + 0.01 * hand, 0.05, -0.1}, 0.0, 0.0);
  for (int tick = 0; tick < 480; ++tick) {
    input.laparoscope.tilt += 0.001;
    simulation->Step(input);
  }
  const Snapshot& seen = simulation->GetSnapshot();
  EXPECT_NE(seen.laparoscope, input.laparoscope);
  for (const InstrumentSnapshot& tool : seen.instruments)
    EXPECT_TRUE(instrument::IsInView(seen.X_world_laparoscope, shared->laparoscope.field_of_view,
                                     tool.X_world_tool.translation));
  const std::uint64_t hash = simulation->Hash();
  // given back, it is where the hand says
  input.settings.holds_camera = false;
  simulation->Step(input);
  EXPECT_EQ(simulation->GetSnapshot().laparoscope.pan, input.laparoscope.pan);
  EXPECT_NE(simulation->Hash(), hash);
  simulation->Reset();
  EXPECT_EQ(simulation->GetSnapshot().laparoscope, shared->laparoscope.home);
}

/// Errors of an operation in which the hand looks away while current flows into tissue near the picture's middle.
std::size_t CountErrorsOutOfView(bool holds_camera) {
  auto scene = ReadScene(std::filesystem::path(TROCAR_SOURCE_DIR) / "scenes/cholecystectomy.json");
  EXPECT_TRUE(scene.ok()) << scene.error().Text();
  auto simulation = Simulation::Make(std::make_shared<const Scene>(std::move(*scene)));
  EXPECT_TRUE(simulation.ok());
  const Scene& played = simulation->GetScene();
  scene::Input input = CalcScriptInput(played, 0.0);
  input.settings.holds_camera = holds_camera;
  const auto& tray = played.instruments[kRight].tray;
  const auto hook = std::find_if(tray.begin(), tray.end(), [](const instrument::Tool& tool) {
    return tool.kind == instrument::ToolKind::kHook;
  });
  input.controls[kRight].tool = static_cast<std::uint8_t>(hook - tray.begin());
  const Vec3 p_seen = CalcLaparoscopePose(played.laparoscope, played.laparoscope.home) * Vec3{0, 0, -0.08};
  for (int tick = 0; tick < 360; ++tick) {
    // the automatic holder does not look where the hand's laparoscope goes
    if (tick >= 120) input.laparoscope.pan = played.laparoscope.home.pan - 1.2;
    if (tick >= 120)
      input.hands[kRight] = instrument::FindJoints(played.instruments[kRight].p_world_port, p_seen, 0.0, 0.0);
    input.controls[kRight].coagulate = tick >= 300;
    simulation->Step(input);
  }
  const surgery::ErrorLog errors = simulation->GetOperationResult()->procedure.errors;
  return static_cast<std::size_t>(std::ranges::count_if(
      errors.Entries(),
      [&](const surgery::ErrorEntry& entry) { return errors.RowOf(entry).name == "energy_out_of_view"; }));
}

// What is judged is what the trainee sees: the holder's picture, not the one that the hand's device points at.
TEST(CameraHolderOperation, IsJudgedThroughThePictureThatIsSeen) {
  EXPECT_EQ(CountErrorsOutOfView(true), 0U);
  EXPECT_EQ(CountErrorsOutOfView(false), 1U)
      << "the control: the hand holds the camera itself, and looks away";
}

}  // namespace
}  // namespace trocar::simulation
