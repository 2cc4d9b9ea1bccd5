// SPDX-License-Identifier: Apache-2.0
/// \file fault_storm.h  Faults of every kind in random order, in both hands, on devices with random limits; every tick and
/// every call of the maker's library is judged.
#pragma once

#include <cstdint>
#include <string>

namespace trocar::haptics {

struct FaultStormResult {
  long faults = 0;
  long ticks = 0, armed_ticks = 0, force_ticks = 0;
  long devices = 0,
       refused_devices = 0;  ///< pairs of them, one after the other; those with limits that no gate takes
  std::string complaint;     ///< the first violation; empty where there was none
};

/// \param faults  to inject
/// \param seed    of the random numbers
FaultStormResult RunFaultStorm(long faults, std::uint64_t seed);

}  // namespace trocar::haptics
