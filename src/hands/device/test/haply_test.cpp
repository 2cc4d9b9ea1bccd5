// SPDX-License-Identifier: Apache-2.0
#include "trocar/device/haply.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "hands/force_mailbox.h"
#include "haply/haply_messages.h"
#include "haply/web_socket.h"
#include "stand_in_gate.h"
#include "trocar/device/device_spec.h"
#include "trocar/device/emulator.h"
#include "trocar/host/clock.h"
#include "trocar/math/rotation_angle.h"
#include "wait_for.h"

namespace trocar::device {
namespace {

using base::ErrorCode;
using web_socket::Opcode;
using Verdict = Parsed::Verdict;

// golden: the example of RFC 6455, section 1.3
TEST(WebSocket, AcceptsAsTheStandardSays) {
  EXPECT_EQ(web_socket::CalcAccept("dGhlIHNhbXBsZSBub25jZQ=="), "s3pPLMBiTxaQ9kYGzzhZRbK+xOo=");
}

// golden: section 5.7
TEST(WebSocket, HasTheBytesOfTheStandard) {
  EXPECT_EQ(web_socket::FormatFrame(Opcode::kText, "Hello", 0), "\x81\x05Hello");
  EXPECT_EQ(web_socket::FormatFrame(Opcode::kText, "Hello", 0x37fa213d),
            "\x81\x85\x37\xfa\x21\x3d\x7f\x9f\x4d\x51\x58");
}

TEST(WebSocket, GivesBackWhatWasSentAndRefusesTheRest) {
  for (const std::size_t size : {0u, 1u, 125u, 126u, 127u, 5000u, 65535u}) {
    for (const std::uint32_t mask : {0u, 0x01020304u}) {
      const std::string text(size, 'q');
      const std::string bytes = web_socket::FormatFrame(Opcode::kText, text, mask);
      web_socket::Frame frame;
      const Parsed parsed = web_socket::ParseFrame(bytes + "more", mask != 0, frame);
      EXPECT_EQ(parsed.verdict, Verdict::kRecord);
      EXPECT_EQ(parsed.length, bytes.size());
      EXPECT_EQ(frame.payload, text);
      EXPECT_EQ(web_socket::ParseFrame(bytes, mask == 0, frame).verdict, Verdict::kGarbage)
          << "masks are not a matter of taste";
      for (std::size_t cut = 0; cut < std::min<std::size_t>(bytes.size(), 200); ++cut)
        EXPECT_EQ(web_socket::ParseFrame(std::string_view(bytes).substr(0, cut), mask != 0, frame).verdict,
                  Verdict::kIncomplete);
    }
  }
  web_socket::Frame frame;
  using namespace std::string_view_literals;
  for (const std::string_view bad :
       {"\x01\x05Hello"sv, "\xc1\x05Hello"sv, "\x82\x01x"sv, "\x83\x00"sv, "\x89\x7e\x01\x00"sv,
        "\x81\x7f\x7f\xff\xff\xff\xff\xff\xff\xff"sv, "\x81\x7f"sv})
    EXPECT_EQ(web_socket::ParseFrame(bad, false, frame).verdict, Verdict::kGarbage);
}

TEST(HaplyMessages, ReadsWhatTheServiceSends) {
  haply::State state;
  ASSERT_TRUE(haply::ParseState(
      R"({"inverse3":[{"device_id":"04BA","state":{"cursor_position":{"x":0.01,"y":-0.12,"z":0.2},"else":1}}],
          "wireless_verse_grip":[{"device_id":"61","state":{"orientation":{"x":0,"y":0,"z":1,"w":0},
          "buttons":{"a":true,"b":false,"c":true}}}]})",
      state));
  ASSERT_EQ(state.devices.size(), 1u);
  EXPECT_EQ(state.devices[0].id, "04BA");
  EXPECT_EQ(state.devices[0].position, (math::Vec3{0.01, 0.2, 0.12}));
  EXPECT_EQ(state.buttons, 5u);
  for (const char* bad :
       {"", "{", "[]", "{}", R"({"inverse3":{}})", R"({"inverse3":[{"device_id":"a"}]})",
        R"({"inverse3":[{"device_id":"a","state":{"cursor_position":{"x":1e999,"y":0,"z":0}}}]})",
        R"({"inverse3":[{"device_id":7,"state":{"cursor_position":{"x":0,"y":0,"z":0}}}]})"})
    EXPECT_FALSE(haply::ParseState(bad, state)) << bad;
}

// where a device cannot be, and what is no rotation, is the guard's to refuse: nothing is made good on the way
TEST(HaplyMessages, HandsOnWhatTheServiceSays) {
  const auto parse = [](const std::string& x, const std::string& grip) {
    haply::State state;
    EXPECT_TRUE(haply::ParseState(R"({"inverse3":[{"device_id":"a","state":{"cursor_position":{"x":)" + x +
                                      R"(,"y":0,"z":0}}}],"wireless_verse_grip":[{"state":{"orientation":)" +
                                      grip + "}}]}",
                                  state));
    return state;
  };
  EXPECT_EQ(parse("9", R"({"w":1,"x":0,"y":0,"z":0})").devices[0].position.x, 9.0);
  const auto length = [&](const std::string& grip) { return math::SquaredNorm(parse("0", grip).grip); };
  EXPECT_EQ(length(R"({"w":1,"x":0,"y":0,"z":0})"), 1.0);
  EXPECT_EQ(length(R"({"w":0,"x":0,"y":0,"z":0})"), 0.0);
  EXPECT_EQ(length(R"({"w":3,"x":0,"y":0,"z":0})"), 9.0);
  EXPECT_EQ(length(R"({"w":null,"x":0,"y":0,"z":0})"), 0.0) << "as a service writes what is no number";
  EXPECT_EQ(length("null"), 0.0);
}

TEST(HaplyMessages, ForcesComeBackAsTheyWere) {
  std::vector<std::string> ids;
  std::array<math::Vec3, 2> forces;
  const std::array<math::Vec3, 2> sent = {math::Vec3{0.5, -1, 1.5}, math::Vec3{0, 0, -2}};
  ASSERT_TRUE(haply::ParseForces(haply::FormatForces({"a", "b"}, sent), ids, forces));
  EXPECT_EQ(forces, sent);
  // y up is the service's z
  EXPECT_NE(haply::FormatForces({"a"}, {math::Vec3{0, 1, 0}}).find("\"z\":1.0"), std::string::npos);
}

class HaplyTest : public testing::Test {
 protected:
  void Start(std::vector<Fault> faults = {}, int devices = 2) {
    forces_ = std::make_shared<HaplyForces>();
    const auto position = [](int device, double) {
      return math::Vec3{device == 0 ? -0.05 : 0.05, 0.15, 0.02};
    };
    host_ = *EmulatorHost::MakeTcp(MakeHaplyEmulator({devices, position}, forces_), 0, std::move(faults));
    thread_ = std::thread([this] {
      for (const host::Stopwatch watch; is_running_; SystemClock().Sleep(0.0005)) {
        const std::lock_guard lock(mutex_);
        if (!is_silent_) host_->Step(watch.Seconds());
      }
    });
    const std::string address = host_->Address();
    port_ = std::stoi(address.substr(address.find(':') + 1));
    HaplySettings settings;
    settings.devices = 2;
    settings.answer_time = 1.0;
    driver_ = std::make_unique<Haply>(settings, [this] { return ConnectTcp("127.0.0.1", port_); });
  }
  void TearDown() override {
    driver_.reset();
    is_running_ = false;
    if (thread_.joinable()) thread_.join();
  }
  math::Vec3 Force(int device) {
    const std::lock_guard lock(mutex_);
    return forces_->newtons[static_cast<std::size_t>(device)];
  }
  bool Push() {
    return WaitFor([this] {
      driver_->SendForce(1, haptics::ForceGate::Make({0, 1.25, 0}));
      return Force(1) == math::Vec3{0, 1.25, 0};
    });
  }

  std::shared_ptr<HaplyForces> forces_;
  std::unique_ptr<EmulatorHost> host_;
  std::mutex mutex_;
  std::atomic<bool> is_running_{true}, is_silent_{false};
  std::thread thread_;
  int port_ = 0;
  std::unique_ptr<Haply> driver_;
};

TEST_F(HaplyTest, ReadsBothDevicesAndPushesTheOneThatIsMeant) {
  Start();
  const base::Status done = driver_->Configure();
  ASSERT_TRUE(done.ok()) << done.error().Text();
  ASSERT_TRUE(driver_->Activate().ok());
  std::array<ForceSample, 2> samples;
  ASSERT_TRUE(WaitFor([&] { return driver_->ReadForceSamples(samples) == ReadStatus::kFresh; }));
  EXPECT_NEAR(samples[0].position.x, -0.05, 1e-12);
  EXPECT_NEAR(samples[1].position.x, 0.05, 1e-12);
  EXPECT_NEAR(samples[1].position.y, 0.15, 1e-12);
  EXPECT_EQ(driver_->GetLimits(0).max_force, 2.0);
  EXPECT_TRUE(Push());
  EXPECT_EQ(Force(0), math::Vec3{});
  // nobody renews it
  EXPECT_TRUE(WaitFor([this] { return Force(1) == math::Vec3{}; }));
  EXPECT_TRUE(Push());
  ASSERT_TRUE(driver_->Deactivate().ok());
  EXPECT_TRUE(WaitFor([this] { return Force(1) == math::Vec3{}; })) << "leaves zero behind";
}

// by `trocar devices test` and in the window: as any other device, and nothing but zero is ever sent
TEST_F(HaplyTest, HoldsInstrumentsWithoutForce) {
  Start();
  const std::string port = std::to_string(port_);
  auto hands = MakeDriver("haply:2:" + port, {}, SystemClock());
  ASSERT_TRUE(hands.ok()) << hands.error().Text();
  ASSERT_EQ((*hands)->GetChannelCount(), kChannelCount);
  ASSERT_TRUE((*hands)->Configure().ok());
  ASSERT_TRUE((*hands)->Activate().ok());
  std::array<HandSample, kChannelCount> samples;
  ASSERT_TRUE(WaitFor([&] { return (*hands)->Read(samples) == ReadStatus::kFresh; }));
  EXPECT_GT(samples[kLeftHand].pan, 0.1) << "to the left";
  EXPECT_LT(samples[kRightHand].pan, -0.1);
  EXPECT_FALSE(samples[kLaparoscope].is_valid);
  {
    const std::lock_guard lock(mutex_);
    forces_->messages = 0;
  }
  ASSERT_TRUE(WaitFor([&] {
    const std::lock_guard lock(mutex_);
    EXPECT_EQ(forces_->newtons[0], math::Vec3{});
    EXPECT_EQ(forces_->newtons[1], math::Vec3{});
    return forces_->messages > 20;
  }));
  (*hands)->Finalize();
  // a single device is the right hand's
  auto one = MakeDriver("haply:1:" + port, {}, SystemClock());
  ASSERT_TRUE((*one)->Configure().ok());
  ASSERT_TRUE((*one)->Activate().ok());
  ASSERT_TRUE(WaitFor([&] { return (*one)->Read(samples) == ReadStatus::kFresh; }));
  EXPECT_TRUE(samples[kRightHand].is_valid);
  EXPECT_FALSE(samples[kLeftHand].is_valid);
  // its buttons are those of a hand with a force to come
  DeviceStore store;
  store.buttons["haptics"] = DefaultButtons();
  store.buttons["haptics"][0][0] = HandAct::kRinse;
  EXPECT_EQ(FindButtons("haply:2", store)[0][0], HandAct::kRinse);
  EXPECT_EQ(FindButtons("openhaptics:Left,Right", store)[0][0], HandAct::kRinse);
}

// between activation and the first report a device is silent; called lost, it would take the check pose back that has begun
TEST(ForceMailbox, ADeviceThatHasNotReportedYetIsNotLost) {
  ForceMailbox mailbox;
  ForceMailbox::Reports reports;
  reports[0].position = {1, 2, 3};
  reports[0].sequence = 7;
  mailbox.Report(reports);
  mailbox.Clear();
  std::array<ForceSample, 2> samples;
  EXPECT_EQ(mailbox.Read(samples), ReadStatus::kUnchanged);
  for (const ForceSample& sample : samples) {
    EXPECT_EQ(sample.status, ForceDeviceStatus::kOk);
    EXPECT_EQ(sample.sequence, 0u) << "what an earlier life reported is forgotten";
    EXPECT_FALSE(sample.is_calibrated);
  }
  mailbox.Report(reports);
  EXPECT_EQ(mailbox.Read(samples), ReadStatus::kFresh);
  EXPECT_EQ(samples[0].sequence, 7u);
}

TEST_F(HaplyTest, SupervisorsFrameIsZeroForBoth) {
  Start();
  ASSERT_TRUE(driver_->Configure().ok());
  const SupervisedWire wire = driver_->GetSupervisedWire(0);
  ASSERT_GE(wire.file, 0);
  const std::string bytes(wire.zero_frame.begin(),
                          wire.zero_frame.begin() + static_cast<std::ptrdiff_t>(wire.size));
  web_socket::Frame frame;
  ASSERT_EQ(web_socket::ParseFrame(bytes, true, frame).verdict, Verdict::kRecord);
  std::vector<std::string> ids;
  std::array<math::Vec3, 2> forces = {math::Vec3{1, 1, 1}, math::Vec3{1, 1, 1}};
  ASSERT_TRUE(haply::ParseForces(frame.payload, ids, forces));
  EXPECT_EQ(ids.size(), 2u);
  EXPECT_EQ(forces[0], math::Vec3{});
  EXPECT_EQ(forces[1], math::Vec3{});
}

TEST_F(HaplyTest, IsLostWhenTheServiceEndsOrFallsSilent) {
  Start();
  ASSERT_TRUE(driver_->Configure().ok());
  ASSERT_TRUE(driver_->Activate().ok());
  ASSERT_TRUE(Push());
  is_silent_ = true;
  std::array<ForceSample, 2> samples;
  EXPECT_TRUE(WaitFor([&] { return driver_->ReadForceSamples(samples) == ReadStatus::kLost; }));
  EXPECT_EQ(driver_->GetState(), DriverState::kUnconfigured);
  is_silent_ = false;
  EXPECT_TRUE(WaitFor([this] { return Force(1) == math::Vec3{}; })) << "what it still took in was zero";
  ASSERT_TRUE(WaitFor([this] { return driver_->Configure().ok(); })) << "and it can be had again";
  ASSERT_TRUE(driver_->Activate().ok());
  {
    const std::lock_guard lock(mutex_);
    host_->Unplug();
  }
  EXPECT_TRUE(WaitFor([&] { return driver_->ReadForceSamples(samples) == ReadStatus::kLost; }));
}

TEST_F(HaplyTest, SaysWhatIsMissing) {
  Start({}, 1);
  const base::Status one = driver_->Configure();
  ASSERT_FALSE(one.ok());
  EXPECT_EQ(one.error().code, ErrorCode::kDeviceStale);
  EXPECT_NE(one.error().message.find("fewer than 2"), std::string::npos);
  HaplySettings settings;
  EXPECT_EQ(Haply(settings, [] { return ConnectTcp("127.0.0.1", 1); }).Configure().error().code,
            ErrorCode::kDeviceLost);
}

}  // namespace
}  // namespace trocar::device
