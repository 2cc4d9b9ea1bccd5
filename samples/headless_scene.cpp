// SPDX-License-Identifier: Apache-2.0
/// \file headless_scene.cpp  A scene without pictures: plays its script and prints what happens.
#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>

#include "trocar/files/scene_file.h"
#include "trocar/simulation/simulation.h"

int main(int count, char** arguments) {
  using namespace trocar;
  if (count != 2) {
    std::fprintf(stderr, "usage: %s scenes/demonstration.json\n", arguments[0]);
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
  std::uint64_t printed = 0;
  while (simulation->GetSnapshot().time < scene->script.Duration()) {
    simulation->Step(scene::CalcScriptInput(*scene, simulation->GetSnapshot().time));
    const simulation::Snapshot& now = simulation->GetSnapshot();
    for (; printed < now.event_count; ++printed) {
      const scene::Event& event = now.events[printed % now.events.size()];
      std::printf("%6.2f s  %s hand: %s, %.2f N\n", now.time,
                  event.hand == instrument::kLeft ? "left" : "right",
                  std::string(surgery::FactName(event.kind)).c_str(), event.force);
    }
  }
}
