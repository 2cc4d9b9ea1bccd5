// SPDX-License-Identifier: Apache-2.0
/// \file record_and_replay.cpp  Records two seconds of a scene, plays them again, and goes on differently from the middle.
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>

#include <unistd.h>

#include "trocar/files/scene_file.h"
#include "trocar/record/recorder.h"
#include "trocar/record/replay.h"

namespace {

using namespace trocar;

int Complain(const base::Error& error) {
  std::fprintf(stderr, "%s\n", error.Text().c_str());
  return 1;
}

/// A script plays, and a file keeps it.
base::Status Record(const std::string& scene_file, const std::filesystem::path& file) {
  auto read = files::ReadScene(scene_file);
  if (!read.ok()) return read.error();
  const auto scene = std::make_shared<const scene::Scene>(std::move(*read));
  auto simulation = simulation::Simulation::Make(scene);
  if (!simulation.ok()) return simulation.error();
  record::Description description;
  description.name = scene_file;
  description.seed = scene->seed;
  description.player = "a script";
  record::RecorderSettings settings;
  settings.keyframe_seconds = 0.5;
  settings.waits = true;  // no person waits for a tick
  auto recorder = record::Recorder::Start(file, description, *simulation, settings);
  if (!recorder.ok()) return recorder.error();
  for (int tick = 0; tick < 240; ++tick) {
    const scene::Input input = scene::CalcScriptInput(*scene, simulation->GetSnapshot().time);
    simulation->Step(input);
    (*recorder)->Add(input, *simulation);
  }
  return (*recorder)->Finish(*simulation);
}

int Replay(const std::filesystem::path& file) {
  auto recording = record::ReadRecording(file);
  if (!recording.ok()) return Complain(recording.error());
  auto replay = record::Replay::Open(std::move(*recording), 1);
  if (!replay.ok()) return Complain(replay.error());
  const auto verified = replay->Verify();
  if (!verified.ok()) return Complain(verified.error());
  std::printf("%llu ticks replayed: %s\n", static_cast<unsigned long long>(verified->ticks),
              verified->IsVerified() ? "the same to the bit" : "something else");
  if (const auto status = replay->Seek(120); !status.ok()) return Complain(status.error());
  scene::Input input = replay->GetRecording().inputs[120];
  auto branch = replay->Branch(1);
  if (!branch.ok()) return Complain(branch.error());
  input.hands[instrument::kRight].depth -= 0.01;
  for (int tick = 0; tick < 60; ++tick) branch->Step(input);
  std::printf("taken over after 1 s and held back: the branch stands at %.2f s\n",
              branch->GetSnapshot().time);
  return 0;
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 2) {
    std::fprintf(stderr, "usage: %s scenes/demonstration.json\n", arguments[0]);
    return 2;
  }
  const auto file =
      std::filesystem::temp_directory_path() / ("sample_" + std::to_string(::getpid()) + ".trocar");
  const base::Status recorded = Record(arguments[1], file);
  const int status = recorded.ok() ? Replay(file) : Complain(recorded.error());
  std::filesystem::remove(file);
  return status;
}
