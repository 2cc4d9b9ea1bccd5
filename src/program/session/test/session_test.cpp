// SPDX-License-Identifier: Apache-2.0
// Whole sessions as a server without a window would hold them: devices, viewers, recordings.
#include "trocar/session/session.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <fstream>
#include <functional>
#include <thread>
#include <vector>

#include "small_scene.h"
#include "trocar/device/emulator.h"
#include "trocar/device/igtl.h"
#include "trocar/device/polhemus_tracker.h"
#include "trocar/device/tcp_port.h"
#include "trocar/files/task_file.h"
#include "trocar/record/recording_source.h"
#include "trocar/record/replay.h"

namespace trocar::session {

using instrument::kLeft;
using instrument::kRight;

namespace {

/// Emulated LIBERTY that moves both hands.
class Liberty {
 public:
  Liberty() {
    device::PolhemusEmulation emulation;
    emulation.format = device::PolhemusFormat::kLiberty;
    emulation.motion =
        device::MoveHands(*device::MakeHandsSettings(device::DefaultTracker()), device::CalcHandMotion);
    host_ = *device::EmulatorHost::MakeSerial(device::MakePolhemusEmulator(emulation));
    thread_ = std::thread([this] {
      for (const host::Stopwatch watch; !is_stopping_; device::SystemClock().Sleep(0.002))
        host_->Step(watch.Seconds());
    });
  }
  ~Liberty() {
    is_stopping_ = true;
    thread_.join();
  }
  std::string Spec() const { return "liberty:" + host_->Address(); }

 private:
  std::unique_ptr<device::EmulatorHost> host_;
  std::atomic<bool> is_stopping_{false};
  std::thread thread_;
};

/// Reads all that an OpenIGTLink server says, on a thread of its own.
class Reader {
 public:
  explicit Reader(int port) {
    auto line = device::ConnectTcp("127.0.0.1", port);
    EXPECT_TRUE(line.ok());
    thread_ = std::thread([this, line = std::move(*line)] {
      std::array<char, 65536> buffer;
      while (!is_stopping_) {
        const device::IoResult got = line->Read(buffer);
        bytes_.append(buffer.data(), got.count);
        received_ += got.count;
        if (got.count == 0) device::SystemClock().Sleep(0.001);
      }
    });
  }
  ~Reader() {
    if (thread_.joinable()) (void)Stop();
  }
  /// \return the times of the left tool's poses [s]
  std::vector<double> Stop() {
    // what is on its way
    for (std::size_t before = 1, now = 0; before != now;) {
      before = received_;
      device::SystemClock().Sleep(0.4);
      now = received_;
    }
    is_stopping_ = true;
    thread_.join();
    const auto number = [this](std::size_t at, int count) {
      std::uint64_t value = 0;
      for (int i = 0; i < count; ++i)
        value = value << 8 | static_cast<unsigned char>(bytes_[at + static_cast<std::size_t>(i)]);
      return value;
    };
    std::vector<double> times;
    for (std::size_t at = 0; at + device::kIgtlHeaderSize <= bytes_.size();
         at += device::kIgtlHeaderSize + number(at + 42, 8)) {
      const std::string type = bytes_.c_str() + at + 2, name = bytes_.c_str() + at + 14;
      organs_ += type == "POLYDATA" ? 1 : 0;
      // seconds, and 2^-32 of them
      if (type == "TRANSFORM" && name == "LeftTool")
        times.push_back(static_cast<double>(number(at + 34, 4)) +
                        std::ldexp(static_cast<double>(number(at + 38, 4)), -32));
    }
    return times;
  }
  int Organs() const { return organs_; }

 private:
  std::string bytes_;
  std::atomic<std::size_t> received_{0};
  int organs_ = 0;
  std::atomic<bool> is_stopping_{false};
  std::thread thread_;
};

class SessionTest : public scene::SmallScene {
 protected:
  simulation::Simulation MakeSimulation() {
    auto scene = SmallScene::Read();
    EXPECT_TRUE(scene.ok());
    return std::move(*simulation::Simulation::Make(std::make_shared<const scene::Scene>(std::move(*scene))));
  }
  SessionOptions Keeping() {
    SessionOptions options;
    options.keeping = AttemptKeeping{folder_ / "attempts", {}, {}, {}};
    options.keeping->description.name = (folder_ / "scene.json").string();
    options.keeping->description.player = "somebody";
    options.keeping->description.seed = SmallScene::Read()->seed;
    return options;
  }
  void Open(const SessionOptions& options) {
    auto session = Session::Open(MakeSimulation(), options);
    ASSERT_TRUE(session.ok()) << session.error().Text();
    session_ = std::move(*session);
  }
  /// Waits, for at most twenty seconds, until `claim` holds.
  static bool Eventually(const std::function<bool()>& claim) {
    for (int i = 0; i < 4000 && !claim(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    return claim();
  }
  /// \return the last tick that was made before a pause
  std::uint64_t AwaitRest() {
    std::uint64_t before = 0, now = session_->Latest().tick;
    do {
      before = now;
      device::SystemClock().Sleep(0.1);
      now = session_->Latest().tick;
    } while (before != now);
    return now;
  }
  bool RunTo(std::uint64_t tick) {
    return Eventually([&] { return session_->Latest().tick >= tick; });
  }
  static std::shared_ptr<const record::Recording> Read(const std::filesystem::path& path) {
    auto recording = record::ReadRecording(path);
    EXPECT_TRUE(recording.ok()) << recording.error().Text();
    EXPECT_TRUE(recording->ending.has_value());
    return std::make_shared<const record::Recording>(std::move(*recording));
  }
  /// Ends the session. \return what it recorded, which replays to the bit
  std::shared_ptr<const record::Recording> End() {
    const auto path = session_->Recording().value().path;
    session_.reset();
    auto replay = record::Replay::Open(std::move(*record::ReadRecording(path)), 1);
    EXPECT_TRUE(replay.ok()) << replay.error().Text();
    const auto verified = replay->Verify();
    EXPECT_TRUE(verified.ok()) << verified.error().Text();
    EXPECT_TRUE(verified->IsVerified());
    return Read(path);
  }
  std::unique_ptr<Session> session_;
};

TEST_F(SessionTest, DeviceViewersAndRecordingWithoutAWindow) {
  const Liberty liberty;
  SessionOptions options = Keeping();
  options.device = liberty.Spec();
  options.viewers.emplace();
  options.viewers->port = 0;
  options.viewers->tool_period = 1e-6;  // all that there is
  Open(options);
  Reader reader(session_->ServedPort());
  EXPECT_TRUE(session_->IsPaused());
  ASSERT_TRUE(Eventually([&] { return session_->Input().IsHeldByDevice(kLeft); })) << "also while paused";
  EXPECT_EQ(session_->Latest().tick, 0u);
  session_->SetPaused(false);
  ASSERT_TRUE(RunTo(30));
  // a press that is shorter than a tick
  const std::uint64_t pressed = session_->Input().SetPedal(kRight, Pedal::kRinse, true);
  (void)session_->Input().SetPedal(kRight, Pedal::kRinse, false);
  const auto before = session_->Input().Last().hands;
  ASSERT_TRUE(RunTo(200));
  EXPECT_NE(session_->Input().Last().hands, before) << "the device moves";
  session_->SetPaused(true);
  const std::uint64_t last = AwaitRest();
  const std::vector<double> times = reader.Stop();
  EXPECT_EQ(session_->Statistics().ticks, last);

  ASSERT_EQ(times.size(), last) << "a pose for every tick";
  for (std::size_t i = 0; i < times.size(); ++i)
    ASSERT_NEAR(times[i], static_cast<double>(i + 1) / 120, 1e-6);
  EXPECT_GE(reader.Organs(), 2);

  const auto recording = End();
  ASSERT_EQ(recording->inputs.size(), last);
  EXPECT_EQ(recording->description.player, "somebody");
  for (std::uint64_t tick = 1; tick <= last; ++tick)
    EXPECT_EQ(recording->inputs[tick - 1].controls[kRight].rinse, tick == pressed) << tick;

  // the same again from the file: a source like another
  auto simulation = MakeSimulation();
  record::RecordingSource source(recording);
  options.keeping->folder = folder_ / "again";
  {
    Runner runner(std::move(simulation), source, {.keeping = options.keeping});
    runner.SetPaused(false);
    ASSERT_TRUE(Eventually([&] { return runner.Latest().tick >= last; }));
    runner.EndAttempt();
    ASSERT_TRUE(Eventually([&] { return runner.Latest().tick >= last + 5; }));
    const auto again = Read(runner.RecordingStatus().value().path);
    ASSERT_GE(again->inputs.size(), last);
    EXPECT_TRUE(std::equal(recording->inputs.begin(), recording->inputs.end(), again->inputs.begin()));
    ASSERT_GE(recording->hashes.size(), 1u);
    for (std::size_t i = 0; i < recording->hashes.size() && recording->hashes[i].tick < last; ++i)
      EXPECT_EQ(again->hashes[i].hash, recording->hashes[i].hash);
  }
}

// A server needs no display: nothing of a window is in this process.
TEST(Session, LinksNoWindow) {
  std::ifstream maps("/proc/self/maps");
  ASSERT_TRUE(maps.good());
  for (std::string line; std::getline(maps, line);) {
    for (const char* library : {"libgtk", "libgdk", "libepoxy", "libGL.", "libOSMesa"})
      EXPECT_EQ(line.find(library), std::string::npos) << line;
  }
}

TEST_F(SessionTest, AHapticDeviceHoldsItsHandsTickByTick) {
  SessionOptions options = Keeping();
  options.haptics = "simulated";
  Open(options);
  session_->SetPaused(false);
  ASSERT_TRUE(RunTo(20));
  (void)session_->Input().MoveHand(device::kLeftHand, {0.7, 0, 0, 0.1, 0});  // a mouse that nobody asks
  ASSERT_TRUE(RunTo(200));
  EXPECT_TRUE(session_->Input().IsHeldByDevice(kLeft) && session_->Input().IsHeldByDevice(kRight));
  ASSERT_NE(session_->Haptics(), nullptr);
  EXPECT_GT(session_->Haptics()->Latest().ticks, 500u);
  EXPECT_GT(session_->GetHapticRecord().SampleCount(), 5u);
  const auto recording = End();
  int moved = 0;
  for (std::size_t i = 21; i < recording->inputs.size(); ++i) {
    EXPECT_NE(recording->inputs[i].hands[kLeft].pan, 0.7);
    moved += recording->inputs[i].hands != recording->inputs[i - 1].hands ? 1 : 0;
  }
  EXPECT_GT(moved, 100) << "in most of the ticks, not once a frame";
}

TEST_F(SessionTest, ADemonstrationIsRecordedAsOneAndTakenOverWithoutAJump) {
  Open(Keeping());
  ASSERT_TRUE(session_->CanDemonstrate());
  session_->SetPaused(false);
  ASSERT_TRUE(RunTo(140));
  session_->BeginDemonstration();
  ASSERT_TRUE(Eventually([&] { return session_->Latest().tick < 130; }));
  ASSERT_TRUE(Eventually([&] { return session_->IsDemonstrationOver(); }));
  EXPECT_GE(session_->Latest().time, 1.2 - 0.01);
  session_->EndDemonstration();
  const std::uint64_t tick = session_->Latest().tick;
  ASSERT_TRUE(RunTo(tick + 20));
  const auto recording = End();
  EXPECT_EQ(recording->description.player, "the demonstration");
  EXPECT_EQ(recording->FirstTick(), 0u);
  for (std::size_t i = 1; i < recording->inputs.size(); ++i) {
    for (const instrument::Hand hand : {kLeft, kRight})
      EXPECT_NEAR(recording->inputs[i].hands[hand].pan, recording->inputs[i - 1].hands[hand].pan, 0.05) << i;
  }
}

TEST_F(SessionTest, AnExpertGoesOnWhereSomebodyIs) {
  auto scene = files::ReadTask(*files::FindTask("instrument_navigation"));
  ASSERT_TRUE(scene.ok());
  auto simulation = simulation::Simulation::Make(std::make_shared<const scene::Scene>(std::move(*scene)));
  ASSERT_TRUE(simulation.ok());
  auto session = Session::Open(std::move(*simulation));
  ASSERT_TRUE(session.ok()) << session.error().Text();
  session_ = std::move(*session);
  session_->SetPaused(false);
  ASSERT_TRUE(RunTo(30));
  const scene::Input home = session_->Input().Last();
  session_->Demonstrate();
  ASSERT_TRUE(Eventually([&] {
    const scene::Input now = session_->Input().Last();
    return std::abs(now.hands[kRight].pan - home.hands[kRight].pan) +
               std::abs(now.hands[kLeft].pan - home.hands[kLeft].pan) >
           0.02;
  }));
  EXPECT_GE(session_->Latest().tick, 30u) << "not from the beginning";
}

/// Lost as soon as the test says so.
struct LosingDevice : device::Driver {
  explicit LosingDevice(const std::atomic<bool>& is_lost)
      : Driver("losing", device::kChannelCount), lost(is_lost) {}
  base::Status DoConfigure() override { return {}; }
  base::Status DoActivate() override { return {}; }
  void DoDeactivate() noexcept override {}
  void DoCleanup() noexcept override {}
  device::ReadStatus DoRead(std::span<device::HandSample> samples) noexcept override {
    if (lost) return device::ReadStatus::kLost;
    samples[0] = {0.2, 0, 0, 0.12, 1.0, 0, true};
    return device::ReadStatus::kFresh;
  }
  const std::atomic<bool>& lost;
};

TEST_F(SessionTest, ALostDevicePausesWithoutAnybodyLooking) {
  Open({});
  std::atomic<bool> is_lost{false};
  session_->UseDevice(std::make_unique<LosingDevice>(is_lost));
  session_->SetPaused(false);
  ASSERT_TRUE(RunTo(20));
  (void)session_->Input().SetPedal(kRight, Pedal::kCoagulate, true);
  is_lost = true;
  ASSERT_TRUE(Eventually([&] { return session_->IsPaused(); }));
  EXPECT_FALSE(session_->Input().Standing().controls[kRight].coagulate);
  EXPECT_GE(session_->Input().DeviceLosses(), 1u);
  const std::uint64_t tick = AwaitRest();
  device::SystemClock().Sleep(0.1);
  EXPECT_EQ(session_->Latest().tick, tick);
}

TEST_F(SessionTest, SaysWhatCannotBeOpened) {
  SessionOptions options;
  options.device = "telepathy";
  EXPECT_EQ(Session::Open(MakeSimulation(), options).error().code, base::ErrorCode::kUsage);
  options = {};
  options.haptics = "telepathy";
  EXPECT_EQ(Session::Open(MakeSimulation(), options).error().code, base::ErrorCode::kDeviceSettings);
  options = {};
  options.viewers.emplace().port = 0;
  Open(options);
  options.viewers->port = session_->ServedPort();
  EXPECT_EQ(Session::Open(MakeSimulation(), options).error().code, base::ErrorCode::kDeviceBusy);
}

TEST_F(SessionTest, APauseLiftsPedals) {
  Open({});
  session_->SetPaused(false);
  ASSERT_TRUE(RunTo(5));
  (void)session_->Input().SetPedal(kLeft, Pedal::kCut, true);
  session_->SetPaused(true);
  EXPECT_FALSE(session_->Input().Standing().controls[kLeft].cut);
}

}  // namespace
}  // namespace trocar::session
