// SPDX-License-Identifier: Apache-2.0
/// \file replay_runner.h  A recording that is followed on threads of its own: who looks says where to be, and never waits.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "trocar/record/replay.h"

namespace trocar::session {

struct ReplayRunnerSettings {
  /// In idle processor time the whole recording is computed once, and states are kept this far apart [s]; 0: it is not.
  double fill_seconds = record::kIndexSeconds;
};

/// Where a replay stands, and where it is to be.
struct ReplayStatus {
  std::uint64_t goal = 0;  ///< the newest wish
  std::uint64_t tick = 0;  ///< of the state that the thread has come to
  bool is_there = false;   ///< the goal is reached, and Latest() shows it
  double progress = 1;     ///< of the seek that runs [-], 0 to 1
  double known_share =
      0;  ///< of the recording that lies within `fill_seconds` after a kept state or keyframe [-]
  std::optional<record::Divergence> divergence;  ///< what was computed is not what was recorded
  std::optional<base::Error> failure;            ///< the goal cannot be reached
};

/// All members are called from one thread (the window's); none of them waits but the destructor, for the end of a tick.
class ReplayRunner {
 public:
  explicit ReplayRunner(record::Replay replay, ReplayRunnerSettings settings = {});
  ~ReplayRunner();
  ReplayRunner(const ReplayRunner&) = delete;
  ReplayRunner& operator=(const ReplayRunner&) = delete;

  /// Be there as soon as possible; a wish before it that is not yet fulfilled is dropped.
  /// \param tick  clamped to what was recorded
  void SeekTo(std::uint64_t tick);
  /// The newest state on the way, or at the goal; the reference stays valid until the next call.
  const simulation::Snapshot& Latest();
  ReplayStatus Status() const;

  /// One more simulation that stands at a moment, for somebody else to play on; TakeBranch() gives it once it is made. A
  /// SeekTo() elsewhere before that takes the wish back.
  /// \param threads  of its solver
  void AskForBranch(std::uint64_t tick, int threads);
  bool IsBranching() const;
  /// Simulation that was asked for, given once; nothing before it is there.
  std::optional<base::Result<simulation::Simulation>> TakeBranch();

  const record::Recording& GetRecording() const;
  const scene::Scene& GetScene() const;
  std::span<const scene::SurfaceInfo> Surfaces() const;
  std::span<const scene::StrandInfo> Strands() const;

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

}  // namespace trocar::session
