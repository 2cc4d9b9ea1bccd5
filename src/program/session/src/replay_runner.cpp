// SPDX-License-Identifier: Apache-2.0
#include "trocar/session/replay_runner.h"

#include <pthread.h>
#include <sched.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <utility>

#include "trocar/host/log.h"
#include "trocar/host/newest_slot.h"

namespace trocar::session {
namespace {

using record::Replay;
using simulation::Simulation;
using simulation::Snapshot;

/// A state on the way that lies nearer to the goal than this is shown: who plays faster than the computer sees it run [s].
constexpr double kNear = 1;

/// Computes only while nobody else wants the processor.
void BecomeIdle() {
  const sched_param none{};
  // a system that does not know the policy lets the thread run as any other
  static_cast<void>(::pthread_setschedparam(::pthread_self(), SCHED_IDLE, &none));
}

}  // namespace

struct ReplayRunner::Content {
  Content(Replay opened, ReplayRunnerSettings wanted)
      : replay(std::move(opened)),
        settings(wanted),
        near_ticks(static_cast<std::uint64_t>(kNear / replay.GetRecording().description.tick_seconds)),
        goal(replay.Tick()),
        tick(replay.Tick()) {}

  Replay replay;  // of the following thread, once that runs
  ReplayRunnerSettings settings;
  std::uint64_t near_ticks;
  host::NewestSlot<Snapshot> slot;
  std::atomic<std::uint64_t> goal, tick;
  std::atomic<std::uint64_t> seek_from{0};
  std::atomic<double> known_share{0};
  std::atomic<bool> is_stopping{false}, is_there{true};

  mutable std::mutex mutex;  // of what follows
  std::condition_variable wake;
  std::optional<record::Divergence> divergence;
  std::optional<base::Error> failure;
  struct BranchWish {
    std::uint64_t tick = 0;
    int threads = 1;
  };
  std::optional<BranchWish> branch_wish;
  bool is_branching = false;
  std::optional<base::Result<Simulation>> branch;
  std::thread follower, filler;

  void Publish() {
    slot.Back() = replay.GetSimulation().GetSnapshot();
    slot.Publish();
  }
  bool IsWanted() const { return branch_wish.has_value() || goal.load() != tick.load() || !is_there.load(); }
  void Follow();
  void SeekTo(std::uint64_t wanted);
  void Branch(const BranchWish& wish);
  void Fill();
  void CalcKnownShare(const Replay& known);
};

void ReplayRunner::Content::SeekTo(std::uint64_t wanted) {
  seek_from.store(std::min(tick.load(), wanted));
  bool is_first = true;
  const auto status = replay.Seek(wanted, [&] {
    const std::uint64_t now = replay.Tick();
    if (is_first) seek_from.store(now), is_first = false;
    tick.store(now);
    return goal.load() == wanted && !is_stopping.load();
  });
  const std::uint64_t now = replay.Tick();
  // the goal may be another one by now, and just where it stands
  const bool is_shown = now == goal.load() || (now < wanted && wanted - now < near_ticks);
  if (is_shown) Publish();
  const std::lock_guard lock(mutex);
  divergence = replay.GetDivergence();
  if (!status.ok()) {
    // there is no use in trying it again
    failure = status.error();
    goal.store(now);
    host::Log(host::LogLevel::kWarning, "the replay cannot go there: " + status.error().Text());
  }
  tick.store(now);
  is_there.store(is_shown && goal.load() == now);
}

void ReplayRunner::Content::Branch(const BranchWish& wish) {
  goal.store(wish.tick);
  while (!is_stopping.load() && replay.Tick() != wish.tick && goal.load() == wish.tick) SeekTo(wish.tick);
  std::optional<base::Result<Simulation>> made;
  if (replay.Tick() == wish.tick) made.emplace(replay.Branch(wish.threads));
  const std::lock_guard lock(mutex);
  branch = std::move(made);
  is_branching = false;
}

void ReplayRunner::Content::Follow() {
  while (!is_stopping.load()) {
    std::optional<BranchWish> wish;
    {
      std::unique_lock lock(mutex);
      wake.wait(lock, [&] { return is_stopping.load() || IsWanted(); });
      wish = std::exchange(branch_wish, std::nullopt);
    }
    if (is_stopping.load()) return;
    if (wish) {
      Branch(*wish);
    } else {
      SeekTo(goal.load());
    }
  }
}

void ReplayRunner::Content::CalcKnownShare(const Replay& known) {
  const record::Recording& recording = known.GetRecording();
  if (recording.inputs.empty()) return known_share.store(1);
  const auto reach =
      static_cast<std::uint64_t>(settings.fill_seconds / recording.description.tick_seconds + 0.5);
  std::vector<std::uint64_t> ticks = known.KnownTicks();
  ticks.push_back(recording.LastTick());
  std::uint64_t covered = 0;
  for (std::size_t i = 0; i + 1 < ticks.size(); ++i) covered += std::min(reach, ticks[i + 1] - ticks[i]);
  known_share.store(static_cast<double>(covered) / static_cast<double>(recording.inputs.size()));
}

void ReplayRunner::Content::Fill() {
  BecomeIdle();
  auto other = replay.Another(0);
  if (!other.ok()) return host::Log(host::LogLevel::kWarning, "seeking stays slow: " + other.error().Text());
  CalcKnownShare(*other);
  while (!is_stopping.load()) {
    const auto filled =
        other->FillGap(tick.load(), settings.fill_seconds, [this] { return !is_stopping.load(); });
    CalcKnownShare(*other);
    if (!filled.ok() || !*filled) return;
  }
}

ReplayRunner::ReplayRunner(record::Replay replay, ReplayRunnerSettings settings)
    : content_(std::make_unique<Content>(std::move(replay), settings)) {
  Content* content = content_.get();
  content->Publish();
  content->slot.Update();
  content->divergence = content->replay.GetDivergence();
  if (settings.fill_seconds > 0) content->filler = std::thread([content] { content->Fill(); });
  content->follower = std::thread([content] { content->Follow(); });
}

ReplayRunner::~ReplayRunner() {
  {
    const std::lock_guard lock(content_->mutex);
    content_->is_stopping.store(true);
  }
  content_->wake.notify_all();
  content_->follower.join();
  if (content_->filler.joinable()) content_->filler.join();
}

void ReplayRunner::SeekTo(std::uint64_t tick) {
  Content& c = *content_;
  tick = std::clamp(tick, GetRecording().FirstTick(), GetRecording().LastTick());
  {
    const std::lock_guard lock(c.mutex);
    if (c.goal.load() == tick) return;
    c.goal.store(tick);
    c.failure.reset();
    if (tick != c.tick.load()) c.is_there.store(false);
  }
  c.wake.notify_one();
}

const Snapshot& ReplayRunner::Latest() {
  content_->slot.Update();
  return content_->slot.Front();
}

ReplayStatus ReplayRunner::Status() const {
  const Content& c = *content_;
  const std::lock_guard lock(c.mutex);
  ReplayStatus status;
  status.goal = c.goal.load();
  status.tick = c.tick.load();
  status.is_there = c.is_there.load();
  const std::uint64_t from = c.seek_from.load();
  if (!status.is_there) {
    status.progress =
        status.goal > from && status.tick > from
            ? std::min(1.0, static_cast<double>(status.tick - from) / static_cast<double>(status.goal - from))
            : 0.0;
  }
  status.known_share = c.known_share.load();
  status.divergence = c.divergence;
  status.failure = c.failure;
  return status;
}

void ReplayRunner::AskForBranch(std::uint64_t tick, int threads) {
  Content& c = *content_;
  {
    const std::lock_guard lock(c.mutex);
    if (c.is_branching || c.branch) return;
    c.is_branching = true;
    tick = std::clamp(tick, GetRecording().FirstTick(), GetRecording().LastTick());
    c.branch_wish = Content::BranchWish{tick, threads};
    c.goal.store(tick);
  }
  c.wake.notify_one();
}

bool ReplayRunner::IsBranching() const {
  const std::lock_guard lock(content_->mutex);
  return content_->is_branching;
}

std::optional<base::Result<Simulation>> ReplayRunner::TakeBranch() {
  const std::lock_guard lock(content_->mutex);
  return std::exchange(content_->branch, std::nullopt);
}

const record::Recording& ReplayRunner::GetRecording() const {
  return content_->replay.GetRecording();
}
const scene::Scene& ReplayRunner::GetScene() const {
  return content_->replay.GetSimulation().GetScene();
}
std::span<const scene::SurfaceInfo> ReplayRunner::Surfaces() const {
  return content_->replay.GetSimulation().Surfaces();
}
std::span<const scene::StrandInfo> ReplayRunner::Strands() const {
  return content_->replay.GetSimulation().Strands();
}

}  // namespace trocar::session
