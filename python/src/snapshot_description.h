// SPDX-License-Identifier: Apache-2.0
/// \file snapshot_description.h  A snapshot as Python's dictionaries.
#pragma once

#include <array>

#include "binding.h"
#include "trocar/simulation/simulation.h"

namespace trocar::python {

inline constexpr double kMillilitre = 1e6;  ///< per m^3
inline constexpr std::array<const char*, instrument::kHandCount> kHandNames = {"left", "right"};

/// (5) pan, tilt, spin, depth, jaw
void FromJoints(const instrument::TrocarJoints& joints, double* at);
/// None where there is none.
py::object SurfaceName(const simulation::Simulation& simulation, std::int32_t surface);
py::object ObjectName(const simulation::Simulation& simulation, std::int32_t object);

/// Instruments, organs, things, task, operation, contacts: docs/python.md.
py::dict DescribeSnapshot(const simulation::Simulation& simulation);

}  // namespace trocar::python
