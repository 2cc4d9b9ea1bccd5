// SPDX-License-Identifier: Apache-2.0
#include "trocar/session/haptic_loop.h"

#include <algorithm>
#include <atomic>
#include <functional>
#include <optional>
#include <thread>
#include <utility>

#include "haptic_tick.h"
#include "time_histogram.h"
#include "trocar/host/clock.h"
#include "trocar/host/real_time.h"

namespace trocar::session {
namespace {

/// Above the simulation's thread, below the supervisor.
constexpr int kPriorityAboveLowest = 10;
/// Between two attempts to open a lost device again [ns].
constexpr std::int64_t kTryAgain = 500'000'000;

/// Sleeps until shortly before, then spins: sleep alone wakes late.
void WaitUntil(std::int64_t due, std::int64_t spin) noexcept {
  host::SleepUntil(due - spin);
  while (host::NowNanoseconds() < due) {
  }
}

/// Closes a lost device and opens it again on a thread of its own: the ticks go on while a library or a service takes its
/// time to answer.
class Reopener {
 public:
  explicit Reopener(std::function<void()> open) : open_(std::move(open)), thread_([this] { Run(); }) {}
  ~Reopener() {
    Tell(State::kEnding);
    thread_.join();
  }
  Reopener(const Reopener&) = delete;
  Reopener& operator=(const Reopener&) = delete;

  /// \pre !IsOpening()
  /// \note Real-time safe.
  void Begin() noexcept { Tell(State::kOpening); }
  /// The device is this thread's until then.
  bool IsOpening() const noexcept { return state_.load(std::memory_order_acquire) == State::kOpening; }

 private:
  enum class State { kIdle, kOpening, kEnding };

  void Tell(State state) noexcept {
    state_.store(state, std::memory_order_release);
    state_.notify_one();
  }
  void Run() {
    // it starts processes and maps memory: held up by others meanwhile, it would hold the loop's page faults up
    static_cast<void>(host::AskForRealTime(host::RealTimePolicy::kFirstInFirstOut, kPriorityAboveLowest - 1));
    while (true) {
      state_.wait(State::kIdle, std::memory_order_acquire);
      State expected = State::kOpening;
      if (state_.load(std::memory_order_acquire) != expected) return;
      open_();
      state_.compare_exchange_strong(expected, State::kIdle, std::memory_order_acq_rel);
    }
  }

  std::function<void()> open_;
  std::atomic<State> state_{State::kIdle};
  std::thread thread_;
};

}  // namespace

struct HapticLoop::Content {
  HapticLoopSettings settings;
  HapticLink* link = nullptr;
  std::unique_ptr<device::ForceDriver> driver;
  std::optional<SupervisorLink> supervisor;
  std::optional<HapticTick> tick;
  std::optional<Reopener> reopener;

  std::atomic<bool> is_stopping{false}, is_pedal_held{false};
  std::atomic<bool> wants_clear{false};
  std::atomic<std::uint64_t> allocated{0};
  std::atomic<bool> wants_arm{false}, wants_stop{false}, wants_check_pose{false};
  host::NewestSlot<HapticStatus> status;
  TimeHistogram all_periods, all_cpu;  // since ClearTimes
  TimeHistogram periods, cpu;          // of this second
  std::thread thread;

  base::Status Connect();
  void Run() noexcept;
  HapticTickInput TakeInput(std::int64_t start, std::int64_t late) noexcept {
    HapticTickInput input;
    input.now = 1e-9 * static_cast<double>(start);
    input.lateness = 1e-9 * static_cast<double>(late);
    input.wants_arm = wants_arm.exchange(false);
    input.wants_stop = wants_stop.exchange(false);
    input.wants_check_pose = wants_check_pose.exchange(false);
    input.is_pedal_held = is_pedal_held.load(std::memory_order_relaxed);
    if (supervisor) {
      input.is_supervised = supervisor->IsAlive(start);
      input.is_supervisor_tripped = supervisor->TakeTrip();
    }
    return input;
  }
};

/// Opens the device and gives its wires, or the processes that hold it, to the supervisor. Not real-time safe.
base::Status HapticLoop::Content::Connect() {
  if (base::Status done = driver->Configure(); !done) return done;
  if (base::Status done = driver->Activate(); !done) {
    static_cast<void>(driver->Cleanup());
    return done;
  }
  if (!supervisor) return {};
  supervisor->ForgetWires();
  base::Status done = supervisor->AddLibrary(driver->GetSupervisedLibrary());
  for (int c = 0; c < driver->GetChannelCount() && done; ++c)
    done = supervisor->AddWire(driver->GetSupervisedWire(c));
  if (!done) {
    static_cast<void>(driver->Deactivate());
    static_cast<void>(driver->Cleanup());
  }
  return done;
}

void HapticLoop::Content::Run() noexcept {
  const bool is_real_time =
      host::AskForRealTime(host::RealTimePolicy::kFirstInFirstOut, kPriorityAboveLowest);
  const auto period = static_cast<std::int64_t>(1e9 * settings.period);
  const auto spin = static_cast<std::int64_t>(1e9 * settings.spin);
  const CountAllocations count = settings.count_allocations;
  HapticStatus told;
  std::int64_t due = host::NowNanoseconds() + period, last_start = 0, second_start = due, last_told = 0,
               last_try = 0;
  while (!is_stopping.load(std::memory_order_relaxed)) {
    WaitUntil(due, spin);
    const std::int64_t start = host::NowNanoseconds();
    const std::int64_t cpu_before = host::ThreadCpuNanoseconds();
    const std::uint64_t allocated_before = count != nullptr ? count() : 0;
    // a tick that stood still inside shows in the next one's distance to it
    const std::int64_t late = std::max(start - due, last_start != 0 ? start - last_start - period : 0);
    const bool is_opening = reopener->IsOpening();
    HapticTickInput input = TakeInput(start, late);
    input.is_device_away = is_opening;
    tick->Run(input);
    if (count != nullptr) allocated.fetch_add(count() - allocated_before, std::memory_order_relaxed);
    if (supervisor) supervisor->Beat();
    const std::int64_t used = host::ThreadCpuNanoseconds() - cpu_before;
    if (wants_clear.exchange(false)) {
      all_cpu.Clear(), all_periods.Clear();
      allocated.store(0);
    }
    cpu.Add(used), all_cpu.Add(used);
    if (last_start != 0) periods.Add(start - last_start), all_periods.Add(start - last_start);
    last_start = start;
    if (start - second_start >= 1'000'000'000) {
      told.rate = static_cast<double>(periods.Count()) / (1e-9 * static_cast<double>(start - second_start));
      told.period_p50 = periods.CalcPercentile(0.5);
      told.period_p999 = periods.CalcPercentile(0.999);
      told.period_max = periods.Longest();
      told.cpu_p999 = cpu.CalcPercentile(0.999);
      told.cpu_max = cpu.Longest();
      periods.Clear(), cpu.Clear();
      second_start = start;
    }
    if (start - last_told >= 50'000'000) {
      HapticStatus& next = status.Back();
      next = tick->GetStatus();
      next.rate = told.rate;
      next.period_p50 = told.period_p50, next.period_p999 = told.period_p999;
      next.period_max = told.period_max, next.cpu_p999 = told.cpu_p999;
      next.cpu_max = told.cpu_max;
      next.is_real_time = is_real_time;
      status.Publish();
      last_told = start;
    }
    if (is_opening) {
      last_try = start;
    } else if (driver->NeedsRelease() ||
               (driver->GetState() == device::DriverState::kUnconfigured && start - last_try >= kTryAgain)) {
      reopener
          ->Begin();  // closes what is lost, too, which may take its time; what comes back is unarmed and unconfirmed
    }
    due += period;
    // late: never a burst of ticks to catch up (faults D9)
    if (host::NowNanoseconds() > due + period / 2) due = host::NowNanoseconds();
  }
}

base::Result<std::unique_ptr<HapticLoop>> HapticLoop::Start(std::unique_ptr<device::ForceDriver> driver,
                                                            const HapticLoopSettings& settings,
                                                            HapticLink& link) {
  if (static_cast<int>(settings.hands.size()) != driver->GetChannelCount()) {
    return base::Error{base::ErrorCode::kDeviceSettings,
                       driver->GetName() + " has " + std::to_string(driver->GetChannelCount()) +
                           " channels for " + std::to_string(settings.hands.size()) +
                           " hands; name as many hands as the device has channels"};
  }
  auto content = std::make_unique<Content>();
  content->settings = settings;
  content->link = &link;
  content->driver = std::move(driver);
  if (!settings.supervisor.empty()) {
    auto supervisor = SupervisorLink::Start(settings.supervisor);
    if (!supervisor) return supervisor.error();
    content->supervisor.emplace(std::move(*supervisor));
  }
  if (auto done = content->Connect(); !done) return done.error();
  content->tick.emplace(*content->driver, settings, link);
  content->reopener.emplace([opening = content.get()] { static_cast<void>(opening->Connect()); });
  std::unique_ptr<HapticLoop> loop(new HapticLoop(std::move(content)));
  return loop;
}

HapticLoop::HapticLoop(std::unique_ptr<Content> content) : content_(std::move(content)) {
  content_->link->is_used.store(true);
  content_->thread = std::thread([running = content_.get()] { running->Run(); });
}

HapticLoop::~HapticLoop() {
  content_->is_stopping.store(true);
  content_->thread.join();
  content_->reopener.reset();  // waits for an opening that goes on
  content_->link->is_used.store(false);
  content_->driver->Finalize();
}

void HapticLoop::RequestArm() noexcept {
  content_->wants_arm.store(true);
}
void HapticLoop::Stop() noexcept {
  content_->wants_stop.store(true);
}
void HapticLoop::BeginCheckPose() noexcept {
  content_->wants_check_pose.store(true);
}
void HapticLoop::SetPedal(bool is_held) noexcept {
  content_->is_pedal_held.store(is_held);
}

const HapticStatus& HapticLoop::Latest() noexcept {
  content_->status.Update();
  return content_->status.Front();
}

std::uint64_t HapticLoop::CountAllocated() const noexcept {
  return content_->allocated.load();
}
void HapticLoop::ClearTimes() noexcept {
  content_->wants_clear.store(true);
}
double HapticLoop::CalcPeriodPercentile(double fraction) const noexcept {
  return content_->all_periods.CalcPercentile(fraction);
}
double HapticLoop::CalcCpuPercentile(double fraction) const noexcept {
  return content_->all_cpu.CalcPercentile(fraction);
}

}  // namespace trocar::session
