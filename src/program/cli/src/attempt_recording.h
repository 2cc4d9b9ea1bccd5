// SPDX-License-Identifier: Apache-2.0
/// \file attempt_recording.h  --record of the commands that run a simulation.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "trocar/record/recorder.h"

namespace CLI {  // NOLINT(readability-identifier-naming): CLI11 calls it so
class App;
}

namespace trocar::cli {

void AddRecordOption(CLI::App& command, std::string& path);

/// Paths are made absolute, so that the recording can be replayed from any folder.
record::Description Describe(record::Description::Kind kind, const std::string& name,
                             const std::string& patient, std::uint64_t seed, const std::string& player);

/// A recording of a run in which no person waits, or none.
class AttemptRecording {
 public:
  AttemptRecording() = default;
  /// \param path  empty: nothing is recorded
  static base::Result<AttemptRecording> Start(const std::string& path, const record::Description& description,
                                              const simulation::Simulation& simulation);
  void Add(const scene::Input& input, const simulation::Simulation& simulation) {
    if (recorder_ != nullptr) recorder_->Add(input, simulation);
  }
  base::Status Finish(const simulation::Simulation& simulation) {
    return recorder_ != nullptr ? recorder_->Finish(simulation) : base::Status();
  }

 private:
  std::unique_ptr<record::Recorder> recorder_;
};

}  // namespace trocar::cli
