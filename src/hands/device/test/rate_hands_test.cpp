// SPDX-License-Identifier: Apache-2.0
#include "trocar/device/rate_hands.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#if TROCAR_HAS_SDL2
#include <SDL.h>
#endif

namespace trocar::device {
namespace {

using base::ErrorCode;
using HandSamples = std::array<HandSample, kChannelCount>;

struct FakePad : GamepadSource {
  explicit FakePad(GamepadState& shared, bool& gone) : state(shared), is_gone(gone) {}
  base::Status Open() override { return {}; }
  bool Poll(GamepadState& out) noexcept override {
    out = state;
    return !is_gone;
  }
  void Close() noexcept override {}
  GamepadState& state;
  bool& is_gone;
};

class GamepadTest : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(pad_.Configure().ok());
    ASSERT_TRUE(pad_.Activate().ok());
    Hold(0);
  }
  /// Holds the sticks for so long.
  void Hold(double seconds) {
    for (double t = 0; t < seconds - 1e-9; t += 0.01) {
      clock_.Sleep(0.01);
      status_ = pad_.Read(samples_);
    }
    if (seconds == 0) status_ = pad_.Read(samples_);
  }
  GamepadState state_;
  bool is_gone_ = false;
  ManualClock clock_;
  Gamepad pad_{std::make_unique<FakePad>(state_, is_gone_), clock_};
  HandSamples samples_;
  ReadStatus status_ = ReadStatus::kUnchanged;
};

TEST_F(GamepadTest, SticksMoveTheirHandsAndRestInTheMiddle) {
  state_.sides[0].x = 0.1;  // within the dead zone
  state_.sides[1].x = 1;
  state_.sides[1].y = -1;
  const HandSample left = samples_[kLeftHand], right = samples_[kRightHand];
  Hold(0.5);
  EXPECT_EQ(samples_[kLeftHand].pan, left.pan);
  EXPECT_NEAR(samples_[kRightHand].pan, right.pan - 0.35, 1e-9) << "right turns -pan";
  EXPECT_NEAR(samples_[kRightHand].tilt, right.tilt + 0.35, 1e-9) << "up turns +tilt";
  EXPECT_TRUE(samples_[kRightHand].is_valid);
  EXPECT_FALSE(samples_[kLaparoscope].is_valid);
}

TEST_F(GamepadTest, ShoulderTurnsTheStickIntoDepthAndSpin) {
  state_.sides[0] = {1, -1, 0, true};
  const HandSample before = samples_[kLeftHand];
  Hold(0.5);
  EXPECT_NEAR(samples_[kLeftHand].depth, before.depth + 0.03, 1e-9);
  EXPECT_NEAR(samples_[kLeftHand].spin, before.spin + 1.25, 1e-9);
  EXPECT_EQ(samples_[kLeftHand].pan, before.pan);
  Hold(100);
  EXPECT_EQ(samples_[kLeftHand].depth, HandLimits{}.max_depth);
}

TEST_F(GamepadTest, ButtonsAreTheirHandsAndGoneWithTheGamepad) {
  state_.sides[0].buttons = 2;
  state_.sides[1].buttons = 33;
  Hold(0.02);
  EXPECT_EQ(samples_[kLeftHand].buttons, 2u);
  EXPECT_EQ(samples_[kRightHand].buttons, 33u);
  is_gone_ = true;
  Hold(0.01);
  EXPECT_EQ(status_, ReadStatus::kLost);
  EXPECT_FALSE(samples_[kRightHand].is_valid) << "what HandButtons lets go of";
}

TEST_F(GamepadTest, TriggerClosesTheJaws) {
  EXPECT_EQ(samples_[kRightHand].jaw, HandLimits{}.max_jaw);
  state_.sides[1].trigger = 0.25;
  Hold(0);
  EXPECT_NEAR(samples_[kRightHand].jaw, 0.75 * HandLimits{}.max_jaw, 1e-12);
}

TEST_F(GamepadTest, StartsWhereItIsPlacedAndMakesNoJumpAfterAPause) {
  HandSample home;
  home.pan = 0.4, home.depth = 0.2;
  pad_.PlaceHand(kRightHand, home);
  home.pan = std::nan("");
  pad_.PlaceHand(kRightHand, home);
  pad_.PlaceHand(17, {});
  Hold(0);
  EXPECT_EQ(samples_[kRightHand].pan, 0.4);
  state_.sides[1].x = 1;
  clock_.Sleep(1000);
  Hold(0);
  EXPECT_NEAR(samples_[kRightHand].pan, 0.4 - 0.07, 1e-9);
}

TEST_F(GamepadTest, IsLostWithItsSource) {
  is_gone_ = true;
  Hold(0);
  EXPECT_EQ(status_, ReadStatus::kLost);
  EXPECT_FALSE(samples_[kLeftHand].is_valid);
}

TEST(DeadZone, IsContinuousAndReachesTheEnd) {
  EXPECT_EQ(WithoutDeadZone(0.12, 0.12), 0);
  EXPECT_NEAR(WithoutDeadZone(0.121, 0.12), 0, 0.002);
  EXPECT_EQ(WithoutDeadZone(-1, 0.12), -1);
  EXPECT_EQ(WithoutDeadZone(7, 0.12), 1);
  EXPECT_EQ(WithoutDeadZone(std::nan(""), 0.12), 0);
}

#if TROCAR_HAS_SDL2
// the real library, with a gamepad that it makes itself: no screen and no hardware
TEST(SdlGamepad, ReadsAVirtualGamepad) {
  ::setenv("SDL_VIDEODRIVER", "dummy", 1);
  SDL_SetHint(SDL_HINT_JOYSTICK_ALLOW_BACKGROUND_EVENTS, "1");
  ASSERT_EQ(SDL_InitSubSystem(SDL_INIT_GAMECONTROLLER), 0) << SDL_GetError();
  const int index = SDL_JoystickAttachVirtual(SDL_JOYSTICK_TYPE_GAMECONTROLLER, SDL_CONTROLLER_AXIS_MAX,
                                              SDL_CONTROLLER_BUTTON_MAX, 0);
  if (index < 0) GTEST_SKIP() << "this SDL has no virtual gamepads";
  SDL_Joystick* joystick = SDL_JoystickOpen(index);
  const auto source = MakeSdlGamepad();
  ASSERT_TRUE(source->Open().ok());
  SDL_JoystickSetVirtualAxis(joystick, SDL_CONTROLLER_AXIS_RIGHTX, 32767);
  SDL_JoystickSetVirtualAxis(joystick, SDL_CONTROLLER_AXIS_LEFTY, -16384);
  SDL_JoystickSetVirtualButton(joystick, SDL_CONTROLLER_BUTTON_LEFTSHOULDER, 1);
  SDL_JoystickSetVirtualButton(joystick, SDL_CONTROLLER_BUTTON_B, 1);
  SDL_JoystickSetVirtualButton(joystick, SDL_CONTROLLER_BUTTON_START, 1);
  SDL_JoystickSetVirtualButton(joystick, SDL_CONTROLLER_BUTTON_DPAD_DOWN, 1);
  GamepadState state;
  ASSERT_TRUE(source->Poll(state));
  EXPECT_NEAR(state.sides[1].x, 1.0, 1e-3);
  EXPECT_NEAR(state.sides[0].y, -0.5, 1e-3);
  EXPECT_TRUE(state.sides[0].is_shoulder_down);
  EXPECT_FALSE(state.sides[1].is_shoulder_down);
  EXPECT_EQ(state.sides[0].buttons, 1u);
  EXPECT_EQ(state.sides[1].buttons, 2u | 32u);
  EXPECT_FALSE(ListGamepads().empty());
  SDL_JoystickClose(joystick);
  SDL_JoystickDetachVirtual(index);
  EXPECT_FALSE(source->Poll(state)) << "pulled out";
  source->Close();
  SDL_QuitSubSystem(SDL_INIT_GAMECONTROLLER);
}
#endif

struct FakeCap : SpaceMouseSource {
  explicit FakeCap(SpaceMouseState& shared) : state(shared) {}
  base::Status Open() override { return {}; }
  bool Poll(SpaceMouseState& out) noexcept override {
    out = state;
    return true;
  }
  void Close() noexcept override {}
  SpaceMouseState& state;
};

class SpaceMouseTest : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(mouse_.Configure().ok());
    ASSERT_TRUE(mouse_.Activate().ok());
  }
  /// Reads after so long.
  void Read(double seconds = 0) {
    clock_.Sleep(seconds);
    mouse_.Read(samples_);
  }
  SpaceMouseState state_;
  ManualClock clock_;
  SpaceMouse mouse_{std::make_unique<FakeCap>(state_), clock_};
  HandSamples samples_;
};

TEST_F(SpaceMouseTest, FurtherButtonsAreThoseOfTheChosenHand) {
  state_.more_buttons = 5;
  Read();
  EXPECT_EQ(samples_[kRightHand].buttons, 5u);
  EXPECT_EQ(samples_[kLeftHand].buttons, 0u);
  state_.is_button_down[1] = true;
  Read();
  EXPECT_EQ(samples_[kRightHand].buttons, 0u) << "the pedal does not stay with the hand that was left";
  EXPECT_EQ(samples_[kLeftHand].buttons, 5u);
}

TEST_F(SpaceMouseTest, MovesTheChosenHandAndChangesHands) {
  Read();
  const HandSample right = samples_[kRightHand];
  state_.push = {350, 0, -350};  // to the right and away
  Read(0.1);
  EXPECT_NEAR(samples_[kRightHand].pan, right.pan - 0.07, 1e-9);
  EXPECT_NEAR(samples_[kRightHand].depth, right.depth + 0.006, 1e-9);
  EXPECT_EQ(samples_[kLeftHand].pan, 0);
  state_.is_button_down[1] = true;
  Read(0.1);
  EXPECT_LT(samples_[kLeftHand].pan, 0) << "changed hands, once while held";
  Read();
  state_.push = {0, 0, 0};
  state_.is_button_down = {true, false};
  const double jaw = samples_[kLeftHand].jaw;
  Read(0.05);
  EXPECT_LT(samples_[kLeftHand].jaw, jaw) << "the first button closes";
}

}  // namespace
}  // namespace trocar::device
