// SPDX-License-Identifier: Apache-2.0
/// \file haptic_input.h  A haptic device's hands in place of a script's, with force, for runs without a window.
#pragma once

#include <CLI/App.hpp>
#include <memory>
#include <string>

#include "trocar/base/result.h"
#include "trocar/host/clock.h"
#include "trocar/session/haptic_loop.h"
#include "trocar/session/haptic_record.h"
#include "trocar/simulation/simulation.h"

namespace trocar::cli {

/// Options of force feedback on the command line.
struct HapticOptions {
  std::string name;        ///< as device::MakeForceDriver reads it; empty: none
  bool has_force = false;  ///< the person asks for force
  std::string record;      ///< file for what the force feedback did; empty: none
};
/// Adds --haptics, --force and --haptic-record.
void AddHapticOptions(CLI::App& command, HapticOptions& options);

/// Runs in real time. Force comes only where --force asked for it, once: when the check pose has been answered and all
/// safety switches are held. What takes it away then, takes it away for the rest of the run.
class HapticInput {
 public:
  /// \param simulation  before its first tick
  /// \return the device's error, kDeviceSettings or kHapticSupervisor
  static base::Result<std::unique_ptr<HapticInput>> Open(const HapticOptions& options,
                                                         const simulation::Simulation& simulation);

  /// Waits until `time` [s] has passed since Open().
  void Await(double time);
  /// The loop's end, for who puts hands together.
  session::HapticLink& Link() { return link_; }
  /// Gives the tissue round the tools to the loop.
  void AfterStep(simulation::Simulation& simulation);

  const session::HapticRecord& Record() const { return record_; }
  /// Writes the record where the options ask for it.
  /// \return kFileUnwritable
  base::Status SaveRecord() const;

 private:
  HapticInput() = default;
  void AskForForce(const session::HapticStatus& status);

  session::HapticLink link_;
  std::unique_ptr<session::HapticLoop> loop_;
  session::HapticRecord record_;
  host::Stopwatch since_start_;
  bool wants_force_ = false;
  std::string record_file_;
  std::string said_;
};

}  // namespace trocar::cli
