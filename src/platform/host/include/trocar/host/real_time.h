// SPDX-License-Identifier: Apache-2.0
/// \file real_time.h  A thread that must be on time: its priority and its sleep.
#pragma once

#include <cstdint>

namespace trocar::host {

enum class RealTimePolicy {
  kFirstInFirstOut,  ///< SCHED_FIFO: keeps the processor until it waits
  kRoundRobin        ///< SCHED_RR: takes turns with its equals
};

/// Asks for a real-time priority of the calling thread. Most desktops allow it to nobody or to a group.
///
/// \param above_lowest  of the policy's priorities, >= 0
/// \return false where the system refuses; the thread goes on as it was
bool AskForRealTime(RealTimePolicy policy, int above_lowest) noexcept;

/// The calling thread takes its turn with all others again: a thread inherits the priority of the one that started it.
void LeaveRealTime() noexcept;

/// The calling thread, and what it starts from now on, runs only while nobody else wants the processor.
void TakeIdleTimeOnly() noexcept;

/// Sleeps until NowNanoseconds() is `time` [ns], through every signal; returns at once where it is past.
/// \note Real-time safe but for the sleep.
void SleepUntil(std::int64_t time) noexcept;

}  // namespace trocar::host
