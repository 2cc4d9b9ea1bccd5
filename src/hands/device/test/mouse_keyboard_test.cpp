// SPDX-License-Identifier: Apache-2.0
#include "trocar/device/mouse_keyboard.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>

namespace trocar::device {
namespace {

using Samples = std::array<HandSample, kChannelCount>;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// An active driver with every channel at pan = tilt = spin = 0, depth 0.15 m, jaws half open.
class MouseKeyboardTest : public testing::Test {
 protected:
  void SetUp() override { Start(settings); }
  void Start(const MouseKeyboardSettings& chosen) {
    driver.emplace(chosen);
    ASSERT_TRUE(driver->Configure().ok());
    ASSERT_TRUE(driver->Activate().ok());
    HandSample home;
    home.depth = 0.15;
    home.jaw = 0.5;
    for (const Channel channel : {kLeftHand, kRightHand, kLaparoscope}) driver->Place(channel, home);
  }
  Samples Read() {
    Samples samples;
    driver->Read(samples);
    return samples;
  }
  void Advance(double seconds, int steps) {
    for (int i = 0; i < steps; ++i) driver->Advance(seconds / steps);
  }
  MouseKeyboardSettings settings;
  std::optional<MouseKeyboard> driver;
};

// A key held for T and let go walks rate * T, however the ramps and the steps fall: the way lost while
// speeding up is the way gained while slowing down.
TEST_F(MouseKeyboardTest, HeldKeyWalksRateTimesTime) {
  for (const int steps : {10, 37, 600}) {
    Start(settings);
    driver->SetKey(Motion::kIn, true);
    Advance(0.8, steps);
    driver->SetKey(Motion::kIn, false);
    Advance(0.5, steps);
    EXPECT_NEAR(Read()[kRightHand].depth, 0.15 + settings.tip_rate * 0.8, 1e-12) << steps << " steps";

    driver->SetKey(Motion::kSpinRight, true);
    Advance(0.7, steps);
    driver->SetKey(Motion::kSpinRight, false);
    Advance(0.5, steps);
    EXPECT_NEAR(Read()[kRightHand].spin, settings.spin_rate * 0.7, 1e-12);
  }
}

TEST_F(MouseKeyboardTest, SpeedRisesInAStraightRamp) {
  driver->SetKey(Motion::kSpinLeft, true);
  Advance(settings.ramp_time, 12);
  EXPECT_NEAR(Read()[kRightHand].spin, -0.5 * settings.spin_rate * settings.ramp_time, 1e-12);
  const double before = Read()[kRightHand].spin;
  Advance(0.1, 5);
  EXPECT_NEAR(Read()[kRightHand].spin - before, -settings.spin_rate * 0.1, 1e-12);
}

TEST_F(MouseKeyboardTest, OppositeKeysHoldStill) {
  const Samples before = Read();
  driver->SetKey(Motion::kLeft, true);
  driver->SetKey(Motion::kRight, true);
  Advance(1.0, 60);
  EXPECT_EQ(Read()[kRightHand].pan, before[kRightHand].pan);
}

TEST_F(MouseKeyboardTest, NothingDriftsWithoutInput) {
  const Samples before = Read();
  for (int i = 0; i < 100000; ++i) driver->Advance(1.0 / 60);
  const Samples after = Read();
  for (int channel = 0; channel < kChannelCount; ++channel) {
    HandSample expected = before[channel];
    expected.time = after[channel].time;
    EXPECT_EQ(after[channel], expected);
  }
  EXPECT_NEAR(after[0].time, 100000.0 / 60, 1e-6);
}

TEST_F(MouseKeyboardTest, OnlyTheChosenChannelMoves) {
  for (const Channel chosen : {kLeftHand, kRightHand, kLaparoscope}) {
    Start(settings);
    const Samples before = Read();
    driver->Choose(chosen);
    driver->MovePointer(20, -10);
    driver->Scroll(2);
    driver->SetKey(Motion::kSpinRight, true);
    driver->SetKey(Motion::kCloseJaw, true);
    Advance(0.5, 30);
    const Samples after = Read();
    for (const Channel channel : {kLeftHand, kRightHand, kLaparoscope}) {
      EXPECT_EQ(after[channel].pan != before[channel].pan, channel == chosen);
      EXPECT_EQ(after[channel].tilt != before[channel].tilt, channel == chosen);
      EXPECT_EQ(after[channel].spin != before[channel].spin, channel == chosen);
      EXPECT_EQ(after[channel].depth != before[channel].depth, channel == chosen);
      EXPECT_EQ(after[channel].jaw != before[channel].jaw, channel == chosen);
    }
  }
}

TEST_F(MouseKeyboardTest, FormerHandStopsWhereItIsWhenAnotherIsChosen) {
  driver->SetKey(Motion::kIn, true);
  driver->Scroll(3);
  Advance(0.3, 18);
  driver->SetKey(Motion::kIn, false);
  driver->Choose(kLeftHand);
  const Samples before = Read();
  Advance(1.0, 60);
  const Samples after = Read();
  EXPECT_EQ(after[kRightHand].depth, before[kRightHand].depth);
  EXPECT_EQ(after[kLeftHand].depth, before[kLeftHand].depth) << "the wheel's rest belongs to the former hand";
}

// By default the picture looks along the shaft: the tip moves by metres_per_pixel to the right and up with
// the pointer.
TEST_F(MouseKeyboardTest, TipFollowsThePointerByDefault) {
  driver->MovePointer(40, -30);
  driver->Advance(0.05);
  const HandSample hand = Read()[kRightHand];
  // tip = depth * (-sin(pan) cos(tilt), sin(tilt), ...)
  EXPECT_NEAR(-std::sin(hand.pan) * hand.depth, 40 * settings.metres_per_pixel, 2e-5);
  EXPECT_NEAR(std::sin(hand.tilt) * hand.depth, 30 * settings.metres_per_pixel, 2e-5);
  EXPECT_EQ(hand.depth, 0.15);
}

TEST_F(MouseKeyboardTest, MirrorsTheHandleAboutTheTrocar) {
  driver->SetMirrorFulcrum(true);
  driver->MovePointer(40, -30);
  driver->Advance(0.05);
  const HandSample hand = Read()[kRightHand];
  const double handle_arm = settings.shaft_length - 0.15;
  EXPECT_NEAR(hand.pan, 40 * settings.metres_per_pixel / handle_arm, 1e-12)
      << "handle to the right, tip to the left";
  EXPECT_NEAR(hand.tilt, -30 * settings.metres_per_pixel / handle_arm, 1e-12);
  driver->Scroll(1);
  Advance(2.0, 120);
  EXPECT_NEAR(Read()[kRightHand].depth, 0.15 + settings.metres_per_step, 1e-12)
      << "along the shaft nothing mirrors";
}

TEST_F(MouseKeyboardTest, LaparoscopeIsNeverMirrored) {
  driver->SetMirrorFulcrum(true);
  driver->Choose(kLaparoscope);
  driver->MovePointer(10, 0);
  driver->Advance(0.05);
  EXPECT_NEAR(Read()[kLaparoscope].pan, -10 * settings.metres_per_pixel / 0.15, 1e-12);
}

TEST_F(MouseKeyboardTest, PointerMapSaysWhereThePictureLies) {
  driver->SetPointerMap(kRightHand, {{1, 2, 3}, {-4, 5, -6}, {7, -8, 9}});
  driver->MovePointer(2, -1);  // 2 right, 1 up
  driver->Advance(0.05);
  const double p = settings.metres_per_pixel;
  const HandSample hand = Read()[kRightHand];
  EXPECT_NEAR(hand.pan, p * (2 * 1 - 4), 1e-15);
  EXPECT_NEAR(hand.tilt, p * (2 * 2 + 5), 1e-15);
  EXPECT_NEAR(hand.depth - 0.15, p * (2 * 3 - 6), 1e-15);
}

TEST_F(MouseKeyboardTest, WheelStepIsWalkedWhollyAndThenRests) {
  driver->Scroll(2.5);
  driver->Advance(settings.wheel_time);
  EXPECT_NEAR(Read()[kRightHand].depth, 0.15 + 2.5 * settings.metres_per_step * (1 - std::exp(-1.0)), 1e-12);
  Advance(2.0, 120);
  EXPECT_NEAR(Read()[kRightHand].depth, 0.15 + 2.5 * settings.metres_per_step, 1e-12);
}

TEST_F(MouseKeyboardTest, StaysWithinEveryLimit) {
  const HandLimits& limits = settings.limits[kRightHand];
  for (const Motion motion : {Motion::kRight, Motion::kUp, Motion::kIn, Motion::kOpenJaw})
    driver->SetKey(motion, true);
  Advance(20.0, 1200);
  HandSample hand = Read()[kRightHand];
  EXPECT_EQ(hand.pan, -limits.max_pan);
  EXPECT_EQ(hand.tilt, limits.max_tilt);
  EXPECT_EQ(hand.depth, limits.max_depth);
  EXPECT_EQ(hand.jaw, limits.max_jaw);
  driver->ReleaseAll();
  for (const Motion motion : {Motion::kLeft, Motion::kDown, Motion::kOut, Motion::kCloseJaw})
    driver->SetKey(motion, true);
  Advance(60.0, 3600);
  hand = Read()[kRightHand];
  EXPECT_EQ(hand.pan, limits.max_pan);
  EXPECT_EQ(hand.tilt, -limits.max_tilt);
  EXPECT_EQ(hand.depth, limits.min_depth);
  EXPECT_EQ(hand.jaw, 0.0);
}

TEST_F(MouseKeyboardTest, PointerFasterThanAHandIsCutOffAndNotSavedUp) {
  driver->MovePointer(1e6, 0);
  driver->Advance(0.01);
  const double pan = Read()[kRightHand].pan;
  EXPECT_NEAR(-pan * 0.15, settings.max_pointer_speed * 0.01, 1e-12);
  driver->Advance(0.01);
  EXPECT_EQ(Read()[kRightHand].pan, pan);
}

TEST_F(MouseKeyboardTest, StandStillOfTheWindowMakesNoJump) {
  driver->SetKey(Motion::kIn, true);
  Advance(0.5, 50);
  const double before = Read()[kRightHand].depth;
  driver->Advance(30.0);
  EXPECT_NEAR(Read()[kRightHand].depth - before, settings.tip_rate * MouseKeyboard::kLongestStep, 1e-12);
}

TEST_F(MouseKeyboardTest, NumbersThatAreNotFiniteChangeNothing) {
  const Samples before = Read();
  driver->MovePointer(kNan, 1);
  driver->MovePointer(1, std::numeric_limits<double>::infinity());
  driver->Scroll(kNan);
  driver->SetPointerMap(kRightHand, {{kNan, 0, 0}, {}, {}});
  driver->SetMetresPerPixel(kNan);
  driver->SetMetresPerPixel(-1);
  HandSample bad = before[kRightHand];
  bad.tilt = kNan;
  driver->Place(kRightHand, bad);
  driver->Advance(kNan);
  driver->Advance(-1);
  driver->SetKey(Motion::kIn, true);
  driver->Advance(kNan);
  EXPECT_EQ(Read()[kRightHand], before[kRightHand]);
  driver->MovePointer(10, 0);
  driver->SetKey(Motion::kIn, false);
  driver->Advance(0.05);
  EXPECT_NEAR(Read()[kRightHand].pan, -10 * settings.metres_per_pixel / 0.15, 1e-12)
      << "the default map still holds";
}

TEST_F(MouseKeyboardTest, PlaceClampsAndStopsTheHand) {
  driver->SetKey(Motion::kSpinRight, true);
  Advance(0.5, 30);
  driver->SetKey(Motion::kSpinRight, false);
  HandSample home;
  home.depth = 5.0;
  home.jaw = -1.0;
  driver->Place(kRightHand, home);
  Advance(0.5, 30);
  const HandSample hand = Read()[kRightHand];
  EXPECT_EQ(hand.depth, settings.limits[kRightHand].max_depth);
  EXPECT_EQ(hand.jaw, 0.0);
  EXPECT_EQ(hand.spin, 0.0);
}

TEST_F(MouseKeyboardTest, ReadSaysWhetherSomethingIsNew) {
  Samples samples;
  driver->Read(samples);
  EXPECT_EQ(driver->Read(samples), ReadStatus::kUnchanged);
  driver->Advance(0.01);
  EXPECT_EQ(driver->Read(samples), ReadStatus::kFresh);
  EXPECT_DOUBLE_EQ(samples[kRightHand].time, 0.01);
}

TEST_F(MouseKeyboardTest, MovesOnlyWhileActive) {
  driver->SetKey(Motion::kIn, true);
  ASSERT_TRUE(driver->Deactivate().ok());
  Advance(1.0, 60);
  ASSERT_TRUE(driver->Activate().ok());
  Advance(1.0, 60);
  const HandSample hand = Read()[kRightHand];
  EXPECT_EQ(hand.depth, 0.15) << "deactivation lets every key go";
  EXPECT_TRUE(hand.is_valid);
}

TEST(MouseKeyboard, RefusesSettingsThatCannotWork) {
  const auto code = [](auto change) {
    MouseKeyboardSettings settings;
    change(settings);
    MouseKeyboard driver(settings);
    const base::Status status = driver.Configure();
    return status.ok() ? base::ErrorCode::kNone : status.error().code;
  };
  using Settings = MouseKeyboardSettings;
  EXPECT_EQ(code([](Settings&) {}), base::ErrorCode::kNone);
  EXPECT_EQ(code([](Settings& s) { s.ramp_time = 0; }), base::ErrorCode::kDeviceSettings);
  EXPECT_EQ(code([](Settings& s) { s.tip_rate = kNan; }), base::ErrorCode::kDeviceSettings);
  EXPECT_EQ(code([](Settings& s) { s.metres_per_pixel = -1; }), base::ErrorCode::kDeviceSettings);
  EXPECT_EQ(code([](Settings& s) { s.limits[0].min_depth = 0.5; }), base::ErrorCode::kDeviceSettings);
  EXPECT_EQ(code([](Settings& s) { s.limits[2].max_pan = kNan; }), base::ErrorCode::kDeviceSettings);
  EXPECT_EQ(code([](Settings& s) { s.shaft_length = 0.2; }), base::ErrorCode::kDeviceSettings);
}

}  // namespace
}  // namespace trocar::device
