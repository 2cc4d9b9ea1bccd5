// SPDX-License-Identifier: Apache-2.0
/// \file branch.h  A moment of a recording from which somebody goes on.
#pragma once

#include "trocar/record/recording.h"
#include "trocar/simulation/simulation.h"

namespace trocar::presenter {

struct Branch {
  simulation::Simulation simulation;  ///< stands at that moment
  record::Description description;    ///< of the recording that begins with it
  scene::Input last;                  ///< of the tick before
  bool is_experts = false;            ///< "what if": the scripted expert goes on
};

}  // namespace trocar::presenter
