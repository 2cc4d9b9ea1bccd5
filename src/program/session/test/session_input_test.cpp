// SPDX-License-Identifier: Apache-2.0
#include "trocar/session/session_input.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <map>
#include <thread>
#include <vector>

#include "trocar/record/input_codec.h"

namespace trocar::session {
namespace {

using device::HandAct;
using instrument::Hand;
using instrument::kLeft;
using instrument::kRight;
using instrument::TrocarJoints;
using scene::AssistantCommand;
using scene::HandControls;
using scene::Input;

scene::Scene MakeScene() {
  scene::Scene scene;
  scene.instruments[kLeft].tray.resize(3);
  scene.instruments[kRight].tray.resize(5);
  scene.instruments[kLeft].home = {0.1, 0.2, 0.3, 0.15, 0.5};
  scene.instruments[kRight].home = {-0.1, 0.2, 0.3, 0.15, 0.5};
  scene.laparoscope.home = {0, 0.1, 0, 0.05, 0};
  return scene;
}

/// Says what the test sets; tells when it ends.
struct FakeDevice : HandDevice {
  explicit FakeDevice(DeviceReport& shared, bool* ended = nullptr) : report(shared), has_ended(ended) {}
  ~FakeDevice() override {
    if (has_ended != nullptr) *has_ended = true;
  }
  const DeviceReport& Look(double /*time*/) override { return report; }
  DeviceReport& report;
  bool* has_ended;
};

/// Gives one input, and counts.
struct FakeGuide : simulation::InputSource {
  Input For(std::uint64_t /*tick*/, const simulation::Snapshot& /*before*/) override {
    ++asked;
    return input;
  }
  void Reset() override { ++resets; }
  bool IsAtEnd() const override { return is_at_end; }
  Input input;
  int asked = 0, resets = 0;
  bool is_at_end = false;
};

class SessionInputTest : public testing::Test {
 protected:
  /// Input of the next tick.
  const Input& Tick() {
    now_ = input_.For(before_.tick + 1, before_);
    ++before_.tick;
    before_.time += 1.0 / 120;
    input_.AfterTick(before_);
    return now_;
  }
  void See(Hand hand, const TrocarJoints& joints) {
    report_.samples[hand] = {joints.pan, joints.tilt, joints.spin, joints.depth, joints.jaw, 0, true};
  }
  void Press(Hand hand, HandAct act) { ++report_.acts[hand].presses[static_cast<std::size_t>(act)]; }
  void Hold(Hand hand, HandAct act, bool is_held = true) {
    report_.acts[hand].is_held[static_cast<std::size_t>(act)] = is_held;
  }
  void Reset() {
    input_.Reset();
    before_ = {};
  }

  const scene::Scene scene_ = MakeScene();
  SessionInput input_{scene_, 1, false};
  simulation::Snapshot before_;
  Input now_;
  DeviceReport report_;
  HapticLink link_;
};

TEST_F(SessionInputTest, BeginsAtHomeWithTheScenesSettings) {
  EXPECT_EQ(Tick().hands[kLeft], scene_.instruments[kLeft].home);
  EXPECT_EQ(now_.hands[kRight], scene_.instruments[kRight].home);
  EXPECT_EQ(now_.laparoscope, scene_.laparoscope.home);
  EXPECT_EQ(now_.settings, scene_.settings);
  EXPECT_EQ(now_.controls, decltype(now_.controls){});
}

// "press at t, seen in tick n": n is what the request answers, and a press shorter than a tick is not lost
TEST_F(SessionInputTest, ARequestTakesEffectInTheTickThatItNames) {
  for (int i = 0; i < 7; ++i) Tick();
  EXPECT_EQ(input_.SetPedal(kRight, Pedal::kCoagulate, true), 8u);
  EXPECT_EQ(input_.SetPedal(kRight, Pedal::kCoagulate, false), 8u);
  EXPECT_TRUE(Tick().controls[kRight].coagulate);
  EXPECT_EQ(before_.tick, 8u);
  EXPECT_FALSE(Tick().controls[kRight].coagulate);
  EXPECT_EQ(input_.SetPedal(kLeft, Pedal::kCut, true), 10u);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(Tick().controls[kLeft], (HandControls{.cut = true})) << "it is held";
  EXPECT_EQ(input_.SetPedal(kLeft, Pedal::kCut, false), 13u);
  EXPECT_EQ(Tick().controls[kLeft], HandControls{});
  const TrocarJoints there{0.3, 0.2, 0.1, 0.1, 0};
  EXPECT_EQ(input_.MoveHand(device::kLeftHand, there), 14u);
  EXPECT_NE(now_.hands[kLeft], there);
  EXPECT_EQ(Tick().hands[kLeft], there);
  EXPECT_EQ(input_.MoveHand(device::kLaparoscope, there), 15u);
  EXPECT_EQ(Tick().laparoscope, there);
}

TEST_F(SessionInputTest, EachPedalIsItsOwn) {
  const struct {
    Pedal pedal;
    bool HandControls::*field;
  } pedals[] = {{Pedal::kCut, &HandControls::cut},
                {Pedal::kCoagulate, &HandControls::coagulate},
                {Pedal::kRinse, &HandControls::rinse},
                {Pedal::kAspirate, &HandControls::aspirate}};
  for (const auto& one : pedals) {
    input_.SetPedal(kRight, one.pedal, true);
    HandControls wanted;
    wanted.*one.field = true;
    EXPECT_EQ(Tick().controls[kRight], wanted);
    EXPECT_EQ(now_.controls[kLeft], HandControls{});
    input_.ReleasePedals();
    EXPECT_EQ(Tick().controls[kRight], HandControls{});
  }
  input_.SetPedal(kRight, Pedal::kCut, true);
  input_.ReleasePedals();
  EXPECT_EQ(Tick().controls[kRight], HandControls{}) << "that press does not count";
}

TEST_F(SessionInputTest, ToolsGoRoundTheTray) {
  input_.ChooseTool(kLeft, 2);
  input_.ChooseTool(kLeft, 3);
  EXPECT_EQ(Tick().controls[kLeft].tool, 2) << "no such place";
  input_.StepTool(kLeft, 1);
  EXPECT_EQ(Tick().controls[kLeft].tool, 0);
  input_.StepTool(kLeft, -4);
  EXPECT_EQ(Tick().controls[kLeft].tool, 2);
}

// Whatever two threads do: the tick that a press was promised is the tick that has it.
TEST_F(SessionInputTest, EveryPressIsInItsTickWhateverTheThreadsDo) {
  std::vector<Input> ticks{{}};  // there is no tick 0
  std::atomic<bool> is_over{false};
  std::thread simulation([&] {
    while (!is_over.load()) ticks.push_back(Tick());
    ticks.push_back(Tick());
  });
  std::map<std::uint64_t, int> promised;
  for (int press = 0; press < 2000; ++press) {
    const std::uint64_t tick = input_.SetPedal(kRight, Pedal::kRinse, true);
    ++promised[tick];
    // let go at once: mostly before that tick
    (void)input_.SetPedal(kRight, Pedal::kRinse, false);
    if (press % 50 == 0) std::this_thread::yield();
  }
  is_over.store(true);
  simulation.join();
  for (const auto& [tick, count] : promised) {
    ASSERT_LT(tick, ticks.size());
    EXPECT_TRUE(ticks[tick].controls[kRight].rinse) << tick;
  }
}

TEST_F(SessionInputTest, ADeviceHoldsTheHandsItSeesAndThePersonTheOthers) {
  input_.UseDevice(std::make_unique<FakeDevice>(report_));
  const TrocarJoints device{0.4, 0.1, 0, 0.12, 0.2}, mouse{-0.3, 0, 0, 0.1, 0};
  See(kLeft, device);
  input_.MoveHand(device::kLeftHand, mouse);
  input_.MoveHand(device::kRightHand, mouse);
  EXPECT_EQ(Tick().hands[kLeft], device);
  EXPECT_EQ(now_.hands[kRight], mouse);
  EXPECT_TRUE(input_.IsHeldByDevice(kLeft));
  EXPECT_FALSE(input_.IsHeldByDevice(kRight));
  report_.samples[kLeft].is_valid = false;
  EXPECT_EQ(Tick().hands[kLeft], device) << "the hand stays where it was last seen";
  EXPECT_FALSE(input_.IsHeldByDevice(kLeft));
  input_.MoveHand(device::kLeftHand, mouse);
  EXPECT_EQ(Tick().hands[kLeft], mouse);
}

TEST_F(SessionInputTest, ADevicesPressesCountOnceAndChangeWhatThePersonSees) {
  input_.UseDevice(std::make_unique<FakeDevice>(report_));
  input_.SetPedal(kLeft, Pedal::kRinse, true);
  Press(kLeft, HandAct::kNextTool);
  Press(kRight, HandAct::kAssistant);
  Hold(kLeft, HandAct::kCut);
  for (int tick = 0; tick < 3; ++tick) {
    EXPECT_EQ(Tick().controls[kLeft], (HandControls{.tool = 1, .cut = true, .rinse = true}));
    EXPECT_EQ(now_.assistant, AssistantCommand::kRetract);
  }
  EXPECT_EQ(input_.Standing().controls[kLeft], (HandControls{.tool = 1, .rinse = true}))
      << "the device's pedal is no request of the person's";
  Hold(kLeft, HandAct::kCut, false);
  EXPECT_FALSE(Tick().controls[kLeft].cut);
  input_.StepTool(kLeft, 1);
  EXPECT_EQ(Tick().controls[kLeft].tool, 2) << "from where the device left it";
}

TEST_F(SessionInputTest, WhilePausedDevicesMoveHandsAndTheirPressesAreForgotten) {
  input_.UseDevice(std::make_unique<FakeDevice>(report_));
  const TrocarJoints device{0.4, 0.1, 0, 0.12, 0.2};
  See(kLeft, device);
  Press(kLeft, HandAct::kNextTool);
  Hold(kLeft, HandAct::kCut);
  input_.Wait(before_);
  EXPECT_EQ(input_.Last().hands[kLeft], device);
  EXPECT_EQ(input_.Last().controls[kLeft], HandControls{});
  EXPECT_EQ(Tick().controls[kLeft], (HandControls{.cut = true}))
      << "held is held; that press was for nothing";
}

TEST_F(SessionInputTest, ALostDeviceLetsGoOfEveryPedalAndSaysSo) {
  int losses = 0;
  input_.OnDeviceLoss([&] { ++losses; });
  input_.UseDevice(std::make_unique<FakeDevice>(report_));
  input_.SetPedal(kRight, Pedal::kCoagulate, true);
  report_.message = "it is connected";
  Tick();
  EXPECT_EQ(input_.TakeDeviceMessage(), "it is connected");
  EXPECT_EQ(input_.TakeDeviceMessage(), "") << "once";
  EXPECT_EQ(losses, 0);
  report_.losses = 1;
  report_.message = "it was lost";
  EXPECT_EQ(Tick().controls[kRight], HandControls{});
  EXPECT_EQ(losses, 1);
  EXPECT_EQ(input_.DeviceLosses(), 1u);
  Tick();
  EXPECT_EQ(losses, 1);
  EXPECT_EQ(input_.TakeDeviceMessage(), "it was lost");
}

TEST_F(SessionInputTest, OneDeviceEndsBeforeTheOtherIsUsed) {
  bool has_ended = false;
  input_.UseDevice(std::make_unique<FakeDevice>(report_, &has_ended));
  Press(kLeft, HandAct::kNextTool);
  EXPECT_EQ(Tick().controls[kLeft].tool, 1);
  input_.ToggleFreeze(kLeft);
  input_.DropDevice();
  EXPECT_TRUE(has_ended);
  Tick();
  DeviceReport other;
  input_.UseDevice(std::make_unique<FakeDevice>(other));
  other.samples[kLeft] = {0.4, 0.1, 0, 0.12, 0.2, 0, true};
  EXPECT_EQ(Tick().hands[kLeft].pan, 0.4) << "nothing of the first one's freeze is left";
  EXPECT_EQ(now_.controls[kLeft].tool, 1);
}

TEST_F(SessionInputTest, AHapticHandComesBeforeADevices) {
  input_.UseDevice(std::make_unique<FakeDevice>(report_));
  input_.UseHaptics(link_);
  See(kLeft, {0.4, 0.1, 0, 0.12, 0.2});
  See(kRight, {0.5, 0.1, 0, 0.12, 0.2});
  HapticHands& hands = link_.hands.Back();
  hands.is_driven[kRight] = true;
  hands.joints[kRight] = {0.7, 0, 0, 0.1, 0};
  hands.acts[kRight].is_held[static_cast<std::size_t>(HandAct::kCoagulate)] = true;
  hands.acts[kRight].presses[static_cast<std::size_t>(HandAct::kPreviousTool)] = 1;
  link_.hands.Publish();
  EXPECT_EQ(Tick().hands[kRight].pan, 0.5) << "no loop runs";
  link_.is_used = true;
  EXPECT_EQ(Tick().hands[kRight].pan, 0.7);
  EXPECT_EQ(now_.hands[kLeft].pan, 0.4);
  EXPECT_EQ(now_.controls[kRight], (HandControls{.tool = 4, .coagulate = true}));
  EXPECT_TRUE(input_.IsHeldByDevice(kRight));
  for (int tick = 0; tick < HapticHandsReader::kLongestSilence + 1; ++tick) Tick();
  EXPECT_EQ(now_.controls[kRight], (HandControls{.tool = 4})) << "a loop that stands still burns nothing";
  EXPECT_EQ(now_.hands[kRight].pan, 0.7);
}

TEST_F(SessionInputTest, ADemonstrationMovesTheHandsAndIsTakenOverWhereTheyAre) {
  const auto guide = std::make_shared<FakeGuide>();
  guide->input.hands[kLeft] = {0.9, 0, 0, 0.1, 0};
  guide->input.controls[kLeft] = {.tool = 2, .cut = true};
  guide->input.laparoscope = {0.2, 0, 0, 0.06, 0};
  guide->input.assistant = AssistantCommand::kRelax;
  guide->input.settings.gravity = 1;
  input_.UseDevice(std::make_unique<FakeDevice>(report_));
  See(kLeft, {0.4, 0.1, 0, 0.12, 0.2});
  Hold(kLeft, HandAct::kCoagulate);
  for (const bool is_hands_only : {true, false}) {
    input_.SetGuide({.source = guide, .is_hands_only = is_hands_only});
    const Input before = input_.Standing();
    before_.instruments[kLeft].joints = {0.8, 0, 0, 0.1, 0};
    before_.operation.tools[kLeft] = 1;
    before_.laparoscope = {0.15, 0, 0, 0.06, 0};
    Tick();
    EXPECT_EQ(Tick().hands, guide->input.hands);
    EXPECT_TRUE(input_.IsDemonstration());
    EXPECT_FALSE(now_.controls[kLeft].coagulate) << "nothing of a device counts";
    EXPECT_EQ(now_.settings, before.settings) << "the settings stay the person's";
    if (is_hands_only) {
      EXPECT_EQ(now_.controls[kLeft], (HandControls{.tool = 1}));
      EXPECT_EQ(now_.laparoscope, before.laparoscope);
    } else {
      EXPECT_EQ(now_.controls, guide->input.controls);
      EXPECT_EQ(now_.laparoscope, guide->input.laparoscope);
      EXPECT_EQ(now_.assistant, AssistantCommand::kRelax);
    }
    const Input standing = input_.Standing();
    EXPECT_EQ(standing.hands[kLeft], before_.instruments[kLeft].joints);
    EXPECT_EQ(standing.controls[kLeft].tool, 1);
    EXPECT_EQ(standing.laparoscope, is_hands_only ? before.laparoscope : before_.laparoscope);
  }
  EXPECT_FALSE(input_.IsGuideOver());
  guide->is_at_end = true;
  Tick();
  EXPECT_TRUE(input_.IsGuideOver());
  report_.samples[kLeft].is_valid = false;
  input_.SetGuide({});
  EXPECT_EQ(Tick().hands[kLeft], before_.instruments[kLeft].joints);
  EXPECT_FALSE(input_.IsDemonstration());
  EXPECT_FALSE(input_.IsGuideOver());
}

// The person takes over while a tick is being made.
TEST_F(SessionInputTest, ADemonstrationIsTakenOverAfterTheTickUnderWay) {
  const auto guide = std::make_shared<FakeGuide>();
  for (const bool is_hands_only : {true, false}) {
    input_.SetGuide({.source = guide, .is_hands_only = is_hands_only});
    Tick();
    (void)input_.For(before_.tick + 1, before_);
    input_.SetGuide({});
    before_.instruments[kRight].joints.pan += 0.25;
    before_.operation.tools[kRight] += 1;
    ++before_.tick;
    input_.AfterTick(before_);
    EXPECT_EQ(Tick().hands[kRight], before_.instruments[kRight].joints);
    EXPECT_EQ(now_.controls[kRight].tool, before_.operation.tools[kRight]);
    input_.ChooseTool(kRight, 4);
    EXPECT_EQ(Tick().controls[kRight].tool, 4) << "from then on the person's requests count";
  }
}

// runs without a window: a script, and devices that keep what they hold
TEST_F(SessionInputTest, AGuideThatYieldsLeavesDevicesTheirHands) {
  const auto guide = std::make_shared<FakeGuide>();
  guide->input.hands[kLeft] = {0.9, 0, 0, 0.1, 0};
  guide->input.hands[kRight] = {0.8, 0, 0, 0.1, 0};
  input_.SetGuide({.source = guide, .is_hands_only = true, .yields_to_devices = true});
  input_.UseDevice(std::make_unique<FakeDevice>(report_));
  See(kLeft, {0.4, 0.1, 0, 0.12, 0.2});
  Hold(kLeft, HandAct::kCut);
  EXPECT_EQ(Tick().hands[kLeft].pan, 0.4);
  EXPECT_EQ(now_.hands[kRight].pan, 0.8);
  EXPECT_TRUE(now_.controls[kLeft].cut);
  EXPECT_FALSE(input_.IsDemonstration()) << "it is felt";
}

TEST_F(SessionInputTest, TheHoldersLaparoscopeIsTakenOverWhereItIs) {
  scene::LiveSettings settings = scene_.settings;
  settings.holds_camera = true;
  input_.SetSettings(settings);
  before_.laparoscope = {0.3, 0.1, 0, 0.06, 0};
  Tick();
  EXPECT_EQ(input_.Standing().laparoscope, before_.laparoscope);
  before_.laparoscope.pan = 0.4;
  input_.Wait(before_);
  settings.holds_camera = false;
  input_.SetSettings(settings);
  EXPECT_EQ(Tick().laparoscope.pan, 0.4) << "also from a pause";
}

// What is asked for after a reset is of the new attempt: ticks that are still made of the old one do not have it.
TEST_F(SessionInputTest, AResetPartsTheAttempts) {
  const auto guide = std::make_shared<FakeGuide>();
  scene::LiveSettings settings = scene_.settings;
  settings.gravity = 3;
  input_.SetSettings(settings);
  input_.MoveHand(device::kRightHand, {0.5, 0, 0, 0.1, 0});
  input_.SetPedal(kRight, Pedal::kRinse, true);
  const Input former = Tick();
  EXPECT_EQ(input_.BeginAnew(), 1u);
  input_.SetGuide({.source = guide});
  EXPECT_EQ(input_.SetPedal(kLeft, Pedal::kCut, true), 1u);
  EXPECT_EQ(input_.SetPedal(kLeft, Pedal::kCut, false), 1u);
  EXPECT_EQ(Tick(), former);
  EXPECT_EQ(Tick(), former);
  EXPECT_EQ(guide->asked, 0) << "it does not begin with the old one's state";
  EXPECT_EQ(input_.ChooseTool(kRight, 1), 1u);
  Reset();
  EXPECT_EQ(guide->resets, 1);
  input_.SetGuide({});
  EXPECT_EQ(Tick().hands[kRight], scene_.instruments[kRight].home);
  EXPECT_EQ(now_.controls[kRight], (HandControls{.tool = 1}));
  EXPECT_EQ(now_.controls[kLeft], (HandControls{.cut = true}));
  EXPECT_EQ(now_.settings.gravity, 3) << "settings stay";
  EXPECT_EQ(input_.ReleasePedals(), 2u);
}

TEST_F(SessionInputTest, TwoResetsAreTwo) {
  Tick();
  input_.BeginAnew();
  input_.BeginAnew();
  input_.MoveHand(device::kRightHand, {0.5, 0, 0, 0.1, 0});
  Reset();
  EXPECT_NE(Tick().hands[kRight].pan, 0.5) << "another reset follows";
  Reset();
  EXPECT_EQ(Tick().hands[kRight].pan, 0.5);
}

TEST_F(SessionInputTest, RoundsJointsForTheRecordingOnly) {
  SessionInput rounding(scene_, 1, true);
  const TrocarJoints fine{1.0 / 3, 0, 0, 0.1, 0};
  for (SessionInput* input : {&rounding, &input_}) input->MoveHand(device::kLeftHand, fine);
  Input wanted = Tick();
  EXPECT_EQ(wanted.hands[kLeft], fine);
  record::RoundJoints(wanted);
  EXPECT_EQ(rounding.For(1, {}), wanted);
  EXPECT_EQ(rounding.Standing().hands[kLeft], fine);
}

TEST_F(SessionInputTest, GoesOnFromTheMiddleOfAnAttempt) {
  SessionInput later(scene_, 181, false);
  Input last;
  last.hands[kLeft].pan = 0.3;
  last.controls[kLeft].tool = 2;
  last.assistant = AssistantCommand::kRetract;
  EXPECT_EQ(later.GoOnFrom(last), 181u);
  before_.tick = 180;
  EXPECT_EQ(later.For(181, before_), last);
}

}  // namespace
}  // namespace trocar::session
