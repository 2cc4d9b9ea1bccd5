// SPDX-License-Identifier: Apache-2.0
/// \file contact_rows.h  Contacts of the tools as rows of numbers, as environments observe them.
#pragma once

#include <span>

#include "trocar/simulation/simulation.h"

namespace trocar::python {

inline constexpr std::size_t kContactRows = 32;
/// is_there, point (3), normal (3), force (3), hand, surface, object
inline constexpr std::size_t kContactNumbers = 13;

/// The strongest first; rows beyond the last are 0.
/// \param[out] rows  (kContactRows, kContactNumbers)
void WriteContacts(const simulation::Simulation& simulation, std::span<float> rows);

}  // namespace trocar::python
