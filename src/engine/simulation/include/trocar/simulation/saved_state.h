// SPDX-License-Identifier: Apache-2.0
/// \file saved_state.h  Comparison of states as Simulation::Save writes them.
#pragma once

#include <cstddef>
#include <span>

namespace trocar::simulation {

/// Whether two saved states are the same, byte by byte. The fingerprints of their models may differ: a recording of before has one
/// of another kind (ModelFingerprintKind).
bool AreSameState(std::span<const std::byte> a, std::span<const std::byte> b) noexcept;

}  // namespace trocar::simulation
