// SPDX-License-Identifier: Apache-2.0
#include "trocar/session/runner.h"

#include <algorithm>
#include <atomic>
#include <thread>
#include <utility>
#include <vector>

#include "attempt_keeper.h"
#include "trocar/base/statistics.h"
#include "trocar/host/clock.h"
#include "trocar/host/newest_slot.h"
#include "trocar/host/real_time.h"

namespace trocar::session {

using simulation::InputSource;
using simulation::Simulation;
using simulation::Snapshot;

namespace {

/// The lowest real-time priority: above drawing, below a haptic loop. The simulation also runs without.
constexpr int kPriorityAboveLowest = 0;

}  // namespace

struct Runner::Content {
  Content(Simulation taken, InputSource& inputs, RunnerSettings settings)
      : simulation(std::move(taken)),
        source(inputs),
        haptics(settings.haptics),
        after_tick(std::move(settings.after_tick)),
        attempts(std::move(settings.keeping)) {}

  Simulation simulation;
  InputSource& source;
  HapticLink* haptics;
  std::function<void(const Snapshot&)> after_tick;
  host::NewestSlot<Snapshot> snapshot_slot;
  std::atomic<bool> is_stopping{false}, is_paused{true}, is_end_wanted{false};
  std::atomic<int> resets_wanted{0};
  std::atomic<double> speed{1};
  std::atomic<std::uint64_t> ticks{0}, late_ticks{0};
  std::atomic<double> tick_median{0}, tick_p99{0};
  std::atomic<bool> is_real_time{false};
  AttemptKeeper attempts;
  std::thread thread;

  void Publish() {
    snapshot_slot.Back() = simulation.GetSnapshot();
    snapshot_slot.Publish();
  }
  void PublishPatches() {
    if (haptics == nullptr || !haptics->is_used.load(std::memory_order_relaxed)) return;
    for (const instrument::Hand hand : {instrument::kLeft, instrument::kRight}) {
      simulation.CutPatch(hand, haptics->patches[hand].Back());
      haptics->patches[hand].Publish();
    }
  }
  void GoBack(int resets);
  void Tick();
  void Run();
};

/// To the first tick.
/// \param resets  that were asked for since the last time
void Runner::Content::GoBack(int resets) {
  attempts.End(simulation);
  attempts.Reopen();
  is_end_wanted.store(false, std::memory_order_relaxed);
  simulation.Reset();
  for (int i = 0; i < resets; ++i) source.Reset();
  Publish();
}

void Runner::Content::Tick() {
  const scene::Input input = source.For(simulation.GetSnapshot().tick + 1, simulation.GetSnapshot());
  // while a program moves the tools, nothing of theirs may be felt
  const bool is_felt = !source.IsDemonstration();
  if (speed.load(std::memory_order_relaxed) < 1.0) {
    attempts.End(simulation);
    attempts.Close();
  }
  attempts.BeforeStep(simulation, !is_felt);
  simulation.Step(input);
  attempts.AfterStep(input, simulation);
  source.AfterTick(simulation.GetSnapshot());
  if (after_tick) after_tick(simulation.GetSnapshot());
  if (is_felt) PublishPatches();
  Publish();
  ticks.fetch_add(1, std::memory_order_relaxed);
}

void Runner::Content::Run() {
  is_real_time.store(host::AskForRealTime(host::RealTimePolicy::kRoundRobin, kPriorityAboveLowest));
  const auto period = static_cast<std::int64_t>(1e9 * simulation.GetScene().tick_seconds);
  const auto window = static_cast<std::size_t>(1.0 / simulation.GetScene().tick_seconds);
  std::vector<double> durations;
  durations.reserve(window);
  int resets_done = 0;
  std::int64_t next = host::NowNanoseconds();
  while (!is_stopping.load(std::memory_order_relaxed)) {
    if (const int wanted = resets_wanted.load(std::memory_order_acquire); wanted != resets_done) {
      GoBack(wanted - resets_done);
      resets_done = wanted;
    }
    if (is_end_wanted.exchange(false, std::memory_order_relaxed)) {
      attempts.End(simulation);
      attempts.Close();
    }
    if (is_paused.load(std::memory_order_relaxed)) {
      source.Wait(simulation.GetSnapshot());
    } else {
      Tick();
      durations.push_back(simulation.GetSnapshot().tick_seconds);
      if (durations.size() == window) {
        tick_median.store(base::CalcPercentile(durations, 0.5), std::memory_order_relaxed);
        tick_p99.store(base::CalcPercentile(durations, 0.99), std::memory_order_relaxed);
        durations.clear();
      }
    }
    next += static_cast<std::int64_t>(static_cast<double>(period) / speed.load(std::memory_order_relaxed));
    const std::int64_t now = host::NowNanoseconds();
    if (now > next + period / 2) {
      // late: never a burst of ticks to catch up (faults D9)
      late_ticks.fetch_add(1, std::memory_order_relaxed);
      next = now;
      continue;
    }
    host::SleepUntil(next);
  }
  attempts.End(simulation);
}

Runner::Runner(Simulation simulation, InputSource& source, RunnerSettings settings)
    : content_(std::make_unique<Content>(std::move(simulation), source, std::move(settings))) {
  content_->Publish();
  content_->snapshot_slot.Update();
  content_->thread = std::thread([content = content_.get()] { content->Run(); });
}

Runner::~Runner() {
  content_->is_stopping.store(true);
  content_->thread.join();
}

void Runner::SetSpeed(double speed) {
  content_->speed.store(speed > kSlowest ? std::min(speed, 1.0) : kSlowest);
}
double Runner::GetSpeed() const {
  return content_->speed.load();
}
void Runner::SetPaused(bool is_paused) {
  content_->is_paused.store(is_paused);
}
bool Runner::IsPaused() const {
  return content_->is_paused.load();
}
void Runner::Reset() {
  content_->resets_wanted.fetch_add(1, std::memory_order_release);
}

void Runner::EndAttempt() {
  content_->is_end_wanted.store(true);
}

const Snapshot& Runner::Latest() {
  content_->snapshot_slot.Update();
  return content_->snapshot_slot.Front();
}

RunnerStatistics Runner::Statistics() const {
  return {content_->ticks.load(), content_->late_ticks.load(), content_->tick_median.load(),
          content_->tick_p99.load(), content_->is_real_time.load()};
}

std::optional<record::RecorderStatus> Runner::RecordingStatus() const {
  return content_->attempts.Status();
}

const scene::Scene& Runner::GetScene() const {
  return content_->simulation.GetScene();
}
std::span<const scene::SurfaceInfo> Runner::Surfaces() const {
  return content_->simulation.Surfaces();
}
std::span<const scene::StrandInfo> Runner::Strands() const {
  return content_->simulation.Strands();
}

}  // namespace trocar::session
