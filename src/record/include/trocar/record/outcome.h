// SPDX-License-Identifier: Apache-2.0
/// \file outcome.h  What an attempt came to, computed from the simulation alone: the same for a recording and its replay.
#pragma once

#include <string>

#include "trocar/simulation/simulation.h"

namespace trocar::record {

/// A JSON object in one line: of a task its phase, time [s], score as shown, goals and errors; of an operation whether it was completed,
/// the critical view, errors, injuries, blood and bile [mL]; of a scene without a task only the time.
/// The same state gives the same text, digit for digit.
/// \note Allocates.
std::string CalcOutcome(const simulation::Simulation& simulation);

}  // namespace trocar::record
