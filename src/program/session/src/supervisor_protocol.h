// SPDX-License-Identifier: Apache-2.0
/// \file supervisor_protocol.h  Protocol of simulator and supervisor: a shared page of counters, and messages that carry wires.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>

#include "trocar/device/force_driver.h"

namespace trocar::session {

/// In shared memory, zero at first.
struct SupervisorPage {
  std::atomic<std::uint64_t> beats;             ///< of the simulator
  std::atomic<std::uint64_t> supervisor_beats;  ///< of the supervisor
  std::atomic<std::uint64_t> trips;             ///< how often the supervisor had to act
};
static_assert(std::atomic<std::uint64_t>::is_always_lock_free);

/// Travels with the wire's descriptor. Without one it means: forget wires and library. A library's request travels with two
/// descriptors or four (device::SupervisedLibrary).
struct WireMessage {
  std::uint32_t size = 0;
  std::uint8_t is_closed_after = 0;
  std::uint8_t zero_frame[device::SupervisedWire::kMaxBytes] = {};
};

inline constexpr int kMaxWires = 8;
inline constexpr std::size_t kLongestMessage = 4096;
static_assert(sizeof(WireMessage) < kLongestMessage);

}  // namespace trocar::session
