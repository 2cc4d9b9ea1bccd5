// SPDX-License-Identifier: Apache-2.0
// Records a scene until it is killed, and says on standard output how many ticks are safe.
#include <cstdio>
#include <memory>

#include "trocar/files/scene_file.h"
#include "trocar/record/recorder.h"
#include "wandering_input.h"

int main(int argc, char** argv) {
  using namespace trocar;
  if (argc != 3) return 2;
  auto scene = files::ReadScene(argv[1]);
  if (!scene.ok()) return 3;
  const auto shared = std::make_shared<const scene::Scene>(std::move(*scene));
  auto simulation = simulation::Simulation::Make(shared);
  if (!simulation.ok()) return 3;
  record::Description description;
  description.name = argv[1];
  record::RecorderSettings settings;
  settings.keyframe_seconds = 0.5;
  settings.waits = true;
  auto recorder = record::Recorder::Start(argv[2], description, *simulation, settings);
  if (!recorder.ok()) return 4;
  const scene::Input home = scene::CalcScriptInput(*shared, 0);
  std::printf("0\n");
  std::fflush(stdout);
  for (std::uint64_t tick = 0, told = 0;; ++tick) {
    const scene::Input input = record::MakeWanderingInput(home, tick);
    simulation->Step(input);
    (*recorder)->Add(input, *simulation);
    if (const std::uint64_t kept = (*recorder)->Status().kept; kept != told) {
      told = kept;
      std::printf("%llu\n", static_cast<unsigned long long>(kept));
      std::fflush(stdout);
    }
  }
}
