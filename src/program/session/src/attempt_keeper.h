// SPDX-License-Identifier: Apache-2.0
// Records each attempt of a running simulation to a file of its own.
#pragma once

#include <memory>
#include <mutex>
#include <optional>

#include "trocar/record/recorder.h"
#include "trocar/session/runner.h"

namespace trocar::session {

/// Called from the simulation's thread, Status from any.
class AttemptKeeper {
 public:
  /// \param keeping  nothing: no attempt is kept
  explicit AttemptKeeper(std::optional<AttemptKeeping> keeping) : keeping_(std::move(keeping)) {}

  /// Opens the file of a new attempt where none is open, and holds its first tick up for that long. Where it cannot be
  /// opened, that is logged once and the surgery goes on unrecorded.
  /// \param is_demonstration  nobody's own: it begins with the script or the expert
  void BeforeStep(const simulation::Simulation& simulation, bool is_demonstration);
  void AfterStep(const scene::Input& input, const simulation::Simulation& simulation) noexcept {
    if (recorder_ == nullptr) return;
    recorder_->Add(input, simulation);
    if (watch_.see) watch_.see(simulation.GetSnapshot(), input.controls);
  }
  /// The attempt is over: writes its ending. One that was hardly begun is taken away.
  void End(const simulation::Simulation& simulation);
  /// No attempt begins until it is opened again.
  void Close() { is_closed_ = true; }
  void Reopen() { is_closed_ = false; }

  std::optional<record::RecorderStatus> Status() const;

 private:
  std::optional<AttemptKeeping> keeping_;
  AttemptWatch watch_;        // of the attempt that is recorded
  mutable std::mutex mutex_;  // of what follows, where Status may look
  std::unique_ptr<record::Recorder> recorder_;
  std::optional<record::RecorderStatus> last_;
  bool has_failed_ = false, is_closed_ = false;
};

}  // namespace trocar::session
