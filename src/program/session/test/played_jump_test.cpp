// SPDX-License-Identifier: Apache-2.0
// A recording that jumps by centimetres between two samples, played into the built-in patient: what the tissue pushes back with.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <vector>

#include "trocar/device/hand_recording.h"
#include "trocar/files/scene_file.h"
#include "trocar/host/safe_file.h"
#include "trocar/session/device_thread.h"
#include "trocar/session/hand_joints.h"
#include "trocar/simulation/simulation.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::session {

using instrument::kLeft;
using instrument::kRight;
using simulation::Simulation;
namespace {

namespace fs = std::filesystem;

class PlayedJump : public testing::Test {
 protected:
  void SetUp() override {
    auto read = files::ReadScene(fs::path(TROCAR_SOURCE_DIR) / "scenes/retraction.json");
    ASSERT_TRUE(read.ok()) << read.error().Text();
    scene_ = std::make_shared<const scene::Scene>(std::move(*read));
  }

  /// Largest force on a tool that a recording of 100 samples a second pushes in by `way` [m] from 0.3 s on [N].
  /// \param seconds  that the push takes; 0: from one sample to the next
  double Push(instrument::Hand hand, double way, double seconds) {
    std::vector<device::HandFrame> frames(160);
    for (std::size_t i = 0; i < frames.size(); ++i) {
      frames[i].time = 0.01 * static_cast<double>(i);
      const double since = frames[i].time - 0.3;
      device::HandSample& sample = frames[i].hands[hand];
      sample = SampleOf(scene_->instruments[hand].home);
      sample.is_valid = true;
      if (since > 0.0) sample.depth += way * (seconds > 0.0 ? std::min(1.0, since / seconds) : 1.0);
    }
    EXPECT_TRUE(host::WriteFile(path_, device::FormatHandFrames(frames)).ok());
    device::ManualClock clock;
    device::HandPlayer player(path_, clock);
    PlaceAtHome(*scene_, player);
    EXPECT_TRUE(player.Configure().ok() && player.Activate().ok());
    auto simulation = std::move(*Simulation::Make(scene_));
    scene::Input input;
    input.hands = {scene_->instruments[kLeft].home, scene_->instruments[kRight].home};
    input.laparoscope = scene_->laparoscope.home;
    input.settings = scene_->settings;
    DeviceSamples samples;
    DeviceHands hands(*scene_);
    double largest = 0;
    for (int tick = 1; tick <= 180; ++tick) {
      clock.Set(tick * scene_->tick_seconds);
      player.Read(samples);
      hands.Move(samples, {}, input);
      simulation.Step(input);
      largest = std::max(largest, math::Norm(simulation.GetSnapshot().instruments[hand].force));
    }
    return largest;
  }

  std::shared_ptr<const scene::Scene> scene_;
  test::TemporaryFolder folder_;
  const fs::path path_ = folder_.Path() / "hands.csv";
};

// 5 m/s and 8 m/s from one sample to the next: no spike beyond what the same place costs a hand that takes its time
TEST_F(PlayedJump, PressesHardlyHarderThanASlowHand) {
  const struct {
    instrument::Hand hand;
    double way;  // [m]
  } cases[] = {{kLeft, 0.050}, {kLeft, 0.080}};
  for (const auto& pushed : cases) {
    const double slow = Push(pushed.hand, pushed.way, 1.0);
    EXPECT_GT(slow, 0.3) << "it does press";
    EXPECT_LT(Push(pushed.hand, pushed.way, 0.0), 1.3 * slow) << pushed.hand << ' ' << pushed.way;
  }
}

// the right hand glances off the liver's edge: a slow push slides along it, a jump takes it along for some ticks first
TEST_F(PlayedJump, PressesOnAnEdgeNoHarderThanAHandMayPull) {
  constexpr double kMostPull = 10.0;  // N
  EXPECT_GT(Push(kRight, 0.080, 1.0), 0.3) << "it does press";
  EXPECT_LT(Push(kRight, 0.080, 0.0), kMostPull);
}

}  // namespace
}  // namespace trocar::session
