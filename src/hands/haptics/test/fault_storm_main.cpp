// SPDX-License-Identifier: Apache-2.0
/// \file fault_storm_main.cpp  haptics_fault_storm [FAULTS [SEED]]: as many random faults as are wanted, one million by default.
#include <chrono>
#include <cstdio>
#include <cstdlib>

#include "fault_storm.h"

int main(int argument_count, char** arguments) {
  const long faults = argument_count > 1 ? std::atol(arguments[1]) : 1'000'000;
  const std::uint64_t seed = argument_count > 2 ? std::strtoull(arguments[2], nullptr, 10) : 26;
  const auto start = std::chrono::steady_clock::now();
  const trocar::haptics::FaultStormResult result = trocar::haptics::RunFaultStorm(faults, seed);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  std::printf(
      "%ld faults on %ld pairs of devices (%ld with limits that no gate takes), %ld ticks between them (%ld "
      "armed, %ld with force), %.1f s: %s\n",
      result.faults, result.devices, result.refused_devices, result.ticks, result.armed_ticks,
      result.force_ticks, took.count(), result.complaint.empty() ? "no violation" : result.complaint.c_str());
  return result.complaint.empty() && result.faults == faults ? 0 : 1;
}
