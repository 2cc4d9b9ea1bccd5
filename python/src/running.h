// SPDX-License-Identifier: Apache-2.0
/// \file running.h  trocar.Simulation: one simulation with the scene that it is of.
#pragma once

#include <memory>

#include "trocar/simulation/simulation.h"

namespace trocar::python {

struct Running {
  std::shared_ptr<const scene::Scene> scene;
  simulation::Simulation simulation;
};

}  // namespace trocar::python
