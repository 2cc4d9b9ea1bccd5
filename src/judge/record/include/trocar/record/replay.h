// SPDX-License-Identifier: Apache-2.0
/// \file replay.h  Plays a recording again to the bit, from any moment, and says where it would not.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/record/recording.h"
#include "trocar/simulation/simulation.h"

namespace trocar::record {

/// The state's hash is not the recorded one.
struct Divergence {
  std::uint64_t tick = 0;
  std::uint64_t recorded = 0, computed = 0;
};

struct Verification {
  std::uint64_t ticks = 0;               ///< replayed
  std::uint64_t hashes = 0;              ///< compared
  std::optional<Divergence> divergence;  ///< the first
  bool is_outcome_same = true;  ///< score, errors and all else of outcome.h; true where no ending is recorded
  std::string outcome;          ///< as computed
  bool IsVerified() const { return !divergence && is_outcome_same; }
};

struct ReplaySettings {
  int threads = 1;  ///< of the solver; the bits are the same for any number
  /// File of saved states (IndexPathOf), read and added to; empty, or where it cannot be written: they are kept in memory.
  std::filesystem::path index;
  double visit_seconds = 0.75;  ///< between the states that are kept of what is stepped [s]; 0: none are
};

class StateIndex;

/// A recording and a simulation that follows it.
class Replay {
 public:
  /// Asked between ticks of a long seek; false ends it where it stands.
  using GoOn = std::function<bool()>;

  /// Makes the scene, and stands at the recording's first tick.
  /// \return the scene's error; kRecordingInvalid where the scene, patient or program is not what was recorded
  static base::Result<Replay> Open(Recording recording, const ReplaySettings& settings);
  static base::Result<Replay> Open(Recording recording, int threads);
  /// One more of the same recording, with the same saved states, for another thread.
  /// \param visit_seconds  as in ReplaySettings
  base::Result<Replay> Another(double visit_seconds) const;

  const Recording& GetRecording() const { return *recording_; }
  const simulation::Simulation& GetSimulation() const { return simulation_; }
  std::uint64_t Tick() const { return simulation_.GetSnapshot().tick; }
  bool IsAtEnd() const { return Tick() >= recording_->LastTick(); }

  /// The next recorded tick; nothing at the end. Compares the hash where one was recorded.
  void Step();
  /// To just after that tick: from the nearest state before it, recorded or kept, and then tick after tick.
  /// \param tick   clamped to what was recorded
  /// \param go_on  may be empty
  /// \return kRecordingInvalid where a keyframe cannot be restored
  base::Status Seek(std::uint64_t tick, const GoOn& go_on = {});
  /// Ticks from which Seek can go on, ascending: the first one, keyframes and kept states.
  std::vector<std::uint64_t> KnownTicks() const;
  /// Computes and keeps one state in a gap between known ones that is longer than `seconds`: the next gap after `tick`, or
  /// else the first one. \return false where there is none, or go_on said so
  base::Result<bool> FillGap(std::uint64_t tick, double seconds, const GoOn& go_on = {});
  /// Whether kept states outlive this: the index can be written.
  bool KeepsStatesOnDisk() const;
  /// The first hash that was not the recorded one since Open, in the ticks that were stepped.
  const std::optional<Divergence>& GetDivergence() const { return divergence_; }

  /// Sees each state that is computed, the first one with the inputs of nobody.
  using Watch = std::function<void(const simulation::Snapshot&, const scene::Input&)>;
  /// From the first tick to the last, comparing hashes, keyframes and outcome. Uses no kept state.
  /// \param progress  told the share done, 0 to 1; false gives up; may be empty
  /// \return kCancelled where progress gave up; a keyframe's error
  base::Result<Verification> Verify(const std::function<bool(double)>& progress = {},
                                    const Watch& watch = {});
  /// Whether the ending is what was computed, hash and outcome; true where none is recorded.
  /// \pre IsAtEnd()
  bool IsEndingSame() const;

  /// Takes over here: one more simulation that stands where this one does, to be played on by somebody else.
  /// \param threads  of its solver
  base::Result<simulation::Simulation> Branch(int threads) const;

 private:
  using Model = std::shared_ptr<const simulation::SimulationModel>;
  Replay(std::shared_ptr<const Recording> recording, Model model, simulation::Simulation simulation,
         int threads, double visit_seconds);
  base::Status GoTo(std::uint64_t tick);
  base::Status CompareAll(const std::function<bool(double)>& progress, const Watch& watch);
  void Keep();
  std::uint64_t TicksIn(double seconds) const;

  std::shared_ptr<const Recording> recording_;  // also of Another
  Model model_;
  simulation::Simulation simulation_;
  int threads_ = 1;
  std::uint64_t visit_ticks_ = 0;
  std::shared_ptr<StateIndex> index_;                    // also of Another
  std::shared_ptr<const std::vector<std::byte>> first_;  // state of the first tick
  std::size_t next_hash_ = 0;
  std::optional<Divergence> divergence_;
};

/// Of a recording that goes on from a moment of another: of the same scene, and it says from where it branched.
/// \param path  of that recording
Description DescribeBranch(const Recording& from, const std::filesystem::path& path, std::uint64_t tick);

}  // namespace trocar::record
