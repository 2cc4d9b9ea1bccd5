// SPDX-License-Identifier: Apache-2.0
/// \file running.h  trocar.Simulation: one simulation with the scene that it is of.
#pragma once

#include <memory>
#include <optional>

#include "scene_source.h"
#include "trocar/record/trace.h"
#include "trocar/simulation/simulation.h"

namespace trocar::python {

struct Running {
  std::shared_ptr<const scene::Scene> scene;
  simulation::Simulation simulation;
  PatientSource patient;
  std::optional<record::TraceBuilder> trace;  ///< of the attempt, where its metrics are wanted

  void Step(const scene::Input& input) {
    simulation.Step(input);
    if (trace) trace->Add(simulation.GetSnapshot(), input.controls);
  }
  /// What the hands do from here on is another attempt.
  void BeginTrace() {
    trace.emplace(simulation);
    trace->Add(simulation.GetSnapshot());
  }
};

}  // namespace trocar::python
