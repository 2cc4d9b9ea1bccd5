// SPDX-License-Identifier: Apache-2.0
#include "attempt_recording.h"

#include <CLI/App.hpp>
#include <system_error>
#include <utility>

namespace trocar::cli {
namespace {

/// Of what is a file or folder here; a name stays a name.
std::string Absolute(const std::string& name) {
  std::error_code failure;
  if (name.empty() || !std::filesystem::exists(name, failure)) return name;
  const auto path = std::filesystem::absolute(name, failure);
  return failure ? name : path.lexically_normal().string();
}

}  // namespace

void AddRecordOption(CLI::App& command, std::string& path) {
  command
      .add_option(
          "--record", path,
          "Write a recording while it runs: every input, with hashes and saved states; see trocar replay")
      ->type_name("FILE");
}

record::Description Describe(record::Description::Kind kind, const std::string& name,
                             const std::string& patient, std::uint64_t seed, const std::string& player) {
  record::Description description;
  description.kind = kind;
  description.name = Absolute(name);
  description.patient = Absolute(patient);
  description.seed = seed;
  description.player = player;
  return description;
}

base::Result<AttemptRecording> AttemptRecording::Start(const std::string& path,
                                                       const record::Description& description,
                                                       const simulation::Simulation& simulation) {
  AttemptRecording recording;
  if (path.empty()) return recording;
  record::RecorderSettings settings;
  settings.waits = true;
  auto recorder = record::Recorder::Start(path, description, simulation, std::move(settings));
  if (!recorder.ok()) return recorder.error();
  recording.recorder_ = std::move(*recorder);
  return recording;
}

}  // namespace trocar::cli
