// SPDX-License-Identifier: Apache-2.0
/// \file runner.h  The simulation on its own thread at its fixed rate; drawing never holds it up.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>

#include "trocar/record/recorder.h"
#include "trocar/session/haptic_loop.h"
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

/// Where attempts are kept, and what they are of.
struct AttemptKeeping {
  std::filesystem::path folder;     ///< made when the first attempt begins
  record::Description description;  ///< of the scene that runs
  /// Told of a file with an attempt that has just begun, and of one that is whole or cannot be. By the simulation's thread between
  /// two ticks: they hand over and return. May be empty.
  std::function<void(const std::filesystem::path&)> on_begin, on_end;
};

/// Owns the simulation thread. All members are called from one other thread (the window's).
class Runner {
 public:
  /// Starts paused.
  /// \param simulation  taken over
  /// \param haptics     nullptr, or the mailboxes of a haptic loop, which must outlive this: hands that it drives take
  ///                    the place of the input's, and every tick publishes their tissue
  /// \param keeping     nothing, or where each attempt is recorded: from its first tick to the reset or the end of this
  explicit Runner(simulation::Simulation simulation, HapticLink* haptics = nullptr,
                  std::optional<AttemptKeeping> keeping = {});
  ~Runner();
  Runner(const Runner&) = delete;
  Runner& operator=(const Runner&) = delete;

  /// The newest wish of the person; used from the next tick on until another comes.
  void SetInput(const scene::Input& input);
  /// true: the scene's script moves the hands and the input's hands are ignored. Where the scene has none, a scripted
  /// expert acts in the place of the input, from the next reset on; the settings stay the input's.
  void SetScripted(bool is_scripted);
  /// Whether there is a script, or an expert for this scene.
  bool HasScript() const;
  /// The script has come to its end, or the expert has done all there is to do.
  bool IsScriptOver() const;
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
