// SPDX-License-Identifier: Apache-2.0
/// \file metrics_of_a_recording.cpp  Records two seconds of a scene and measures them: while it runs, and from the recording.
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>

#include "trocar/files/scene_file.h"
#include "trocar/record/recorder.h"
#include "trocar/record/trace.h"
#include "trocar/training/attempt_metrics.h"
#include "trocar/training/metric_definition.h"

namespace {

using namespace trocar;

/// A script plays, and a file keeps it.
base::Result<training::AttemptTrace> PlayAndRecord(const std::string& scene_file,
                                                   const std::filesystem::path& file) {
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
  settings.waits = true;  // no person waits for a tick
  auto recorder = record::Recorder::Start(file, description, *simulation, settings);
  if (!recorder.ok()) return recorder.error();
  record::TraceBuilder live(*simulation);
  live.Add(simulation->GetSnapshot());
  for (int tick = 0; tick < 240; ++tick) {
    const scene::Input input = scene::CalcScriptInput(*scene, simulation->GetSnapshot().time);
    simulation->Step(input);
    (*recorder)->Add(input, *simulation);
    live.Add(simulation->GetSnapshot(), input.controls);
  }
  if (const auto finished = (*recorder)->Finish(*simulation); !finished.ok()) return finished.error();
  return live.Calc();
}

base::Status Measure(const std::string& scene_file, const std::filesystem::path& file) {
  const auto live = PlayAndRecord(scene_file, file);
  if (!live.ok()) return live.error();
  auto recording = record::ReadRecording(file);
  if (!recording.ok()) return recording.error();
  const auto replayed = record::TraceRecording(std::move(*recording), 1);
  if (!replayed.ok()) return replayed.error();
  const auto metrics = training::CalcAttemptMetrics(*replayed);
  if (!metrics.ok()) return metrics.error();
  for (const char* id : {"path_length", "movements", "sparc", "max_force"}) {
    const training::MetricDefinition* definition = training::FindMetric(id);
    for (const char* hand : {"left", "right"}) {
      if (const double* value = metrics->Find(id, hand)) {
        std::printf("%-6s %-24s %8.3f %s\n", hand, definition->name.c_str(), *value * definition->shown_scale,
                    definition->shown_unit.c_str());
      }
    }
  }
  const auto again = training::CalcAttemptMetrics(*live);
  std::printf("measured while it ran: %s\n",
              again.ok() && again->values == metrics->values ? "the same to the bit" : "something else");
  return {};
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 2) {
    std::fprintf(stderr, "usage: %s scenes/demonstration.json\n", arguments[0]);
    return 2;
  }
  const auto file =
      std::filesystem::temp_directory_path() / ("sample_metrics_" + std::to_string(::getpid()) + ".trocar");
  const base::Status measured = Measure(arguments[1], file);
  std::filesystem::remove(file);
  if (measured.ok()) return 0;
  std::fprintf(stderr, "%s\n", measured.error().Text().c_str());
  return 1;
}
