// SPDX-License-Identifier: Apache-2.0
#include "trocar/record/replay.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "state_index.h"
#include "trocar/base/to_integer.h"
#include "trocar/host/clock.h"
#include "trocar/host/threads.h"
#include "trocar/record/outcome.h"
#include "trocar/record/recording_source.h"
#include "trocar/simulation/engine_bits.h"
#include "trocar/simulation/saved_state.h"

namespace trocar::record {
namespace {

using simulation::Simulation;

/// Of the states that are kept of one recording.
constexpr std::uint64_t kIndexBytesInMemory = std::uint64_t{512} << 20;
constexpr std::uint64_t kIndexBytesOnDisk = std::uint64_t{2} << 30;
constexpr std::uint64_t kProgressTicks = 30;  // between two calls

base::Error Refuse(std::string why) {
  return {base::ErrorCode::kRecordingInvalid, std::move(why)};
}

}  // namespace

Replay::Replay(std::shared_ptr<const Recording> recording, Model model, Simulation simulation, int threads,
               double visit_seconds)
    : recording_(std::move(recording)),
      model_(std::move(model)),
      simulation_(std::move(simulation)),
      threads_(threads),
      visit_ticks_(visit_seconds > 0 ? TicksIn(visit_seconds) : 0) {}

std::uint64_t Replay::TicksIn(double seconds) const {
  return std::max<std::uint64_t>(
      1, base::RoundTo<std::uint64_t>(seconds / recording_->description.tick_seconds));
}

base::Result<Replay> Replay::Open(Recording recording, int threads) {
  ReplaySettings settings;
  settings.threads = threads;
  return Open(std::move(recording), settings);
}

base::Result<Replay> Replay::Open(Recording recording, const ReplaySettings& settings) {
  if (recording.description.engine_bits != simulation::kEngineBits) {
    const std::string own = std::to_string(recording.description.engine_bits);
    return Refuse("the recording is of engine " + own + " (Trocar " + recording.description.program +
                  "), which computes other last bits than this program's engine " +
                  std::to_string(simulation::kEngineBits) +
                  ", and would become another attempt here; replay and verify it with a program of engine " +
                  own);
  }
  auto scene = MakeScene(recording.description);
  if (!scene.ok()) return scene.error();
  auto model = simulation::MakeSimulationModel(std::make_shared<const scene::Scene>(std::move(*scene)),
                                               host::UseThreads(settings.threads));
  if (!model.ok()) return model.error();
  auto made =
      Simulation::Make(*model, {.threads = host::UseThreads(settings.threads), .now = host::NowNanoseconds});
  if (!made.ok()) return made.error();
  const Description& d = recording.description;
  if (made->ModelFingerprint(d.model_kind) != d.model) {
    return Refuse("the recording is of another state of \"" + d.name +
                  "\": its scene, patient or what this program makes of them has changed since " + d.started +
                  " (version " + d.program +
                  "); put the old files back, or use the version that recorded it");
  }
  if (d.first_tick > 0 &&
      (recording.KeyframeTicks().empty() || recording.KeyframeTicks().front() != d.first_tick))
    return Refuse("the recording begins in the middle and has lost the state from which it goes on");
  if (d.first_tick > 0) {
    const auto state = recording.ReadKeyframe(0);
    if (!state.ok()) return state.error();
    if (const auto restored = made->Restore(*state); !restored.ok())
      return Refuse("the state from which the recording goes on does not fit: " + restored.error().message);
  }
  auto shared = std::make_shared<const Recording>(std::move(recording));
  Replay replay(shared, std::move(*model), std::move(*made), settings.threads, settings.visit_seconds);
  std::vector<std::byte> first;
  replay.simulation_.Save(first);
  replay.first_ = std::make_shared<const std::vector<std::byte>>(std::move(first));
  replay.index_ = std::make_shared<StateIndex>(
      StateIndexSettings{settings.index, shared->file_id, shared->description.model,
                         settings.index.empty() ? kIndexBytesInMemory : kIndexBytesOnDisk});
  return replay;
}

base::Result<Replay> Replay::Another(double visit_seconds) const {
  auto made = Simulation::Make(model_, {.threads = host::UseThreads(threads_), .now = host::NowNanoseconds});
  if (!made.ok()) return made.error();
  Replay other(recording_, model_, std::move(*made), threads_, visit_seconds);
  other.first_ = first_;
  other.index_ = index_;
  if (const auto restored = other.simulation_.Restore(*first_); !restored.ok()) return restored.error();
  return other;
}

base::Result<Simulation> Replay::Branch(int threads) const {
  auto made = Simulation::Make(model_, {.threads = host::UseThreads(threads), .now = host::NowNanoseconds});
  if (!made.ok()) return made.error();
  std::vector<std::byte> state;
  simulation_.Save(state);
  if (const auto restored = made->Restore(state); !restored.ok()) return restored.error();
  return made;
}

void Replay::Keep() {
  // what is not the attempt helps nobody to find a moment of it
  if (divergence_ || index_->Has(Tick())) return;
  std::vector<std::byte> state;
  simulation_.Save(state);
  index_->Add(Tick(), state);
}

void Replay::Step() {
  if (IsAtEnd()) return;
  simulation_.Step(RecordingSource(recording_).For(Tick() + 1, simulation_.GetSnapshot()));
  const std::uint64_t tick = Tick();
  const auto& hashes = recording_->hashes;
  while (next_hash_ < hashes.size() && hashes[next_hash_].tick < tick) ++next_hash_;
  if (next_hash_ < hashes.size() && hashes[next_hash_].tick == tick && !divergence_) {
    if (const std::uint64_t computed = simulation_.Hash(); computed != hashes[next_hash_].hash)
      divergence_ = Divergence{tick, hashes[next_hash_].hash, computed};
  }
  if (visit_ticks_ != 0 && (tick - recording_->FirstTick()) % visit_ticks_ == 0) Keep();
}

std::vector<std::uint64_t> Replay::KnownTicks() const {
  std::vector<std::uint64_t> ticks = index_->Ticks();
  const auto& frames = recording_->KeyframeTicks();
  ticks.insert(ticks.end(), frames.begin(), frames.end());
  ticks.push_back(recording_->FirstTick());
  std::sort(ticks.begin(), ticks.end());
  ticks.erase(std::unique(ticks.begin(), ticks.end()), ticks.end());
  return ticks;
}

/// Stands at the newest known state before a tick, or stays where that is nearer.
base::Status Replay::GoTo(std::uint64_t tick) {
  const auto& frames = recording_->KeyframeTicks();
  for (;;) {
    const auto frame = std::upper_bound(frames.begin(), frames.end(), tick);
    const std::uint64_t keyframe = frame != frames.begin() ? *std::prev(frame) : 0;
    const std::uint64_t kept = index_->FindBefore(tick).value_or(0);
    const std::uint64_t best = std::max({keyframe, kept, recording_->FirstTick()});
    if (Tick() <= tick && Tick() >= best) return {};
    if (best == recording_->FirstTick()) return simulation_.Restore(*first_);
    if (best == keyframe) {
      const auto state = recording_->ReadKeyframe(static_cast<std::size_t>(frame - frames.begin()) - 1);
      if (!state.ok()) return state.error();
      if (const auto restored = simulation_.Restore(*state); !restored.ok())
        return Refuse("a keyframe of the recording does not fit: " + restored.error().message);
      return {};
    }
    const std::vector<std::byte> state = index_->Read(kept);
    if (!state.empty() && simulation_.Restore(state).ok() && Tick() == kept) return {};
    // damaged: what lies before it is tried next
    index_->Drop(kept);
  }
}

base::Status Replay::Seek(std::uint64_t tick, const GoOn& go_on) {
  tick = std::clamp(tick, recording_->FirstTick(), recording_->LastTick());
  if (const auto status = GoTo(tick); !status.ok()) return status;
  const auto& hashes = recording_->hashes;
  next_hash_ = static_cast<std::size_t>(
      std::upper_bound(hashes.begin(), hashes.end(), Tick(),
                       [](std::uint64_t at, const HashMark& mark) { return at < mark.tick; }) -
      hashes.begin());
  while (Tick() < tick) {
    Step();
    if (go_on && !go_on()) break;
  }
  return {};
}

bool Replay::KeepsStatesOnDisk() const {
  return index_->IsOnDisk();
}

base::Result<bool> Replay::FillGap(std::uint64_t tick, double seconds, const GoOn& go_on) {
  const std::uint64_t gap = TicksIn(seconds);
  std::vector<std::uint64_t> ticks = KnownTicks();
  ticks.push_back(recording_->LastTick());
  std::optional<std::uint64_t> first, next;
  for (std::size_t i = 0; i + 1 < ticks.size(); ++i) {
    if (ticks[i + 1] - ticks[i] <= gap) continue;
    if (!first) first = ticks[i];
    if (!next && ticks[i + 1] > tick) next = ticks[i];
  }
  const auto from = next ? next : first;
  if (!from) return false;
  if (const auto status = Seek(*from + gap, go_on); !status.ok()) return status.error();
  if (Tick() != *from + gap) return false;
  Keep();
  return index_->Has(Tick());
}

base::Status Replay::CompareAll(const std::function<bool(double)>& progress, const Watch& watch) {
  const auto count = static_cast<double>(std::max<std::size_t>(1, recording_->inputs.size()));
  std::size_t next_frame = 0;
  const auto& frames = recording_->KeyframeTicks();
  std::vector<std::byte> state;
  if (watch) watch(simulation_.GetSnapshot(), {});
  while (!IsAtEnd()) {
    const scene::Input& input = recording_->inputs[Tick() - recording_->FirstTick()];
    Step();
    if (watch) watch(simulation_.GetSnapshot(), input);
    if (progress && Tick() % kProgressTicks == 0 &&
        !progress(static_cast<double>(Tick() - recording_->FirstTick()) / count))
      return base::Error{base::ErrorCode::kCancelled, "the recording was not compared to its end"};
    while (next_frame < frames.size() && frames[next_frame] < Tick()) ++next_frame;
    if (next_frame == frames.size() || frames[next_frame] != Tick() || divergence_) continue;
    // a saved state that is not the one computed would be the wrong place to seek to
    const auto recorded = recording_->ReadKeyframe(next_frame);
    if (!recorded.ok()) return recorded.error();
    simulation_.Save(state);
    if (!simulation::AreSameState(state, *recorded)) divergence_ = Divergence{Tick(), 0, simulation_.Hash()};
  }
  return {};
}

bool Replay::IsEndingSame() const {
  TROCAR_ASSERT(IsAtEnd());
  const auto& ending = recording_->ending;
  return !ending || (ending->ticks == Tick() && ending->hash == simulation_.Hash() &&
                     ending->outcome == CalcOutcome(simulation_));
}

base::Result<Verification> Replay::Verify(const std::function<bool(double)>& progress, const Watch& watch) {
  if (const auto restored = simulation_.Restore(*first_); !restored.ok()) return restored.error();
  next_hash_ = 0;
  divergence_.reset();
  // to compare is not to look: nothing is kept
  const std::uint64_t visit_ticks = std::exchange(visit_ticks_, 0);
  const base::Status compared = CompareAll(progress, watch);
  visit_ticks_ = visit_ticks;
  if (!compared.ok()) return compared.error();
  Verification verification;
  verification.ticks = recording_->inputs.size();
  verification.hashes = recording_->hashes.size();
  verification.outcome = CalcOutcome(simulation_);
  if (const auto& ending = recording_->ending) {
    ++verification.hashes;
    if (const std::uint64_t hash = simulation_.Hash(); hash != ending->hash && !divergence_)
      divergence_ = Divergence{Tick(), ending->hash, hash};
    verification.is_outcome_same = verification.outcome == ending->outcome && ending->ticks == Tick();
  }
  verification.divergence = divergence_;
  return verification;
}

Description DescribeBranch(const Recording& from, const std::filesystem::path& path, std::uint64_t tick) {
  Description description = from.description;
  description.branched_from = path.filename().string();
  description.branched_id = from.file_id;
  description.branched_tick = tick;
  return description;
}

}  // namespace trocar::record
