// SPDX-License-Identifier: Apache-2.0
/// \file stand_in_hd.h  What the stand-in of libHD shows of its two devices: their motors, seen from outside.
#pragma once

#include <array>
#include <atomic>

/// Environment variable with the file that the state lies in; without it the state is the library's own.
inline constexpr const char* kStandInPage = "TROCAR_STAND_IN_PAGE";

/// What can go wrong with a maker's library.
enum class StandInFault : int {
  kNone,
  kSilentScheduler,  ///< calls nobody any more
  kHangingCall,      ///< the next call never returns
  kSlowCalls,        ///< each takes 30 ms
  kCrash
};

struct StandInState {
  std::atomic<unsigned int> pending_error{0};
  std::atomic<int> devices{0};  ///< open
  std::atomic<int> misuses{0};
  std::atomic<int> process{0};  ///< that has the devices; they open for one at a time
  /// When the scheduler last called, and the longest time between two calls since a test set it to 0 [ns].
  std::atomic<long long> last_call{0}, longest_gap{0};
  std::atomic<int> is_led{0};  ///< 1: styluses in the middle of their reach, buttons as below
  std::array<std::atomic<int>, 2> buttons{};
  /// What the devices say of themselves: largest force [N], continuous force [N], stiffness [N/mm].
  std::array<std::atomic<double>, 3> limits{3.3, 0.88, 1.02};
  /// What the devices report: 1: no numbers, 2: all zero, 3: a mirror, 4: columns twice as long, 5: not at right angles, 7 to 9:
  /// one column too long; 10: the third column tilted by 0.25 rad; 6: a rotation; 11: one whose second column is 0.04 rad off.
  std::atomic<int> transform{0};
  std::array<std::atomic<double>, 3> temperatures{0.2, 0.4, 0.1};  ///< of the motors [-]
  std::atomic<int> is_stepped{
      0};  ///< 1: the scheduler calls when StandInStep does, and a hand holds the first device
  std::atomic<StandInFault> fault{StandInFault::kNone};
  std::atomic<int> fault_process{0};  ///< in which it happens; another process's library is well
  std::atomic<int> bad_forces{0};     ///< not finite, above the clamp, or with too fast a rise
  std::atomic<double> largest{0};     ///< force so far [N]
  std::array<std::array<std::atomic<double>, 3>, 2> forces{};  ///< on the hands, as the motors give them [N]
};
