// SPDX-License-Identifier: Apache-2.0
#include "trocar/record/replay.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "trocar/record/outcome.h"

namespace trocar::record {
namespace {

using simulation::Simulation;

/// Between states that are kept of what was visited.
constexpr double kVisitSeconds = 1;
/// Of all of them together; beyond it every second one goes, and the rest lie twice as far apart.
constexpr std::size_t kVisitBytes = std::size_t{512} << 20;

core::Error Refuse(std::string why) {
  return {core::ErrorCode::kRecordingInvalid, std::move(why)};
}

}  // namespace

Replay::Replay(Recording recording, Simulation simulation)
    : recording_(std::move(recording)),
      simulation_(std::move(simulation)),
      visit_ticks_(std::max<std::uint64_t>(
          1, static_cast<std::uint64_t>(std::llround(kVisitSeconds / recording_.description.tick_seconds)))) {
}

core::Result<Replay> Replay::Open(Recording recording, int threads) {
  auto scene = MakeScene(recording.description);
  if (!scene.ok()) return scene.error();
  auto made = Simulation::Make(std::make_shared<const scene::Scene>(std::move(*scene)), threads);
  if (!made.ok()) return made.error();
  const Description& d = recording.description;
  if (made->ModelFingerprint() != d.model) {
    return Refuse("the recording is of another state of \"" + d.name +
                  "\": its scene, patient or what this program makes of them has changed since " + d.started +
                  " (version " + d.program +
                  "); put the old files back, or use the version that recorded it");
  }
  if (d.first_tick > 0 &&
      (recording.KeyframeTicks().empty() || recording.KeyframeTicks().front() != d.first_tick))
    return Refuse("the recording begins in the middle and has lost the state from which it goes on");
  Replay replay(std::move(recording), std::move(*made));
  if (d.first_tick > 0) {
    if (const auto status = replay.Seek(replay.recording_.FirstTick()); !status.ok()) return status.error();
  }
  replay.Remember();
  return replay;
}

void Replay::Remember() {
  const std::uint64_t tick = Tick();
  auto place = std::lower_bound(visited_.begin(), visited_.end(), tick,
                                [](const Visited& state, std::uint64_t at) { return state.tick < at; });
  if (place != visited_.end() && place->tick == tick) return;
  place = visited_.insert(place, {tick, {}});
  simulation_.Save(place->state);
  std::size_t bytes = 0;
  for (const Visited& state : visited_) bytes += state.state.size();
  if (bytes <= kVisitBytes) return;
  visit_ticks_ *= 2;
  const std::uint64_t first = recording_.FirstTick();
  std::erase_if(visited_, [&](const Visited& state) { return (state.tick - first) % visit_ticks_ != 0; });
}

void Replay::Step() {
  if (IsAtEnd()) return;
  simulation_.Step(recording_.inputs[Tick() - recording_.FirstTick()]);
  const std::uint64_t tick = Tick();
  const auto& hashes = recording_.hashes;
  while (next_hash_ < hashes.size() && hashes[next_hash_].tick < tick) ++next_hash_;
  if (next_hash_ < hashes.size() && hashes[next_hash_].tick == tick && !divergence_) {
    if (const std::uint64_t computed = simulation_.Hash(); computed != hashes[next_hash_].hash)
      divergence_ = Divergence{tick, hashes[next_hash_].hash, computed};
  }
  if ((tick - recording_.FirstTick()) % visit_ticks_ == 0) Remember();
}

core::Status Replay::Seek(std::uint64_t tick) {
  tick = std::clamp(tick, recording_.FirstTick(), recording_.LastTick());
  const auto& frames = recording_.KeyframeTicks();
  const auto frame = std::upper_bound(frames.begin(), frames.end(), tick);
  const auto visit = std::upper_bound(visited_.begin(), visited_.end(), tick,
                                      [](std::uint64_t at, const Visited& state) { return at < state.tick; });
  // the first tick has been visited, so that there is always a state to go on from
  const bool is_behind = Tick() > tick;
  const std::uint64_t visited = visit != visited_.begin() ? std::prev(visit)->tick : 0;
  const std::uint64_t best = is_behind ? visited : std::max(visited, Tick());
  if (frame != frames.begin() && *std::prev(frame) > best) {
    const auto state = recording_.ReadKeyframe(static_cast<std::size_t>(frame - frames.begin()) - 1);
    if (!state.ok()) return state.error();
    if (const auto restored = simulation_.Restore(*state); !restored.ok())
      return Refuse("a keyframe of the recording does not fit: " + restored.error().message);
  } else if (visit != visited_.begin() && (is_behind || visited > Tick())) {
    if (const auto restored = simulation_.Restore(std::prev(visit)->state); !restored.ok()) return restored;
  }
  const auto& hashes = recording_.hashes;
  next_hash_ = static_cast<std::size_t>(
      std::upper_bound(hashes.begin(), hashes.end(), Tick(),
                       [](std::uint64_t at, const HashMark& mark) { return at < mark.tick; }) -
      hashes.begin());
  while (Tick() < tick) Step();
  return {};
}

core::Result<Verification> Replay::Verify(const std::function<void(double)>& progress) {
  if (const auto status = Seek(recording_.FirstTick()); !status.ok()) return status.error();
  divergence_.reset();
  const auto count = static_cast<double>(std::max<std::size_t>(1, recording_.inputs.size()));
  std::size_t next_frame = 0;
  const auto& frames = recording_.KeyframeTicks();
  std::vector<std::byte> state;
  while (!IsAtEnd()) {
    Step();
    if (progress && Tick() % 30 == 0) progress(static_cast<double>(Tick() - recording_.FirstTick()) / count);
    while (next_frame < frames.size() && frames[next_frame] < Tick()) ++next_frame;
    if (next_frame == frames.size() || frames[next_frame] != Tick() || divergence_) continue;
    // a saved state that is not the one computed would be the wrong place to seek to
    const auto recorded = recording_.ReadKeyframe(next_frame);
    if (!recorded.ok()) return recorded.error();
    simulation_.Save(state);
    if (state != *recorded) divergence_ = Divergence{Tick(), 0, simulation_.Hash()};
  }
  Verification verification;
  verification.ticks = recording_.inputs.size();
  verification.hashes = recording_.hashes.size();
  verification.outcome = CalcOutcome(simulation_);
  if (const auto& ending = recording_.ending) {
    ++verification.hashes;
    if (const std::uint64_t hash = simulation_.Hash(); hash != ending->hash && !divergence_)
      divergence_ = Divergence{Tick(), ending->hash, hash};
    verification.is_outcome_same = verification.outcome == ending->outcome;
  }
  verification.divergence = divergence_;
  return verification;
}

}  // namespace trocar::record
