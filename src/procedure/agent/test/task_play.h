// SPDX-License-Identifier: Apache-2.0
/// \file task_play.h  Reads a delivered task and lets a scripted surgeon do it.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>

#include "trocar/agent/surgeon.h"
#include "trocar/files/task_file.h"
#include "trocar/scene/task.h"
#include "trocar/simulation/simulation.h"

namespace trocar::agent {

/// A task of the program's own, by its name.
inline std::shared_ptr<scene::Scene> ReadDelivered(const std::string& key,
                                                   const files::TaskChoice& choice = {}) {
  const auto path = files::FindTask(key);
  EXPECT_TRUE(path.ok());
  auto scene = files::ReadTask(*path, choice);
  EXPECT_TRUE(scene.ok()) << scene.error().Text();
  return std::make_shared<scene::Scene>(std::move(*scene));
}

struct Played {
  scene::TaskSnapshot task;
  std::uint64_t hash = 0;
  double seconds = 0;
  std::string doing;
};

/// \param most_seconds  of simulated time
inline base::Result<Played> PlayTask(std::shared_ptr<const scene::Scene> scene, const char* name,
                                     std::uint64_t seed, double most_seconds = 400) {
  auto surgeon = MakeSurgeon(name, scene, seed);
  if (!surgeon.ok()) return surgeon.error();
  auto simulation = simulation::Simulation::Make(scene);
  if (!simulation.ok()) return simulation.error();
  while (!(*surgeon)->HasFinished() && simulation->GetSnapshot().time < most_seconds)
    simulation->Step((*surgeon)->Act(simulation->GetSnapshot()));
  const simulation::Snapshot& last = simulation->GetSnapshot();
  return Played{last.task, simulation->Hash(), last.time, std::string((*surgeon)->Doing())};
}

inline std::uint32_t CountErrors(const scene::Scene& scene, const scene::TaskSnapshot& task,
                                 const std::string& name) {
  for (std::size_t e = 0; e < scene.task->errors.size(); ++e) {
    if (scene.task->errors[e].name == name) return task.errors[e];
  }
  return 0;
}

}  // namespace trocar::agent
