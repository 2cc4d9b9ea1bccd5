// SPDX-License-Identifier: Apache-2.0
// Whatever becomes of the processes round a device that pushes, each of them alone ends the force. A simulator of its own pushes
// through each kind of driver; then simulator, supervisor and, where there is one, the process of the maker's library are killed,
// stopped, hung or starved together, in every combination. The device's end keeps its last force until somebody sends another: a
// device without a watchdog of its own.
// TROCAR_REPEATS sets how often each combination is done (1 by default); TROCAR_SLOW_TESTS=1 judges by what is promised.
#include <dirent.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <memory>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "child_processes.h"
#include "force_wire.h"
#include "stand_in_page.h"
#include "trocar/device/emulator.h"
#include "trocar/device/force_device_spec.h"
#include "trocar/host/clock.h"
#include "trocar/host/real_time.h"

namespace trocar::session {
namespace {

/// Other ones where tools/mutate-safety changes them.
const char* FindSupervisor() {
  const char* other = std::getenv("TROCAR_TEST_SUPERVISOR");
  return other != nullptr ? other : TROCAR_SUPERVISOR;
}
const char* FindVictim() {
  const char* other = std::getenv("TROCAR_TEST_VICTIM");
  return other != nullptr ? other : TROCAR_HAPTIC_VICTIM;
}

enum class Fate { kRuns, kKilled, kStopped, kHangs, kStarves };
const char* FateName(Fate fate) {
  const char* const names[] = {"Runs", "Killed", "Stopped", "Hangs", "Starves"};
  return names[static_cast<int>(fate)];
}

/// What the forces of a driver come out of.
class DeviceEnd {
 public:
  virtual ~DeviceEnd() = default;
  /// What the simulator is told beside the kind.
  virtual std::string Word() const = 0;
  /// Once the simulator has been started.
  virtual void Release() {}
  virtual bool IsPushing() = 0;
  /// Of the maker's library; 0 where there is none.
  virtual pid_t Host() const { return 0; }
  virtual void Hang() {}
};

class LibraryEnd : public DeviceEnd {
 public:
  std::string Word() const override { return TROCAR_STAND_IN_HD; }
  bool IsPushing() override { return motors_->forces[0][0] != 0; }
  pid_t Host() const override { return motors_->process; }
  void Hang() override {
    motors_->fault_process = motors_->process.load();
    motors_->fault = StandInFault::kHangingCall;
  }

 private:
  StandInPage page_;
  StandInState* const motors_ = page_.Get();
};

/// Read by a thread before everybody else, where that is permitted.
class ReadEnd : public DeviceEnd {
 public:
  bool IsPushing() override { return is_pushing_; }

 protected:
  template <typename Read>
  void Start(Read read) {
    thread_ = std::thread([this, read] {
      ForceWire::ReadInRealTime();
      while (!is_ending_) read();
    });
  }
  void End() {
    is_ending_ = true;
    if (thread_.joinable()) thread_.join();
  }
  std::atomic<bool> is_pushing_{false};

 private:
  std::thread thread_;
  std::atomic<bool> is_ending_{false};
};

class WireEnd : public ReadEnd {
 public:
  WireEnd() {
    ::fcntl(wire_.Host(), F_SETFD, 0);
    Start([this] {
      const ForceWire::Got got = wire_.Next(0.002);
      if (got == ForceWire::Got::kClosed) ::usleep(1000);
      if (got == ForceWire::Got::kForce || got == ForceWire::Got::kZero)
        is_pushing_ = got == ForceWire::Got::kForce;
    });
  }
  ~WireEnd() override { End(); }
  std::string Word() const override { return std::to_string(wire_.Host()); }
  void Release() override { wire_.CloseHost(); }

 private:
  ForceWire wire_{WireKind::kSocket};
};

class HaplyEnd : public ReadEnd {
 public:
  HaplyEnd() {
    const auto buttons = [](double time) -> std::uint32_t { return time > 0.8 ? 1 : 0; };
    auto host = device::EmulatorHost::MakeTcp(
        device::MakeHaplyEmulator({1, [](int, double) { return math::Vec3{}; }, buttons}, forces_), 0, {});
    EXPECT_TRUE(host.ok());
    if (!host.ok()) return;
    host_ = std::move(*host);
    Start([this] {
      host_->Step(watch_.Seconds());
      is_pushing_ = !(forces_->newtons[0] == math::Vec3{});
      ::usleep(200);
    });
  }
  ~HaplyEnd() override { End(); }
  std::string Word() const override {
    const std::string address = host_->Address();
    return address.substr(address.find(':') + 1);
  }

 private:
  std::shared_ptr<device::HaplyForces> forces_ = std::make_shared<device::HaplyForces>();
  std::unique_ptr<device::EmulatorHost> host_;
  host::Stopwatch watch_;
};

/// A device of each kind that a person can name. Null: a new one, which needs its end here, and so its place in these tests.
std::unique_ptr<DeviceEnd> MakeEnd(const std::string& kind) {
  if (kind == "simulated") return std::make_unique<WireEnd>();
  if (kind == "openhaptics") return std::make_unique<LibraryEnd>();
  if (kind == "haply") return std::make_unique<HaplyEnd>();
  return nullptr;
}
std::vector<std::string> ListKinds() {
  std::vector<std::string> kinds;
  std::istringstream list(device::ListForceDrivers());
  for (std::string word; list >> word;) {
    const std::size_t end = word.find_first_of("[,:");
    if (end != 0) kinds.push_back(word.substr(0, end));
  }
  return kinds;
}

/// A busy thread that keeps a process from the one processor that it is left with.
class Hog {
 public:
  explicit Hog(pid_t process) {
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(0, &one);
    thread_ = std::thread([this, one] {
      ::pthread_setaffinity_np(::pthread_self(), sizeof one, &one);
      host::AskForRealTime(host::RealTimePolicy::kFirstInFirstOut, 30);
      while (!is_ending_) {
      }
    });
    const std::string tasks = "/proc/" + std::to_string(process) + "/task";
    for (const auto& task : std::filesystem::directory_iterator(tasks)) {
      const int id = std::atoi(task.path().filename().c_str());
      const sched_param last{};
      ::sched_setaffinity(id, sizeof one, &one);
      ::sched_setscheduler(id, SCHED_IDLE, &last);
    }
  }
  ~Hog() {
    is_ending_ = true;
    thread_.join();
  }

 private:
  std::atomic<bool> is_ending_{false};
  std::thread thread_;
};

/// As long as it lives the calling thread goes before everybody else, where that is permitted; children would inherit it.
struct InRealTime {
  InRealTime() : is_permitted(ForceWire::ReadInRealTime()) {}
  ~InRealTime() {
    const sched_param ordinary{};
    ::sched_setscheduler(0, SCHED_OTHER, &ordinary);
  }
  InRealTime(const InRealTime&) = delete;
  InRealTime& operator=(const InRealTime&) = delete;
  const bool is_permitted;
};

/// A simulator with force out, its supervisor, and the processes of the library.
class Processes {
 public:
  explicit Processes(const std::string& kind) : end(MakeEnd(kind)) {
    if (end == nullptr) return;
    // what they leave behind is ours, so that no number stands for another process before we are done
    ::prctl(PR_SET_CHILD_SUBREAPER, 1UL);
    int pipe[2];
    EXPECT_EQ(::pipe2(pipe, O_CLOEXEC), 0);
    asking_ = pipe[1];
    const std::string word = end->Word();
    simulator = ::fork();
    if (simulator == 0) {
      ::dup2(pipe[0], STDIN_FILENO);
      ::execl(FindVictim(), FindVictim(), FindSupervisor(), kind.c_str(), word.c_str(), nullptr);
      ::_exit(9);
    }
    ::close(pipe[0]);
    end->Release();
  }
  ~Processes() {
    hogs.clear();
    ::close(asking_);
    for (const pid_t process : {simulator, supervisor, host, spare}) {
      if (process > 0) ::kill(process, SIGKILL);
    }
    // what has taken over ends by itself
    const host::Stopwatch watch;
    while (watch.Seconds() < 5.0) {
      const pid_t ended = ::waitpid(-1, nullptr, WNOHANG);
      if (ended < 0) break;
      if (ended == 0) ::usleep(1000);
    }
  }
  Processes(const Processes&) = delete;
  Processes& operator=(const Processes&) = delete;

  /// Until force is out for good.
  bool WaitForForce() {
    const host::Stopwatch watch;
    for (double asked = 0; watch.Seconds() < 60.0; ::usleep(1000)) {
      if (watch.Seconds() - asked > 0.2) {
        asked = watch.Seconds();
        if (::write(asking_, "a", 1) != 1) return false;
      }
      int pushing = 0;
      while (pushing < 40 && end->IsPushing()) ++pushing, ::usleep(500);
      if (pushing < 40) continue;
      supervisor = FindChild("--watch", simulator);
      host = end->Host();
      spare = host != 0 ? FindChild("--openhaptics", simulator, host) : 0;
      EXPECT_GT(supervisor, 0);
      EXPECT_TRUE(host == 0 || spare > 0) << "no spare";
      return !testing::Test::HasFailure();
    }
    return false;
  }
  void Strike(pid_t process, Fate fate) {
    if (process == 0) return;
    if (fate == Fate::kKilled) ::kill(process, SIGKILL);
    if (fate == Fate::kStopped) ::kill(process, SIGSTOP);
    if (fate == Fate::kStarves) hogs.push_back(std::make_unique<Hog>(process));
    if (fate == Fate::kHangs && process == simulator) {
      EXPECT_EQ(::write(asking_, "h", 1), 1);
    }
    if (fate == Fate::kHangs && process == host) end->Hang();
  }
  /// Each thread of it stands or is gone: a signal reaches a process only when its first thread has been given a processor.
  static bool Stands(pid_t process) {
    const std::string tasks = "/proc/" + std::to_string(process) + "/task";
    std::error_code gone;
    using Folder = std::filesystem::directory_iterator;
    for (Folder task(tasks, gone); !gone && task != Folder(); task.increment(gone)) {
      std::ifstream file(task->path() / "stat");
      std::string line;
      std::getline(file, line);  // empty where it has gone meanwhile
      const std::size_t at = line.rfind(')');
      if (at != std::string::npos && at + 2 < line.size() &&
          std::string("TtZX").find(line[at + 2]) == std::string::npos)
        return false;
    }
    return true;
  }

  std::unique_ptr<DeviceEnd> end;
  pid_t simulator = 0, supervisor = 0, host = 0, spare = 0;
  std::vector<std::unique_ptr<Hog>> hogs;

 private:
  int asking_ = -1;
};

struct Combination {
  std::string kind;
  Fate simulator = Fate::kRuns, supervisor = Fate::kRuns, host = Fate::kRuns, spare = Fate::kRuns;

  bool HasHost() const { return kind == "openhaptics"; }
  bool IsAllWell() const {
    return simulator == Fate::kRuns && supervisor == Fate::kRuns && host == Fate::kRuns;
  }
  /// Without a spare the supervisor forks, and without both the simulator starts a new process [s].
  double CalcPromised() const {
    return spare == Fate::kRuns ? 0.030 : supervisor == Fate::kRuns ? 0.050 : 0.100;
  }
  /// Nobody who could end the force is left.
  bool IsBeyondUs() const {
    const bool is_left = simulator == Fate::kRuns || supervisor == Fate::kRuns;
    return !is_left && (!HasHost() || (host != Fate::kRuns && spare != Fate::kRuns));
  }
};

std::string NameOf(const Combination& c) {
  std::string name = c.kind + "_simulator" + FateName(c.simulator) + "_supervisor" + FateName(c.supervisor);
  if (c.HasHost())
    name += std::string("_library") + FateName(c.host) + (c.spare != Fate::kRuns ? "_spare" : "") +
            (c.spare != Fate::kRuns ? FateName(c.spare) : "");
  return name;
}

class ForceEnds : public testing::TestWithParam<Combination> {
 protected:
  void Run() {
    const Combination c = GetParam();
    const bool has_starved =
        c.simulator == Fate::kStarves || c.supervisor == Fate::kStarves || c.host == Fate::kStarves;
    if (has_starved && !InRealTime().is_permitted) GTEST_SKIP() << "starving needs SCHED_FIFO";
    const char* const wanted = std::getenv("TROCAR_REPEATS");
    const int repeats = wanted != nullptr ? std::max(1, std::atoi(wanted)) : 1;
    ZeroTimes times;
    for (int i = 0; i < repeats; ++i) ASSERT_NO_FATAL_FAILURE(Measure(c, times));
    if (c.IsAllWell() || c.IsBeyondUs()) return;
    times.ReportAndJudge(NameOf(c), c.CalcPromised());
    if (longest_from_signal_ > c.CalcPromised()) {
      std::printf("%s: %.2f ms from the first signal on, the last of which came late\n", NameOf(c).c_str(),
                  1e3 * longest_from_signal_);
    }
  }

 private:
  static constexpr double kLookOn = 0.200;  // [s]

  void Measure(const Combination& c, ZeroTimes& times) {
    Processes processes(c.kind);
    ASSERT_NE(processes.end, nullptr)
        << "a kind of device that this test does not know: give it an end in MakeEnd()";
    ASSERT_TRUE(processes.WaitForForce());
    const InRealTime first;
    const std::int64_t begin = host::NowNanoseconds();
    const std::pair<pid_t, Fate> all[] = {{processes.host, c.host},
                                          {processes.spare, c.spare},
                                          {processes.supervisor, c.supervisor},
                                          {processes.simulator, c.simulator}};
    for (const auto& [process, fate] : all) processes.Strike(process, fate);
    // counts from when the one that stands nearest to the device, and held the force up, stands itself
    const std::pair<pid_t, Fate> near[] = {all[0], all[3], all[2]};
    const auto is_struck = [](const std::pair<pid_t, Fate>& one) {
      return one.first != 0 && (one.second == Fate::kKilled || one.second == Fate::kStopped);
    };
    const bool is_at_once = all[0].second == Fate::kHangs || all[0].second == Fate::kStarves;
    const auto nearest = std::find_if(std::begin(near), std::end(near), is_struck);
    std::int64_t now = host::NowNanoseconds(), struck = 0, ended = 0, last = now;
    std::int64_t counted = is_at_once || nearest == std::end(near) ? now : 0;
    double absence = 0;
    const auto seconds_since = [&](std::int64_t time) { return 1e-9 * static_cast<double>(now - time); };
    while (seconds_since(begin) < 2.0 && (ended == 0 || seconds_since(ended) < kLookOn)) {
      const bool is_pushing = processes.end->IsPushing();
      if (ended == 0 && !is_pushing) ended = now;
      if (ended != 0 && is_pushing) {
        // one that is stopped in the middle of a tick may have sent its last force after the zero of another
        ASSERT_TRUE(struck == 0) << "it came back after " << seconds_since(ended);
        ended = 0;
      }
      if (counted == 0 && Processes::Stands(nearest->first)) counted = now;
      if (struck == 0) {
        bool stand = true;
        for (const auto& [process, fate] : all)
          stand = stand && ((fate != Fate::kKilled && fate != Fate::kStopped) || process == 0 ||
                            Processes::Stands(process));
        if (stand) struck = now;
      }
      if (struck != 0 && ended == 0 && seconds_since(struck) > kLookOn) break;
      const timespec moment{0, 100'000};
      ::nanosleep(&moment, nullptr);
      now = host::NowNanoseconds();
      absence = std::max(absence, 1e-9 * static_cast<double>(now - last) - 2e-4);
      last = now;
    }
    if (c.IsAllWell() || c.IsBeyondUs()) {
      EXPECT_EQ(ended, 0) << (c.IsAllWell() ? "nothing was wrong" : "who did that?");
      return;
    }
    ASSERT_NE(ended, 0) << "the force stays";
    // a process that was stopped late was well until then
    const std::int64_t from = counted != 0 ? std::min(counted, ended) : begin;
    times.Add(1e-9 * static_cast<double>(ended - from), absence);
    longest_from_signal_ = std::max(longest_from_signal_, 1e-9 * static_cast<double>(ended - begin));
  }
  double longest_from_signal_ = 0;
};

TEST_P(ForceEnds, ByAnyOneThatIsLeft) {
  Run();
}

/// The rarer ones.
class ForceEndsSlow : public ForceEnds {};
TEST_P(ForceEndsSlow, ByAnyOneThatIsLeft) {
  Run();
}

constexpr Fate kThree[] = {Fate::kRuns, Fate::kKilled, Fate::kStopped};

/// 27 for a device behind a maker's library, 9 for one with a wire.
std::vector<Combination> AllCombinations() {
  std::vector<Combination> all;
  for (const std::string& kind : ListKinds()) {
    for (const Fate simulator : kThree) {
      for (const Fate supervisor : kThree) {
        for (const Fate host : kThree) {
          const Combination c{kind, simulator, supervisor, host};
          if (host == Fate::kRuns || c.HasHost()) all.push_back(c);
        }
      }
    }
  }
  return all;
}
/// The library's spare is stopped with it: simulator or supervisor alone, and the control.
std::vector<Combination> WithoutSpare(bool is_slow) {
  std::vector<Combination> all;
  for (const Fate simulator : kThree) {
    for (const Fate supervisor : kThree) {
      for (const Fate host : {Fate::kKilled, Fate::kStopped}) {
        const bool is_first = host == Fate::kStopped &&
                              (simulator == Fate::kRuns) != (supervisor == Fate::kRuns) &&
                              simulator != Fate::kStopped && supervisor != Fate::kKilled;
        const bool is_control =
            simulator == Fate::kStopped && supervisor == Fate::kStopped && host == Fate::kStopped;
        if (is_slow != (is_first || is_control))
          all.push_back({"openhaptics", simulator, supervisor, host, Fate::kStopped});
      }
    }
  }
  return all;
}
/// A hung supervisor, which has one thread, is as a stopped one.
std::vector<Combination> HungAndStarved(bool is_slow) {
  std::vector<Combination> all;
  for (const Fate one : {Fate::kHangs, Fate::kStarves}) {
    for (const Fate a : kThree) {
      for (const Fate b : kThree) {
        const bool is_first = a == b && a != Fate::kKilled;
        if (is_first == is_slow) continue;
        all.push_back({"openhaptics", one, a, b});
        all.push_back({"openhaptics", a, b, one});
        if (one == Fate::kStarves) all.push_back({"openhaptics", a, one, b});
      }
    }
  }
  return all;
}
std::string NameOfParam(const testing::TestParamInfo<Combination>& info) {
  return NameOf(info.param);
}

INSTANTIATE_TEST_SUITE_P(Of, ForceEnds, testing::ValuesIn(AllCombinations()), NameOfParam);
INSTANTIATE_TEST_SUITE_P(WithoutSpare, ForceEnds, testing::ValuesIn(WithoutSpare(false)), NameOfParam);
INSTANTIATE_TEST_SUITE_P(HungOrStarved, ForceEnds, testing::ValuesIn(HungAndStarved(false)), NameOfParam);
INSTANTIATE_TEST_SUITE_P(WithoutSpare, ForceEndsSlow, testing::ValuesIn(WithoutSpare(true)), NameOfParam);
INSTANTIATE_TEST_SUITE_P(HungOrStarved, ForceEndsSlow, testing::ValuesIn(HungAndStarved(true)), NameOfParam);

}  // namespace
}  // namespace trocar::session
