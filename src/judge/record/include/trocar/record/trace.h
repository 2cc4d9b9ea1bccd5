// SPDX-License-Identifier: Apache-2.0
/// \file trace.h  From a simulation, running or replayed, to the plain values that metrics are computed from.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>

#include "trocar/base/result.h"
#include "trocar/record/recording.h"
#include "trocar/simulation/simulation.h"
#include "trocar/training/attempt_trace.h"

namespace trocar::record {

/// Collects an attempt, snapshot by snapshot. The same snapshots and controls give the same trace, whoever plays.
class TraceBuilder {
 public:
  /// Takes from the simulation what is constant, and nothing else.
  explicit TraceBuilder(const simulation::Simulation& simulation);
  TraceBuilder(TraceBuilder&&) noexcept;
  TraceBuilder& operator=(TraceBuilder&&) noexcept;
  ~TraceBuilder();

  /// Takes memory for an attempt of that length, so that Add does not copy what is there already.
  /// \param seconds  > 0
  void Reserve(double seconds);
  /// One tick: first the snapshot with which the attempt begins, then that after every tick. One of a tick that is there already,
  /// or of an earlier one, is left out; for ticks that were missed the last one is held, and counted.
  /// \param controls  that were given to the tick; of the first snapshot nothing
  /// \note Not real-time safe: allocates. A tick never calls it: whoever runs the simulation does, between ticks.
  void Add(const simulation::Snapshot& snapshot,
           const std::array<scene::HandControls, instrument::kHandCount>& controls = {});

  /// The attempt so far, as if it ended here.
  training::AttemptTrace Calc() const;
  std::uint64_t MissedTicks() const;

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

/// Replays a recording and collects it.
/// \param threads   of the solver; the trace is the same for any number
/// \param progress  called with the share done, 0 to 1; may be empty
/// \return as Replay::Open; kRecordingInvalid where it does not replay to the recorded states
base::Result<training::AttemptTrace> TraceRecording(Recording recording, int threads,
                                                    const std::function<void(double)>& progress = {});

}  // namespace trocar::record
