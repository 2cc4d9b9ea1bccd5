// SPDX-License-Identifier: Apache-2.0
/// \file fault.h  Everything that takes the force away, with its code, and what a person can do about it.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "trocar/base/error_codes.h"

namespace trocar::haptics {

/// Why the output is not armed. Order: the first that holds is named.
enum class Fault : std::uint8_t {
  kNone,
  kNotRequested,      ///< nobody has asked for force since the start or since it was switched off
  kStopped,           ///< a person stopped the force
  kDeviceLost,        ///< D1
  kSilent,            ///< D2
  kBadSamples,        ///< D3, D4
  kJump,              ///< D5
  kForceNotFinite,    ///< D8
  kForceImplausible,  ///< D8
  kOverrun,           ///< D9
  kSupervisor,        ///< D10
  kOverheated,        ///< D11
  kDeadMan,           ///< D12
  kPoseUnconfirmed,   ///< D13
  kNotCalibrated,     ///< D13
  kOverspeed,         ///< the device runs away with the force
  kSimulation,        ///< S1: bad or no model of the tissue
  kGate,              ///< limits that no gate can keep, or an output of the gate that its own check refused
  kForceAtArming,     ///< the tools press tissue: the force would begin with a jolt
  kCount
};

struct FaultEntry {
  Fault fault;
  base::ErrorCode code;
  std::string_view name;    ///< "device_lost"
  std::string_view what;    ///< for the person: what happened
  std::string_view remedy;  ///< and what to do next
};

/// The table, in the order of the enumeration.
std::span<const FaultEntry> FaultTable() noexcept;
/// \note Real-time safe.
const FaultEntry& FindFault(Fault fault) noexcept;

}  // namespace trocar::haptics
