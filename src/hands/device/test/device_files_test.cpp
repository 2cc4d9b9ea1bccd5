// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>

#include "emulated_line.h"
#include "trocar/device/device_spec.h"
#include "trocar/device/hand_recording.h"
#include "trocar/host/safe_file.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::device {

using math::Vec3;

namespace {

namespace fs = std::filesystem;
using base::ErrorCode;

class DeviceFilesTest : public testing::Test {
 protected:
  test::TemporaryFolder folder_;
};

DeviceStore MakeStore() {
  DeviceStore store;
  TrackerEntry entry = DefaultTracker();
  entry.baud = 19200;
  entry.stations = {2, 1, 3};
  entry.hands[1].p_sensor_tip = {0.31234567890123, -0.02, 0.001};
  entry.hands[1].is_measured = true;
  store.trackers["fastrak"] = entry;
  store.jaws[0] = {812, 204, 0.9};
  store.buttons["gamepad"] = DefaultButtons();
  store.buttons["gamepad"][0][7] = HandAct::kRinse;
  store.buttons["gamepad"][1].fill(HandAct::kNone);
  store.keys = {{"F13", HandAct::kCut}, {"b", HandAct::kClutch}};
  return store;
}

TEST_F(DeviceFilesTest, StoreComesBackAsItWas) {
  const fs::path path = folder_.Path() / "new/devices.json";
  ASSERT_TRUE(SaveDeviceStore(path, MakeStore()).ok());
  const LoadedStore loaded = LoadDeviceStore(path);
  EXPECT_FALSE(loaded.complaint.has_value());
  EXPECT_NEAR(loaded.store.jaws[0].max_jaw, 0.9, 1e-12);
  DeviceStore expected = MakeStore();
  expected.jaws = loaded.store.jaws;  // degrees in the file
  EXPECT_EQ(loaded.store, expected);
}

TEST_F(DeviceFilesTest, NoFileMeansDefaultsWithoutComplaint) {
  const LoadedStore loaded = LoadDeviceStore(folder_.Path() / "devices.json");
  EXPECT_FALSE(loaded.complaint.has_value());
  EXPECT_EQ(loaded.store, DeviceStore{});
  EXPECT_EQ(loaded.store.Tracker("liberty"), DefaultTracker());
}

// faults G6: every truncation and wrong field is a message, the defaults work, the file is not lost
TEST_F(DeviceFilesTest, BadFileMeansDefaultsAndAMessageAndIsSetAside) {
  const fs::path path = folder_.Path() / "devices.json";
  ASSERT_TRUE(SaveDeviceStore(path, MakeStore()).ok());
  const std::string good = *host::ReadFile(path);
  for (std::size_t length = 0; length < good.size() - 2; length += 61) {
    ASSERT_TRUE(host::WriteFile(path, good.substr(0, length)).ok());
    const LoadedStore loaded = LoadDeviceStore(path);
    ASSERT_TRUE(loaded.complaint.has_value()) << length;
    EXPECT_EQ(loaded.store, DeviceStore{});
  }
  const auto replaced = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
  };
  for (const std::string& text :
       {replaced("\"version\": 1", "\"version\": 2"), replaced("\"baud\"", "\"bud\""),
        replaced("\"gamepad\"", "\"gamepadd\""), replaced("\"rinse\"", "\"rinze\""),
        replaced("\"clutch\"\n", "7\n"), replaced("812", "4096"), replaced("0.31234567890123", "1e300"),
        replaced("0.31234567890123", "\"far\"")}) {
    ASSERT_TRUE(host::WriteFile(path, text).ok());
    EXPECT_TRUE(LoadDeviceStore(path).complaint.has_value()) << text;
  }
  ASSERT_TRUE(host::WriteFile(path, "{ my own notes").ok());
  ASSERT_TRUE(SaveDeviceStore(path, MakeStore()).ok());
  EXPECT_EQ(*host::ReadFile(path.string() + ".bad"), "{ my own notes");
  EXPECT_FALSE(LoadDeviceStore(path).complaint.has_value());
}

// what the fits refuse, the file may not bring in: the same limits, either side of each
TEST_F(DeviceFilesTest, BoundsTipAndTrocarAsTheFitsDo) {
  const fs::path path = folder_.Path() / "devices.json";
  const auto complains = [&](const std::function<void(TrackerEntry&)>& change) {
    DeviceStore store = MakeStore();
    change(store.trackers["fastrak"]);
    EXPECT_TRUE(SaveDeviceStore(path, store).ok());
    const LoadedStore loaded = LoadDeviceStore(path);
    EXPECT_TRUE(loaded.complaint || loaded.store.trackers == store.trackers);
    return loaded.complaint.has_value();
  };
  const auto tip = [](const Vec3& p) {
    return [p](TrackerEntry& entry) { entry.hands[0].p_sensor_tip = p; };
  };
  const auto trocar = [](const Vec3& p) {
    return [p](TrackerEntry& entry) { entry.hands[0].p_source_trocar = p; };
  };
  EXPECT_FALSE(complains(tip({0, -kMostTipDistance, 0})));
  EXPECT_TRUE(complains(tip({0, -1.001 * kMostTipDistance, 0})));
  EXPECT_TRUE(complains(tip({0.4, 0.4, 0.4}))) << "each number is within, the distance is not";
  EXPECT_TRUE(complains(tip({2.488e7, 0, 0}))) << "a tip 24,880 km away";
  EXPECT_FALSE(complains(trocar({0, 0, kMostTrocarDistance})));
  EXPECT_TRUE(complains(trocar({0, 0, 1.001 * kMostTrocarDistance})));
  EXPECT_FALSE(complains([](TrackerEntry& entry) { entry.stations[0] = 16; }));
  EXPECT_TRUE(complains([](TrackerEntry& entry) { entry.stations[0] = 17; }));
  EXPECT_TRUE(complains([](TrackerEntry& entry) { entry.stations[0] = -1; }));
}

TEST_F(DeviceFilesTest, AHandWithForceHasNoClutch) {
  const DeviceStore none;
  EXPECT_EQ(none.Buttons("gamepad"), DefaultButtons());
  EXPECT_EQ(none.Buttons("haptics")[0][0], HandAct::kCut);
  EXPECT_EQ(none.Buttons("haptics")[1][4], HandAct::kNone);
  const fs::path path = folder_.Path() / "devices.json";
  const auto complains = [&](const std::string& acts) {
    EXPECT_TRUE(
        host::WriteFile(path, R"({"version": 1, "buttons": {"haptics": {"left": [)" + acts + "]}}}").ok());
    return LoadDeviceStore(path).complaint.has_value();
  };
  EXPECT_FALSE(complains(R"("coagulate")"));
  EXPECT_EQ(LoadDeviceStore(path).store.Buttons("haptics")[0][0], HandAct::kCoagulate);
  EXPECT_TRUE(complains(R"("cut", "clutch")"));
  EXPECT_TRUE(complains(R"("freeze")"));
}

TEST_F(DeviceFilesTest, StoreLiesInThePersonsFolder) {
  ::setenv("TROCAR_CONFIG_DIR", folder_.Path().c_str(), 1);
  EXPECT_EQ(FindDeviceStore(), folder_.Path() / "devices.json");
  ::unsetenv("TROCAR_CONFIG_DIR");
  EXPECT_EQ(FindDeviceStore().filename(), "devices.json");
}

std::vector<HandFrame> MakeFrames() {
  std::vector<HandFrame> frames;
  for (int i = 0; i < 50; ++i) {
    HandFrame frame;
    frame.time = i / 30.0;
    frame.hands = CalcHandMotion(frame.time);
    frame.hands[kLaparoscope].is_valid = i % 2 == 0;
    frame.hands[kLeftHand].buttons = i % 3 == 0 ? 0xffffffff : static_cast<std::uint32_t>(i);
    frames.push_back(frame);
  }
  return frames;
}

TEST(HandRecording, GivesTheSameBitsBack) {
  const auto frames = MakeFrames();
  const auto read = ParseHandFrames(FormatHandFrames(frames), "test");
  ASSERT_TRUE(read.ok()) << read.error().Text();
  EXPECT_EQ(*read, frames);
}

class HandPlayerTest : public DeviceFilesTest {
 protected:
  /// Starts a player of these frames.
  void Play(const std::vector<HandFrame>& frames) {
    const fs::path path = folder_.Path() / "hands.csv";
    ASSERT_TRUE(host::WriteFile(path, FormatHandFrames(frames)).ok());
    player_ = std::make_unique<HandPlayer>(path, clock_);
  }
  static HandFrame At(double time, double pan, double depth) {
    HandFrame frame;
    frame.time = time;
    for (HandSample& hand : frame.hands) hand = {pan, 0, 0, depth, 0.5, time, true};
    return frame;
  }
  ManualClock clock_;
  std::unique_ptr<HandPlayer> player_;
  HandSamples samples_;
};

// a recording that teleports would press a tool through the liver: 600 N in one tick
TEST_F(HandPlayerTest, MovesAHandNoFasterThanAHandMoves) {
  Play({At(0, 0, 0.1), At(0.5, 1.2, 0.25), At(1.0, -1.2, 0.02)});
  HandSample home;
  home.pan = -0.5, home.depth = 0.05;
  for (int hand = 0; hand < kChannelCount; ++hand) player_->PlaceHand(hand, home);
  ASSERT_TRUE(player_->Configure().ok());
  ASSERT_TRUE(player_->Activate().ok());
  constexpr double kTick = 1.0 / 120;
  HandSample before = home;
  double fastest = 0, arrived = 0;
  for (int tick = 1; tick <= 240; ++tick) {
    clock_.Set(tick * kTick);
    ASSERT_NE(player_->Read(samples_), ReadStatus::kLost);
    const HandSample& now = samples_[kLeftHand];
    const auto tip = [](const HandSample& hand) {
      return Vec3{hand.depth * std::sin(hand.pan), 0, hand.depth * std::cos(hand.pan)};
    };
    fastest = std::max(fastest, math::Distance(tip(before), tip(now)) / kTick);
    if (arrived == 0 && now.pan == 1.2 && now.depth == 0.25) arrived = tick * kTick;
    before = now;
  }
  EXPECT_LT(fastest, 1.45 * kMaxPlaySpeed) << "depth and swing together";
  EXPECT_GT(fastest, 0.5) << "and it does move";
  EXPECT_GT(arrived, 0.55);
  EXPECT_LT(arrived, 0.75) << "0.3 m at 2 m/s";
  EXPECT_EQ(samples_[kLeftHand].pan, -1.2) << "in the end it is where the recording has it, to the bit";
  EXPECT_EQ(samples_[kLeftHand].depth, 0.02);
}

// what a hand can do passes untouched
TEST_F(HandPlayerTest, PlaysARealHandBitForBit) {
  const std::vector<HandFrame> frames = MakeFrames();
  Play(frames);
  ASSERT_TRUE(player_->Configure().ok());
  ASSERT_TRUE(player_->Activate().ok());
  for (const HandFrame& frame : frames) {
    clock_.Set(frame.time);
    player_->Read(samples_);
    for (const Channel hand : {kLeftHand, kRightHand})
      EXPECT_EQ(samples_[hand], frame.hands[hand]) << frame.time;
  }
}

TEST(HandRecording, RefusesWhatNoHandDoes) {
  std::vector<HandFrame> frames(1);
  const auto is_good = [&](const std::function<void(HandFrame&)>& change) {
    frames[0] = {};
    change(frames[0]);
    return ParseHandFrames(FormatHandFrames(frames), "x").ok();
  };
  EXPECT_TRUE(is_good([](HandFrame&) {}));
  EXPECT_TRUE(is_good([](HandFrame& frame) { frame.hands[0].depth = -0.3; })) << "outside of the body";
  for (const double far : {1.01, 1e9, 1e300}) {
    EXPECT_FALSE(is_good([&](HandFrame& frame) { frame.hands[0].depth = far; })) << far;
    EXPECT_FALSE(is_good([&](HandFrame& frame) { frame.hands[1].pan = -4 * far; })) << far;
    EXPECT_FALSE(is_good([&](HandFrame& frame) { frame.hands[1].spin = 1000 * far; })) << far;
    EXPECT_FALSE(is_good([&](HandFrame& frame) { frame.time = 1e5 * far; })) << far;
  }
  EXPECT_FALSE(is_good([](HandFrame& frame) { frame.hands[1].jaw = -0.1; }));
}

// recordings of earlier versions
TEST(HandRecording, ReadsAFileWithoutButtons) {
  const std::string old =
      "time_s,left_seen,left_pan_rad,left_tilt_rad,left_spin_rad,left_depth_m,left_jaw_rad,right_seen,right_"
      "pan_rad,"
      "right_tilt_rad,right_spin_rad,right_depth_m,right_jaw_rad,laparoscope_seen,laparoscope_pan_rad,"
      "laparoscope_tilt_rad,laparoscope_spin_rad,laparoscope_depth_m,laparoscope_jaw_rad\n"
      "0.5,1,0.1,0.2,0.3,0.15,0.5,0,0,0,0,0.1,0,1,0.4,0,0,0.12,0\n";
  const auto read = ParseHandFrames(old, "old");
  ASSERT_TRUE(read.ok()) << read.error().Text();
  EXPECT_EQ(read->front().hands[kLeftHand], (HandSample{0.1, 0.2, 0.3, 0.15, 0.5, 0.5, true}));
  EXPECT_EQ(read->front().hands[kLaparoscope].pan, 0.4);
}

TEST(HandRecording, RefusesButtonsThatAreNone) {
  std::vector<HandFrame> frames(1);
  frames[0].hands[kLaparoscope].buttons = 77;
  const std::string good = FormatHandFrames(frames);
  ASSERT_TRUE(ParseHandFrames(good, "x").ok());
  for (const char* buttons : {"-1", "0.5", "4294967296", "1e300"}) {
    std::string bad = good;
    bad.replace(bad.rfind("77"), 2, buttons);
    EXPECT_FALSE(ParseHandFrames(bad, "x").ok()) << buttons;
  }
}

TEST(HandRecording, RefusesDamageWithTheLine) {
  const std::string good = FormatHandFrames(MakeFrames());
  EXPECT_FALSE(ParseHandFrames("", "x").ok());
  EXPECT_FALSE(ParseHandFrames("time,pan\n1,2\n", "x").ok());
  EXPECT_FALSE(ParseHandFrames(good.substr(0, good.find('\n') + 1), "x").ok());
  const auto cut = ParseHandFrames(good.substr(0, good.size() - 9), "x");
  ASSERT_FALSE(cut.ok());
  EXPECT_NE(cut.error().message.find("line 51"), std::string::npos) << cut.error().message;
  std::string nan = good;
  nan.replace(good.find('\n') + 1, 1, "nan");
  EXPECT_FALSE(ParseHandFrames(nan, "x").ok());
  EXPECT_FALSE(ParseHandFrames(good + good.substr(good.find('\n') + 1), "x").ok()) << "time falls";
}

TEST_F(DeviceFilesTest, PlayerPlaysWhatWasRecorded) {
  const fs::path path = folder_.Path() / "hands.csv";
  const auto frames = MakeFrames();
  ASSERT_TRUE(host::WriteFile(path, FormatHandFrames(frames)).ok());
  ManualClock clock;
  clock.Set(100);
  auto player = MakeDriver("play:" + path.string(), {}, clock);
  ASSERT_TRUE(player.ok());
  ASSERT_TRUE((*player)->Configure().ok());
  ASSERT_TRUE((*player)->Activate().ok());
  HandSamples samples;
  for (const HandFrame& frame : frames) {
    clock.Set(100 + frame.time + 1e-6);
    EXPECT_EQ((*player)->Read(samples), ReadStatus::kFresh);
    EXPECT_EQ(samples, frame.hands);
    EXPECT_EQ((*player)->Read(samples), ReadStatus::kUnchanged);
  }
  clock.Set(1000);
  EXPECT_EQ((*player)->Read(samples), ReadStatus::kUnchanged);
  EXPECT_EQ(samples, frames.back().hands) << "the last pose is held";
}

TEST(DeviceSpec, IsTakenApart) {
  const auto spec = ParseDeviceSpec("liberty:/dev/serial/by-id/usb-x:1.0-port0,baud=9600");
  ASSERT_TRUE(spec.ok());
  EXPECT_EQ(spec->kind, "liberty");
  EXPECT_EQ(spec->address, "/dev/serial/by-id/usb-x:1.0-port0");
  EXPECT_EQ(spec->baud, 9600);
  for (const char* bad : {"", "libery:/dev/x", "liberty", "liberty:", "play", "fastrak:/dev/x,baud=fast",
                          "fastrak:/dev/x,baud=-1"}) {
    const auto refused = ParseDeviceSpec(bad);
    ASSERT_FALSE(refused.ok()) << bad;
    EXPECT_EQ(refused.error().code, ErrorCode::kUsage);
  }
}

TEST(DeviceSpec, PutsARigTogether) {
  ManualClock clock;
  const auto rig = MakeDriver("liberty:/dev/nothing+jaw:/dev/nothing_either", {}, clock);
  ASSERT_TRUE(rig.ok());
  EXPECT_EQ((*rig)->GetName(), "liberty and jaw");
  EXPECT_EQ((*rig)->Configure().error().code, ErrorCode::kDeviceLost);
  EXPECT_FALSE(MakeDriver("jaw:/dev/x+liberty:/dev/y", {}, clock).ok());
  EXPECT_FALSE(MakeDriver("liberty:/dev/x+fastrak:/dev/y", {}, clock).ok());
}

TEST(Faults, AreParsed) {
  const auto fault = ParseFault("flips=0.01@2.5+1");
  ASSERT_TRUE(fault.ok());
  EXPECT_EQ(fault->kind, FaultKind::kFlips);
  EXPECT_EQ(fault->rate, 0.01);
  EXPECT_EQ(fault->start, 2.5);
  EXPECT_EQ(fault->duration, 1.0);
  EXPECT_FALSE(fault->IsOn(2.4) || fault->IsOn(3.6));
  EXPECT_TRUE(fault->IsOn(3.0));
  for (const char* bad :
       {"", "noise", "flips=", "flips=2", "unplug@", "unplug@-1", "unplug@1x", "silence@nan"})
    EXPECT_EQ(ParseFault(bad).error().code, ErrorCode::kUsage) << bad;
}

TEST(Faults, JumpsSpoilSensorsAndCursorsAlike) {
  const std::vector<Fault> jumps = {*ParseFault("jump@1")};
  const auto cursor = SpoilCursor(jumps, [](int, double) { return Vec3{}; });
  const auto sensor = SpoilMotion(jumps, [](int, double) { return math::Pose{}; });
  int off = 0;
  for (int i = 0; i < 1000; ++i) {
    const double time = 1.0005 + 0.001 * i;
    EXPECT_EQ(cursor(0, time), sensor(0, time).translation);
    off += cursor(1, time).x > 0.04;
  }
  EXPECT_EQ(off, 100) << "one in ten";
  EXPECT_EQ(cursor(0, 0.995), Vec3{});
}

TEST(SerialPort, RefusesSpeedsAndFilesThatCannotBe) {
  const auto code = [](const std::string& path, int baud) {
    const auto opened = OpenSerialPort(path, baud);
    return opened.ok() ? ErrorCode::kNone : opened.error().code;
  };
  const auto terminal = *PseudoTerminal::Make();
  EXPECT_EQ(code(terminal->Path(), 115200), ErrorCode::kNone);
  EXPECT_EQ(code(terminal->Path(), 1200), ErrorCode::kDeviceSettings) << "resets jaw sensor boards";
  EXPECT_EQ(code(terminal->Path(), 115201), ErrorCode::kDeviceSettings);
  EXPECT_EQ(code("/dev/null", 9600), ErrorCode::kDeviceSettings);
  EXPECT_EQ(code("/dev/no_such_line", 9600), ErrorCode::kDeviceLost);
}

// faults G7
TEST(SerialPort, IsHeldByOneProgramOnly) {
  const auto terminal = *PseudoTerminal::Make();
  const auto first = OpenSerialPort(terminal->Path(), 9600);
  ASSERT_TRUE(first.ok());
  EXPECT_EQ(OpenSerialPort(terminal->Path(), 9600).error().code, ErrorCode::kDeviceBusy);
}

TEST(SerialPort, CarriesEveryByteAsItIs) {
  const auto terminal = *PseudoTerminal::Make();
  const auto port = *OpenSerialPort(terminal->Path(), 9600);
  std::string all;
  for (int i = 0; i < 256; ++i) all += static_cast<char>(i);
  std::array<char, 1000> buffer;
  EXPECT_EQ(port->Read(buffer).count, 0u);
  EXPECT_FALSE(port->Read(buffer).is_lost) << "nothing yet is not lost";
  EXPECT_EQ(terminal->Write(all).count, all.size());
  EXPECT_EQ(std::string(buffer.data(), port->Read(buffer).count), all);
  EXPECT_EQ(port->Write(all).count, all.size());
  EXPECT_EQ(std::string(buffer.data(), terminal->Read(buffer).count), all);
  terminal->Unplug();
  EXPECT_TRUE(port->Read(buffer).is_lost);
}

TEST(SerialPort, AreListedByIdFirst) {
  const test::TemporaryFolder folder;
  const fs::path& dev = folder.Path();
  fs::create_directories(dev / "serial/by-id");
  for (const char* name : {"ttyUSB0", "ttyACM0", "ttyS0", "null"})
    ASSERT_TRUE(host::WriteFile(dev / name, "").ok());
  fs::create_symlink("../../ttyUSB0", dev / "serial/by-id/usb-Polhemus_LIBERTY-if00-port0");
  const auto ports = ListSerialPorts(dev.string());
  ASSERT_EQ(ports.size(), 2u);
  EXPECT_EQ(ports[0].description, "Polhemus LIBERTY");
  EXPECT_NE(ports[0].path.find("by-id"), std::string::npos);
  EXPECT_EQ(fs::path(ports[1].path).filename(), "ttyACM0");
}

TEST(TcpPort, CarriesBytesAndNoticesTheEnd) {
  const auto listener = *TcpListener::Make(0);
  EXPECT_EQ(listener->Accept(), nullptr);
  auto near = ConnectTcp("localhost", listener->Port());
  ASSERT_TRUE(near.ok()) << near.error().Text();
  auto far = listener->Accept();
  for (int i = 0; i < 1000 && far == nullptr; ++i) far = listener->Accept();
  ASSERT_NE(far, nullptr);
  std::array<char, 16> buffer;
  EXPECT_EQ((*near)->Write("hello").count, 5u);
  IoResult got;
  for (int i = 0; i < 100'000 && got.count == 0; ++i) got = far->Read(buffer);
  EXPECT_EQ(std::string(buffer.data(), got.count), "hello");
  far.reset();
  for (int i = 0; i < 100'000 && !got.is_lost; ++i) got = (*near)->Read(buffer);
  EXPECT_TRUE(got.is_lost);
  EXPECT_EQ(ConnectTcp("localhost", 1).error().code, ErrorCode::kDeviceLost);
  EXPECT_EQ(TcpListener::Make(listener->Port()).error().code, ErrorCode::kDeviceBusy);
}

}  // namespace
}  // namespace trocar::device
