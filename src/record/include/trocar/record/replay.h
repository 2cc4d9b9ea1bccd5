// SPDX-License-Identifier: Apache-2.0
/// \file replay.h  Plays a recording again to the bit, from any moment, and says where it would not.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "trocar/core/result.h"
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

/// A recording and a simulation that follows it.
class Replay {
 public:
  /// Makes the scene, and stands at the recording's first tick.
  /// \param threads  of the solver; the bits are the same for any number
  /// \return the scene's error; kRecordingInvalid where the scene, patient or program is not what was recorded
  static core::Result<Replay> Open(Recording recording, int threads);

  const Recording& GetRecording() const { return recording_; }
  const simulation::Simulation& GetSimulation() const { return simulation_; }
  std::uint64_t Tick() const { return simulation_.GetSnapshot().tick; }
  bool IsAtEnd() const { return Tick() >= recording_.LastTick(); }

  /// The next recorded tick; nothing at the end. Compares the hash where one was recorded.
  void Step();
  /// To just after that tick: from the nearest state before it, recorded or visited, and then tick after tick.
  /// \param tick  clamped to what was recorded
  /// \return kRecordingInvalid where no state before it can be restored
  core::Status Seek(std::uint64_t tick);
  /// The first hash that was not the recorded one since Open, in the ticks that were stepped.
  const std::optional<Divergence>& GetDivergence() const { return divergence_; }

  /// From the first tick to the last, comparing hashes, keyframes and outcome.
  /// \param progress  called with the share done, 0 to 1; may be empty
  core::Result<Verification> Verify(const std::function<void(double)>& progress = {});

  /// Takes over here: the simulation as it stands, to be played on by somebody else.
  simulation::Simulation Branch() && { return std::move(simulation_); }

 private:
  Replay(Recording recording, simulation::Simulation simulation);
  void Remember();

  /// States that were visited, so that going back is quick; thinned out where they become too many.
  struct Visited {
    std::uint64_t tick = 0;
    std::vector<std::byte> state;
  };

  Recording recording_;
  simulation::Simulation simulation_;
  std::vector<Visited> visited_;  // ascending
  std::uint64_t visit_ticks_ = 0;
  std::size_t next_hash_ = 0;
  std::optional<Divergence> divergence_;
};

}  // namespace trocar::record
