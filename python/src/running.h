// SPDX-License-Identifier: Apache-2.0
/// \file running.h  trocar.Simulation: one simulation with the scene that it is of.
#pragma once

#include <memory>
#include <optional>

#include "attempt.h"
#include "scene_source.h"
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

}  // namespace trocar::python
