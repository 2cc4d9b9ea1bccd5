// SPDX-License-Identifier: Apache-2.0
// D10: the main process is killed or stopped while force is out; what then arrives at the device.
// TROCAR_REPEATS sets how often each is done (2 by default); the times are printed and judged, by a generous limit in every run and by what
// is promised with TROCAR_SLOW_TESTS=1.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "child_processes.h"
#include "force_wire.h"
#include "machine_watch.h"
#include "supervisor_protocol.h"
#include "trocar/device/companion.h"
#include "trocar/device/simulated_force_device.h"
#include "trocar/host/clock.h"
#include "trocar/session/haptic_loop.h"

namespace trocar::session {

using instrument::kRight;
using math::Vec3;
using scene::Condition;

namespace {

using Got = ForceWire::Got;
/// Force must be gone so soon after the process [s].
constexpr double kLongest = 0.015;

/// Other ones where tools/mutate-safety changes them.
const char* FindSupervisor() {
  const char* other = std::getenv("TROCAR_TEST_SUPERVISOR");
  return other != nullptr ? other : TROCAR_SUPERVISOR;
}
const char* FindVictim() {
  const char* other = std::getenv("TROCAR_TEST_VICTIM");
  return other != nullptr ? other : TROCAR_HAPTIC_VICTIM;
}

/// A process that puts force on a wire, and the device's end of it.
class Victim {
 public:
  explicit Victim(WireKind kind, const char* supervisor = FindSupervisor()) : wire(kind) {
    int ends[2];
    EXPECT_EQ(::pipe2(ends, O_CLOEXEC), 0);
    const std::string file = std::to_string(wire.Host());
    process_ = ::fork();
    if (process_ == 0) {
      const sched_param ordinary{};
      ::sched_setscheduler(0, SCHED_OTHER, &ordinary);
      ::dup2(ends[0], STDIN_FILENO);
      ::fcntl(wire.Host(), F_SETFD, 0);
      ::execl(FindVictim(), FindVictim(), supervisor, "simulated", file.c_str(), nullptr);
      ::_exit(9);
    }
    ::close(ends[0]);
    wire.CloseHost();
    asking_ = ends[1];
  }
  ~Victim() {
    if (process_ > 0) {
      ::kill(process_, SIGKILL);
      ::waitpid(process_, nullptr, 0);
    }
    ::close(asking_);
  }
  Victim(const Victim&) = delete;
  Victim& operator=(const Victim&) = delete;

  void Ask() { EXPECT_EQ(::write(asking_, "a", 1), 1); }
  /// \return when [ns]
  std::int64_t Kill(int signal) {
    wire.ForgetAbsence();
    const std::int64_t now = host::NowNanoseconds();
    ::kill(process_, signal);
    return now;
  }
  /// Asks until force is out.
  bool WaitForForce() {
    const host::Stopwatch watch;
    double asked = 0;
    while (watch.Seconds() < 60.0) {
      if (watch.Seconds() - asked > 0.2) {
        asked = watch.Seconds();
        Ask();
      }
      const Got got = wire.Next(0.05);
      if (got == Got::kForce) return true;
      if (got == Got::kClosed) return false;
    }
    return false;
  }

  ForceWire wire;

 private:
  int asking_ = -1;
  pid_t process_ = -1;
};

class Supervisor : public testing::TestWithParam<WireKind> {
 protected:
  void SetUp() override { ForceWire::ReadInRealTime(); }
  void TearDown() override {
    const sched_param ordinary{};
    ::sched_setscheduler(0, SCHED_OTHER, &ordinary);
  }
  /// A signal to the process, and the first zero after it. A process stops only when its first thread, which has no priority, has
  /// been given a processor: until then its loop is well and sends forces, so a stop counts from the last of them.
  void Strike(Victim& victim, int signal) {
    machine_.Forget();
    const std::int64_t struck = victim.Kill(signal);
    std::int64_t last_force = struck;
    Got got = victim.wire.Next(5.0);
    for (; got == Got::kForce; got = victim.wire.Next(5.0)) last_force = victim.wire.Arrived();
    ASSERT_EQ(got, Got::kZero);
    const auto since = [&](std::int64_t time) {
      return 1e-9 * static_cast<double>(victim.wire.Arrived() - time);
    };
    times_.Add(since(signal == SIGSTOP ? last_force : struck),
               std::max(victim.wire.LongestAbsence(), machine_.LongestAbsence()));
    longest_from_signal_ = std::max(longest_from_signal_, since(struck));
  }
  void Report(const char* what) {
    times_.ReportAndJudge(std::string(what) + ", " + WireName(GetParam()), kLongest);
    std::printf("%s: %.2f ms the longest from the signal on\n", what, 1e3 * longest_from_signal_);
  }
  MachineWatch machine_;
  ZeroTimes times_;
  double longest_from_signal_ = 0;
};

TEST_P(Supervisor, SendsZeroWhenTheSimulatorIsKilled) {
  for (int i = 0; i < ForceWire::Repeats(); ++i) {
    Victim victim(GetParam());
    ASSERT_TRUE(victim.WaitForForce());
    ASSERT_NO_FATAL_FAILURE(Strike(victim, SIGKILL));
    Got got = Got::kZero;
    while (got == Got::kZero) got = victim.wire.Next(5.0);
    EXPECT_EQ(got, Got::kClosed) << "force after the zero";
  }
  Report("killed");
}

TEST_P(Supervisor, SendsZeroWhenTheSimulatorHangsAndNothingComesBackByItself) {
  for (int i = 0; i < ForceWire::Repeats(); ++i) {
    Victim victim(GetParam());
    ASSERT_TRUE(victim.WaitForForce());
    ASSERT_NO_FATAL_FAILURE(Strike(victim, SIGSTOP));
    // it goes on saying so; the process wakes, and the force stays off although the switch is still held
    for (int k = 0; k < 5; ++k) ASSERT_EQ(victim.wire.Next(5.0), Got::kZero);
    victim.Kill(SIGCONT);
    int forces = 0;
    for (int k = 0; k < 300; ++k) forces += victim.wire.Next(1.0) == Got::kForce;
    // what was cut off in the middle of a tick may still go out, once
    EXPECT_LE(forces, 1);
    EXPECT_TRUE(victim.WaitForForce()) << "a person can arm again";
  }
  Report("stopped");
}

INSTANTIATE_TEST_SUITE_P(On, Supervisor, testing::Values(WireKind::kTerminal, WireKind::kSocket),
                         [](const auto& wire) {
                           return wire.param == WireKind::kTerminal ? "Terminal" : "Socket";
                         });

/// The device's end of a wire that the supervisor holds a copy of.
class HeldWire {
 public:
  explicit HeldWire(std::uint8_t mark, bool is_closed_after = false, std::size_t size = 3) {
    int ends[2];
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends), 0);
    device_ = ends[0], host_ = ends[1];
    wire_.file = host_;
    wire_.size = size;
    wire_.zero_frame.fill(mark);
    wire_.zero_frame[1] = 0;
    wire_.is_closed_after = is_closed_after;
  }
  HeldWire(const HeldWire&) = delete;
  HeldWire& operator=(const HeldWire&) = delete;
  ~HeldWire() {
    ::close(device_);
    CloseHost();
  }
  const device::SupervisedWire& Wire() const { return wire_; }
  void CloseHost() {
    if (host_ >= 0) ::close(host_);
    host_ = -1;
  }
  /// Zero frames that came within `seconds`; every byte has to be of one.
  int CountZeros(double seconds) {
    const host::Stopwatch watch;
    std::size_t bytes = 0;
    while (watch.Seconds() < seconds && !is_closed_) {
      std::uint8_t got[64];
      const ssize_t size = ::read(device_, got, sizeof got);
      is_closed_ = size == 0;
      for (ssize_t i = 0; i < size; ++i, ++bytes) EXPECT_EQ(got[i], wire_.zero_frame[bytes % wire_.size]);
      if (size < 0) ::usleep(500);
    }
    EXPECT_EQ(bytes % wire_.size, 0u);
    return static_cast<int>(bytes / wire_.size);
  }
  /// Nobody holds the other end any more, or it was shut down.
  bool IsClosed() const { return is_closed_; }

 private:
  device::SupervisedWire wire_;
  int device_ = -1, host_ = -1;
  bool is_closed_ = false;
};

TEST(SupervisorLink, WatchesEveryWireFromTheFirstBeatOn) {
  auto link = SupervisorLink::Start(FindSupervisor());
  ASSERT_TRUE(link.ok()) << link.error().Text();
  HeldWire left(1), right(2, true);
  ASSERT_TRUE(link->AddWire({}).ok()) << "a device that is reached through a library";
  ASSERT_TRUE(link->AddWire(left.Wire()).ok());
  ASSERT_TRUE(link->AddWire(right.Wire()).ok());
  EXPECT_EQ(left.CountZeros(0.05), 0) << "nobody has pushed yet";
  EXPECT_FALSE(link->TakeTrip());
  const host::Stopwatch alive;
  while (!link->IsAlive(host::NowNanoseconds()) && alive.Seconds() < 10.0) ::usleep(500);
  EXPECT_TRUE(link->IsAlive(host::NowNanoseconds()));
  link->Beat();
  // on a busy machine later than 10 ms, never earlier
  const host::Stopwatch beat;
  int zeros = 0;
  while (zeros == 0 && beat.Seconds() < 10.0) zeros = left.CountZeros(0.001);
  EXPECT_GE(beat.Seconds(), 0.009);
  EXPECT_GE(left.CountZeros(0.1), 3) << "again and again";
  EXPECT_GE(right.CountZeros(0.01), 3);
  EXPECT_TRUE(link->TakeTrip());
  EXPECT_FALSE(link->TakeTrip()) << "told once";
  // a device that is gone: the copies are closed, and what comes back has a wire of its own
  link->ForgetWires();
  left.CloseHost();
  while (!left.IsClosed() && beat.Seconds() < 20.0) left.CountZeros(0.01);
  EXPECT_TRUE(left.IsClosed());
  right.CountZeros(0.05);  // what was on its way
  EXPECT_EQ(right.CountZeros(0.05), 0) << "forgotten";
  std::vector<std::unique_ptr<HeldWire>> wires;
  for (int i = 0; i < kMaxWires + 1; ++i) {
    wires.push_back(std::make_unique<HeldWire>(static_cast<std::uint8_t>(i + 1)));
    ASSERT_TRUE(link->AddWire(wires.back()->Wire()).ok());
  }
  for (int i = 0; i < kMaxWires; ++i) EXPECT_GE(wires[static_cast<std::size_t>(i)]->CountZeros(0.05), 1) << i;
  EXPECT_EQ(wires.back()->CountZeros(0.05), 0) << "more than it can hold";
  wires.back()->CloseHost();
  wires.back()->CountZeros(0.05);
  EXPECT_TRUE(wires.back()->IsClosed()) << "and not kept";
}

// descriptor 0 is a file as any other, where the program was started without standard input
TEST(SupervisorLink, AWireMayHaveTheFirstDescriptor) {
  HeldWire wire(6);
  const int input = ::dup(STDIN_FILENO);
  ASSERT_EQ(::dup2(wire.Wire().file, STDIN_FILENO), STDIN_FILENO);
  device::SupervisedWire first = wire.Wire();
  first.file = STDIN_FILENO;
  {
    auto link = SupervisorLink::Start(FindSupervisor());
    ASSERT_TRUE(link.ok()) << link.error().Text();
    EXPECT_TRUE(link->AddWire(first).ok());
  }
  input < 0 ? ::close(STDIN_FILENO) : ::dup2(input, STDIN_FILENO);
  if (input >= 0) ::close(input);
  EXPECT_EQ(wire.CountZeros(0.05), 3);
}

TEST(SupervisorProgram, EndsWithAnErrorWhereItHasNoMemoryToWatch) {
  const pid_t process = ::fork();
  if (process == 0) ::_exit(RunSupervisor(-1, -1));
  int status = 0;
  ASSERT_EQ(::waitpid(process, &status, 0), process);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 1) << status;
}

// at our end, whatever came before it: a connection to a service is shut down as well
TEST(SupervisorLink, TheLastWordsAreThreeZeros) {
  HeldWire line(3), service(4, true, device::SupervisedWire::kMaxBytes);
  {
    auto link = SupervisorLink::Start(FindSupervisor());
    ASSERT_TRUE(link.ok()) << link.error().Text();
    ASSERT_TRUE(link->AddWire(line.Wire()).ok());
    ASSERT_TRUE(link->AddWire(service.Wire()).ok());
  }
  EXPECT_EQ(line.CountZeros(0.05), 3);
  EXPECT_FALSE(line.IsClosed()) << "we hold it still";
  EXPECT_EQ(service.CountZeros(0.05), 3);
  EXPECT_TRUE(service.IsClosed());
}

TEST(SupervisorLink, WhileWeBeatItKeepsQuietAndASupervisorThatIsGoneIsNoticed) {
  auto link = SupervisorLink::Start(FindSupervisor());
  ASSERT_TRUE(link.ok()) << link.error().Text();
  HeldWire wire(5);
  ASSERT_TRUE(link->AddWire(wire.Wire()).ok());
  const bool is_permitted = ForceWire::ReadInRealTime();
  bool was_alive = false;
  const host::Stopwatch watch;
  // on a busy machine a program takes its time to start
  while (watch.Seconds() < 0.5 || (!was_alive && watch.Seconds() < 20.0)) {
    link->Beat();
    was_alive = link->IsAlive(host::NowNanoseconds()) || was_alive;
    ::usleep(1000);
  }
  const sched_param ordinary{};
  ::sched_setscheduler(0, SCHED_OTHER, &ordinary);
  EXPECT_TRUE(was_alive);
  // a machine that let this thread stand still for 10 ms is told of, too
  EXPECT_EQ(wire.CountZeros(0.001) > 0, link->TakeTrip());
  const pid_t supervisor = FindChild("--watch");
  ASSERT_GT(supervisor, 0);
  sched_param priority{};
  EXPECT_EQ(::sched_getparam(supervisor, &priority), 0);
  if (is_permitted) {
    EXPECT_EQ(priority.sched_priority, sched_get_priority_min(SCHED_FIFO) + 20) << "before everybody else";
  }
  ::kill(supervisor, SIGSTOP);
  // silent for 20 ms, of which a time in which this thread itself did not run counts no more than 2
  for (const std::int64_t look : {1, 1000}) {
    ::usleep(50'000);
    const std::int64_t first = host::NowNanoseconds();
    link->IsAlive(first);
    const int looks = look == 1 ? 20 : 10;
    for (int i = 1; i <= looks; ++i) EXPECT_TRUE(link->IsAlive(first + i * look * 1'000'000)) << i;
    EXPECT_FALSE(link->IsAlive(first + (looks + 1) * look * 1'000'000));
    if (look != 1) break;
    ::kill(supervisor, SIGCONT);
    ::usleep(50'000);
    ::kill(supervisor, SIGSTOP);
  }
  const auto wait_for = [&](bool is_alive) {
    constexpr std::int64_t kAhead = 20'000'000'000;  // of the looks above; time never falls
    const host::Stopwatch waited;
    while (waited.Seconds() < 5.0 && link->IsAlive(host::NowNanoseconds() + kAhead) != is_alive)
      ::usleep(1000);
    return waited.Seconds();
  };
  EXPECT_LT(wait_for(false), 5.0) << "stopped";
  ::kill(supervisor, SIGCONT);
  EXPECT_LT(wait_for(true), 5.0) << "and it goes on";
  // killed: its end of the socket tells before any time has passed
  const std::int64_t now = host::NowNanoseconds() + 30'000'000'000;
  ASSERT_TRUE(link->IsAlive(now));
  ::kill(supervisor, SIGKILL);
  const host::Stopwatch killed;
  while (link->IsAlive(now) && killed.Seconds() < 5.0) ::usleep(1000);
  EXPECT_LT(killed.Seconds(), 5.0);
}

/// The program alone, as the simulator speaks to it.
class SupervisorProcess : public testing::Test {
 protected:
  void SetUp() override {
    auto started = device::Companion::Start(FindSupervisor(), "--watch", sizeof(SupervisorPage),
                                            base::ErrorCode::kHapticSupervisor, "");
    ASSERT_TRUE(started.ok());
    process_.emplace(std::move(*started));
  }
  /// \param bytes  of the message that travel
  void Send(const HeldWire& wire, std::size_t bytes, std::uint32_t frame_size) {
    WireMessage message;
    message.size = frame_size;
    std::memcpy(message.zero_frame, wire.Wire().zero_frame.data(), wire.Wire().size);
    iovec part{&message, bytes};
    alignas(cmsghdr) char control[CMSG_SPACE(sizeof(int))] = {};
    msghdr header{};
    header.msg_iov = &part;
    header.msg_iovlen = 1;
    header.msg_control = control;
    header.msg_controllen = sizeof control;
    cmsghdr* carried = CMSG_FIRSTHDR(&header);
    carried->cmsg_level = SOL_SOCKET;
    carried->cmsg_type = SCM_RIGHTS;
    carried->cmsg_len = CMSG_LEN(sizeof(int));
    std::memcpy(CMSG_DATA(carried), &wire.Wire().file, sizeof(int));
    EXPECT_EQ(::sendmsg(process_->Socket(), &header, MSG_NOSIGNAL), static_cast<ssize_t>(bytes));
  }
  std::optional<device::Companion> process_;
};

TEST_F(SupervisorProcess, HoldsEightWiresAndNoneThatAMessageDoesNotDescribe) {
  HeldWire cut(1), too_long(2);
  Send(cut, sizeof(WireMessage) - 1, 3);
  Send(too_long, sizeof(WireMessage), device::SupervisedWire::kMaxBytes + 1);
  for (HeldWire* refused : {&cut, &too_long}) {
    refused->CloseHost();
    const host::Stopwatch watch;
    while (!refused->IsClosed() && watch.Seconds() < 10.0) EXPECT_EQ(refused->CountZeros(0.01), 0);
    EXPECT_TRUE(refused->IsClosed()) << "not kept";
  }
  std::vector<std::unique_ptr<HeldWire>> wires;
  for (int i = 0; i < kMaxWires; ++i) {
    wires.push_back(std::make_unique<HeldWire>(static_cast<std::uint8_t>(i + 1)));
    Send(*wires.back(), sizeof(WireMessage), 3);
  }
  ::shutdown(process_->Socket(), SHUT_RDWR);
  int status = -1;
  EXPECT_EQ(::waitpid(process_->Process(), &status, 0), process_->Process());
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  for (const auto& wire : wires) EXPECT_EQ(wire->CountZeros(0.02), 3);
}

TEST(SupervisorLink, WithoutItThereIsNoForce) {
  device::SimulatedForceSettings simulated;
  simulated.path = [](int, double) { return Vec3{}; };
  HapticLoopSettings settings;
  settings.hands.emplace_back();
  HapticLink link;
  settings.supervisor = "/nowhere/trocar-supervisor";
  auto missing = HapticLoop::Start(std::make_unique<device::SimulatedForceDevice>(simulated), settings, link);
  ASSERT_FALSE(missing.ok());
  EXPECT_EQ(missing.error().code, base::ErrorCode::kHapticSupervisor);

  settings.supervisor.clear();
  auto loop = HapticLoop::Start(std::make_unique<device::SimulatedForceDevice>(simulated), settings, link);
  ASSERT_TRUE(loop.ok()) << loop.error().Text();
  const host::Stopwatch watch;
  while ((*loop)->Latest().ticks < 20 && watch.Seconds() < 30.0) ::usleep(1000);
  EXPECT_GE((*loop)->Latest().ticks, 20u);
  EXPECT_FALSE((*loop)->Latest().is_supervised);
  (*loop)->RequestArm();
  ::usleep(200'000);
  EXPECT_EQ((*loop)->Latest().hands[kRight].state, haptics::ArmState::kUnarmed);
  EXPECT_EQ((*loop)->Latest().hands[kRight].reason, haptics::Fault::kSupervisor);
}

TEST(HapticLoop, RefusesHandsThatAreNotChannels) {
  device::SimulatedForceSettings simulated;
  simulated.path = [](int, double) { return Vec3{}; };
  HapticLink link;
  const auto loop = HapticLoop::Start(std::make_unique<device::SimulatedForceDevice>(simulated),
                                      HapticLoopSettings{}, link);
  ASSERT_FALSE(loop.ok());
  EXPECT_EQ(loop.error().code, base::ErrorCode::kDeviceSettings);
}

/// Whether the right hand comes to be so.
template <typename Condition>
bool WaitFor(HapticLoop& loop, const Condition& condition) {
  const host::Stopwatch watch;
  while (watch.Seconds() < 30.0) {
    if (condition(loop.Latest().hands[kRight])) return true;
    ::usleep(1000);
  }
  return false;
}

bool IsLost(const HapticHandStatus& hand) {
  return hand.reason == haptics::Fault::kDeviceLost;
}

/// A loop with a supervisor and the right hand, which the device has reported; null, and a failure, where that fails.
std::unique_ptr<HapticLoop> StartRightHand(std::unique_ptr<device::ForceDriver> driver, HapticLink& link) {
  HapticLoopSettings settings;
  settings.supervisor = FindSupervisor();
  settings.hands.emplace_back();
  auto loop = HapticLoop::Start(std::move(driver), settings, link);
  if (!loop.ok()) {
    ADD_FAILURE() << loop.error().Text();
    return nullptr;
  }
  EXPECT_TRUE(WaitFor(**loop, [](const HapticHandStatus& hand) { return hand.counts.good > 0; }));
  return std::move(*loop);
}

// D1: unplugged and back.
TEST(HapticLoop, OpensALostDeviceAgainAndLeavesItUnarmed) {
  device::SimulatedForceSettings simulated;
  simulated.path = [](int, double) { return Vec3{}; };
  auto made = std::make_unique<device::SimulatedForceDevice>(simulated);
  device::SimulatedForceDevice& device = *made;
  HapticLink link;
  const auto loop = StartRightHand(std::move(made), link);
  ASSERT_NE(loop, nullptr);
  device.SetFault(device::SimulatedFault::kUnplugged);
  EXPECT_TRUE(WaitFor(*loop, IsLost));
  const auto good = loop->Latest().hands[kRight].counts.good;
  device.SetFault(device::SimulatedFault::kNone);
  EXPECT_TRUE(WaitFor(*loop, [&](const HapticHandStatus& hand) { return hand.counts.good > good; }));
  EXPECT_EQ(loop->Latest().hands[kRight].state, haptics::ArmState::kUnarmed);
}

/// A device that goes away when told to, and opens again no sooner than it may.
class SlowToOpen : public device::ForceDriver {
 public:
  SlowToOpen() : ForceDriver("slow to open", 1) {}
  device::ForceLimits GetLimits(int) const noexcept override { return device::MakeTouchLimits(); }

  std::atomic<bool> is_gone{false}, may_open{true};
  std::atomic<int> openings{0};

 private:
  base::Status DoConfigure() override {
    ++openings;
    const host::Stopwatch watch;
    while (!may_open && watch.Seconds() < 60.0) ::usleep(1000);
    is_gone = false;
    return {};
  }
  base::Status DoActivate() override { return {}; }
  void DoDeactivate() noexcept override {}
  void DoCleanup() noexcept override {}
  device::ReadStatus DoRead(std::span<device::HandSample>) noexcept override {
    return device::ReadStatus::kUnchanged;
  }
  device::ReadStatus DoReadForceSamples(std::span<device::ForceSample> samples) noexcept override {
    if (is_gone) return device::ReadStatus::kLost;
    samples[0].status = device::ForceDeviceStatus::kOk;
    samples[0].jaw = std::nan("");
    ++samples[0].sequence;
    return device::ReadStatus::kFresh;
  }
  void DoSendForce(int, const device::GatedForce&) noexcept override {}
};

// D1 and D9: the loss is told and the loop keeps its beat while the device is opened again
TEST(HapticLoop, KeepsItsBeatWhileADeviceTakesItsTimeToOpen) {
  auto made = std::make_unique<SlowToOpen>();
  SlowToOpen& device = *made;
  HapticLink link;
  const auto loop = StartRightHand(std::move(made), link);
  ASSERT_NE(loop, nullptr);
  device.may_open = false;
  device.is_gone = true;
  EXPECT_TRUE(WaitFor(*loop, [&](const HapticHandStatus&) { return device.openings == 2; }));
  const auto ticks = loop->Latest().ticks;
  EXPECT_TRUE(WaitFor(*loop, [&](const HapticHandStatus& hand) {
    return IsLost(hand) && loop->Latest().ticks > ticks + 200;
  }));
  const auto good = loop->Latest().hands[kRight].counts.good;
  device.may_open = true;
  EXPECT_TRUE(WaitFor(*loop, [&](const HapticHandStatus& hand) { return hand.counts.good > good; }));
  EXPECT_EQ(device.openings, 2);
}

}  // namespace
}  // namespace trocar::session
