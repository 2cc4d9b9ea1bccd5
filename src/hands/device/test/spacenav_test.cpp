// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <thread>

#include "trocar/device/device_spec.h"
#include "trocar/device/emulator.h"
#include "trocar/device/rate_hands.h"

namespace trocar::device {
namespace {

#if TROCAR_HAS_SPNAV
/// Speaks spacenavd's first protocol: eight 32-bit words an event. Requests of later protocols get no answer.
class FakeDaemon {
 public:
  explicit FakeDaemon(const std::string& path) {
    listener_ = ::socket(AF_UNIX, SOCK_STREAM, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strncpy(address.sun_path, path.c_str(), sizeof address.sun_path - 1);
    ::unlink(path.c_str());
    is_good_ = ::bind(listener_, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0 &&
               ::listen(listener_, 1) == 0;
    thread_ = std::thread([this] {
      pollfd wait{listener_, POLLIN, 0};
      if (::poll(&wait, 1, 5000) == 1) caller_ = ::accept(listener_, nullptr, nullptr);
    });
  }
  ~FakeDaemon() {
    if (thread_.joinable()) thread_.join();
    HangUp();
    ::close(listener_);
  }
  bool IsGood() const { return is_good_; }
  void Send(const std::array<std::int32_t, 8>& event) {
    if (thread_.joinable()) thread_.join();
    ASSERT_EQ(::send(caller_, event.data(), sizeof event, MSG_NOSIGNAL), static_cast<ssize_t>(sizeof event));
  }
  void HangUp() {
    if (caller_ >= 0) ::close(caller_);
    caller_ = -1;
  }

 private:
  int listener_ = -1;
  std::atomic<int> caller_{-1};
  bool is_good_ = false;
  std::thread thread_;
};

// the real library against a daemon of the test's own
TEST(Spacenav, ReadsMotionAndButtonsAndNoticesTheEnd) {
  const std::string path = "/tmp/trocar_spnav_" + std::to_string(::getpid());
  ::setenv("SPNAV_SOCKET", path.c_str(), 1);
  FakeDaemon daemon(path);
  ASSERT_TRUE(daemon.IsGood());
  const auto source = MakeSpacenavSource();
  const base::Status opened = source->Open();
  std::filesystem::remove(path);
  if (!opened) GTEST_SKIP() << "this libspnav asks no SPNAV_SOCKET: " << opened.error().Text();
  daemon.Send({0, 100, 20, 300, 4, 50, 6, 16});
  daemon.Send({1, 4, 0, 0, 0, 0, 0, 0});
  daemon.Send({1, 2, 0, 0, 0, 0, 0, 0});
  daemon.Send({2, 2, 0, 0, 0, 0, 0, 0});
  daemon.Send({1, 1, 0, 0, 0, 0, 0, 0});
  SpaceMouseState state;
  for (int i = 0; i < 100 && !state.is_button_down[1]; ++i) {
    ASSERT_TRUE(source->Poll(state));
    SystemClock().Sleep(0.01);
  }
  EXPECT_EQ(state.push[0], 100);
  EXPECT_EQ(state.push[1], 20);
  EXPECT_EQ(state.push[2], -300) << "the daemon's z points away from the person";
  EXPECT_EQ(state.turn[1], 50);
  EXPECT_TRUE(state.is_button_down[1]);
  EXPECT_EQ(state.more_buttons, 4u) << "the fifth is down, the third was let go";
  daemon.HangUp();
  bool is_there = true;
  for (int i = 0; i < 100 && is_there; ++i) {
    is_there = source->Poll(state);
    SystemClock().Sleep(0.01);
  }
  EXPECT_FALSE(is_there);
  source->Close();
}

// the daemon of `trocar devices emulate spacemouse`, found, read and lost through the real library
TEST(Spacenav, ReadsAnEmulatedDaemon) {
  const std::string path = "/tmp/trocar_spnav_emulated_" + std::to_string(::getpid());
  auto host = *EmulatorHost::MakeLocal(MakeSpaceMouseEmulator(CalcCapMotion), path, 0);
  std::atomic<bool> is_running{true};
  std::atomic<double> served{0};
  std::thread thread([&] {
    for (double time = 0; is_running; time += 0.005, SystemClock().Sleep(0.005)) {
      host->Step(time);
      served = time;
    }
  });
  auto driver = MakeDriver("spacemouse:" + path, {}, SystemClock());
  ASSERT_TRUE(driver.ok());
  EXPECT_TRUE(IsSpacenavThere());
  std::array<HandSample, kChannelCount> home, samples;
  for (int channel = 0; channel < kChannelCount; ++channel) {
    home[static_cast<std::size_t>(channel)].depth = 0.15;
    (*driver)->PlaceHand(channel, home[static_cast<std::size_t>(channel)]);
  }
  const base::Status opened = (*driver)->Configure();
  double farthest = 0;
  bool has_closed = false, has_opened = false;
  if (opened && (*driver)->Activate()) {
    const double end = served + 3.5;  // the button goes down and up within 3 s
    for (int i = 0; i < 4000 && served < end; ++i) {
      (*driver)->Read(samples);
      farthest = std::max(farthest, std::fabs(samples[kRightHand].pan));
      has_closed = has_closed || samples[kRightHand].jaw == 0.0;
      has_opened = has_opened || samples[kRightHand].jaw > 0.5;
      SystemClock().Sleep(0.005);
    }
  }
  is_running = false;
  thread.join();
  host.reset();
  if (!opened) GTEST_SKIP() << "this libspnav asks no SPNAV_SOCKET: " << opened.error().Text();
  EXPECT_GT(farthest, 0.02);
  EXPECT_TRUE(has_closed && has_opened);
  EXPECT_EQ((*driver)->Read(samples), ReadStatus::kLost);
  EXPECT_FALSE(IsSpacenavThere());
}
#endif

TEST(Spacenav, SaysThatNoDaemonAnswers) {
  ::setenv("SPNAV_SOCKET", "/tmp/trocar_no_such_socket", 1);
  const base::Status opened = MakeSpacenavSource()->Open();
  if (opened) GTEST_SKIP() << "a spacenavd runs here";
#if TROCAR_HAS_SPNAV
  EXPECT_EQ(opened.error().code, base::ErrorCode::kDeviceLost);
#else
  EXPECT_EQ(opened.error().code, base::ErrorCode::kDeviceUnsupported);
#endif
}

}  // namespace
}  // namespace trocar::device
