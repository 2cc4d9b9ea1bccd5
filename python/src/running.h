// SPDX-License-Identifier: Apache-2.0
/// \file running.h  A running simulation with its scene, and a running environment. Each may collect its attempt.
#pragma once

#include <memory>
#include <optional>
#include <utility>

#include "attempt.h"
#include "scene_source.h"
#include "trocar/environment/environment.h"
#include "trocar/simulation/simulation.h"

namespace trocar::python {

struct Running {
  std::shared_ptr<const scene::Scene> scene;
  simulation::Simulation simulation;
  PatientSource patient;
  std::optional<Attempt> attempt;  ///< where its metrics are wanted

  void Step(const scene::Input& input) {
    simulation.Step(input);
    if (attempt) attempt->Add(simulation, input);
  }
  void BeginAttempt() {
    if (attempt) attempt->Begin(simulation);
  }
};

/// An environment, and what the hands do in it; each episode is an attempt of its own.
struct RunningEnvironment {
  environment::Environment environment;
  std::unique_ptr<Attempt> attempt;  ///< where its metrics are wanted

  RunningEnvironment(environment::Environment made, bool has_metrics) : environment(std::move(made)) {
    if (!has_metrics) return;
    attempt = std::make_unique<Attempt>(environment.GetSimulation());
    environment.SetTickObserver(
        [attempt = attempt.get()](const simulation::Simulation& simulation, const scene::Input* input) {
          if (input == nullptr) {
            attempt->Begin(simulation);
          } else {
            attempt->Add(simulation, *input);
          }
        });
  }
  const simulation::Simulation& Simulation() const { return environment.GetSimulation(); }
};

}  // namespace trocar::python
