// SPDX-License-Identifier: Apache-2.0
// Steps a scene with the installed libraries and prints the hash of its state, as `trocar simulate --json` does.
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <utility>

#include "trocar/files/scene_file.h"
#include "trocar/simulation/simulation.h"

int main(int count, char** arguments) {
  using namespace trocar;
  if (count != 3) {
    std::fprintf(stderr, "usage: %s SCENE TICKS\n", arguments[0]);
    return 2;
  }
  auto read = files::ReadScene(arguments[1]);
  if (!read.ok()) {
    std::fprintf(stderr, "%s\n", read.error().Text().c_str());
    return 1;
  }
  const auto scene = std::make_shared<const scene::Scene>(std::move(*read));
  auto simulation = simulation::Simulation::Make(scene);
  if (!simulation.ok()) {
    std::fprintf(stderr, "%s\n", simulation.error().Text().c_str());
    return 1;
  }
  for (long tick = std::strtol(arguments[2], nullptr, 10); tick > 0; --tick) {
    simulation->Step(scene::CalcScriptInput(*scene, simulation->GetSnapshot().time));
  }
  std::printf("%016llx\n", static_cast<unsigned long long>(simulation->Hash()));
}
