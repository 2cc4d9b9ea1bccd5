// SPDX-License-Identifier: Apache-2.0
/// \file runner.h  The simulation on its own thread at its fixed rate; drawing never holds it up.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>

#include "trocar/record/recorder.h"
#include "trocar/session/haptic_loop.h"
#include "trocar/simulation/input_source.h"
#include "trocar/simulation/simulation.h"

namespace trocar::session {

/// Counters since the start; the clock decides when a tick runs, never what it computes.
struct RunnerStatistics {
  std::uint64_t ticks = 0;
  std::uint64_t late_ticks = 0;  ///< started more than half a tick late
  double tick_median = 0;        ///< over the last second [s]
  double tick_p99 = 0;           ///< over the last second [s]
  /// The system let the simulation thread run before ordinary threads (SCHED_RR), so that drawing on the same
  /// cores cannot delay a tick. `trocar doctor` says how to allow it.
  bool is_real_time = false;
};

/// Sees an attempt while it is played. Called by the simulation's thread between two ticks; either may be empty.
struct AttemptWatch {
  /// After each tick that is recorded.
  /// \param controls  that were given to the tick
  std::function<void(const simulation::Snapshot& now,
                     const std::array<scene::HandControls, instrument::kHandCount>& controls)>
      see;
  /// The attempt is over, before AttemptKeeping::on_end.
  /// \param is_whole  the recording has every tick that was seen
  std::function<void(bool is_whole)> end;
};

/// Where attempts are kept, and what they are of.
struct AttemptKeeping {
  std::filesystem::path folder;     ///< made when the first attempt begins
  record::Description description;  ///< of the scene that runs
  /// Told of a file with an attempt that has just begun, and of one that is whole or cannot be. By the simulation's thread between
  /// two ticks: they hand over and return. May be empty.
  std::function<void(const std::filesystem::path&)> on_begin, on_end;
  /// Asked, after on_begin, who watches the attempt that begins where the simulation stands. May be empty.
  std::function<AttemptWatch(const std::filesystem::path&, const simulation::Simulation&)> watch{};
};

struct RunnerSettings {
  /// nullptr, or the mailboxes of a haptic loop, which outlive the runner: every tick publishes the tissue round the tools.
  HapticLink* haptics = nullptr;
  /// Nothing, or where each attempt is recorded: from its first tick to the reset or the end of the runner.
  std::optional<AttemptKeeping> keeping{};
  /// Given the state after each tick, by the simulation's thread, before Latest() shows it: hands it over and returns. May be
  /// empty.
  std::function<void(const simulation::Snapshot&)> after_tick{};
};

/// Owns the simulation thread. All members are called from one other thread (the window's).
class Runner {
 public:
  /// Starts paused.
  /// \param simulation  taken over
  /// \param source      of each tick's input; outlives this, and is called by the simulation's thread alone
  Runner(simulation::Simulation simulation, simulation::InputSource& source, RunnerSettings settings = {});
  ~Runner();
  Runner(const Runner&) = delete;
  Runner& operator=(const Runner&) = delete;

  /// Slow motion: simulated seconds in a second of the clock, at most 1. An attempt that was slowed down is practice: what is
  /// recorded of it ends there, and nothing more is recorded before a reset at full speed.
  /// \param speed  clamped to kSlowest and 1
  void SetSpeed(double speed);
  double GetSpeed() const;
  static constexpr double kSlowest = 0.1;
  void SetPaused(bool is_paused);
  bool IsPaused() const;
  /// Back to tick 0; keeps paused or running.
  void Reset();
  /// Ends the recording with the tick that is being made; the simulation goes on unrecorded until the next reset.
  void EndAttempt();

  /// The newest state; the reference stays valid until the next call.
  const simulation::Snapshot& Latest();
  RunnerStatistics Statistics() const;
  /// Of the attempt that runs or ran last; nothing before the first one, or where none are kept.
  std::optional<record::RecorderStatus> RecordingStatus() const;
  const scene::Scene& GetScene() const;
  std::span<const scene::SurfaceInfo> Surfaces() const;
  std::span<const scene::StrandInfo> Strands() const;

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

}  // namespace trocar::session
