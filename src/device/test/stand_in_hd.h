// SPDX-License-Identifier: Apache-2.0
/// \file stand_in_hd.h  What the stand-in of libHD shows of its two devices: their motors, seen from outside.
#pragma once

#include <array>
#include <atomic>

/// Environment variable with the file that the state lies in; without it the state is the library's own.
inline constexpr const char* kStandInPage = "TROCAR_STAND_IN_PAGE";

struct StandInState {
  std::atomic<unsigned int> pending_error{0};
  std::atomic<int> devices{0};  ///< open
  std::atomic<int> misuses{0};
  std::atomic<int> process{0};  ///< that has the library
  std::atomic<int> is_led{0};   ///< 1: styluses in the middle of their reach, buttons as below
  std::array<std::atomic<int>, 2> buttons{};
  std::array<std::array<std::atomic<double>, 3>, 2> forces{};  ///< on the hands, as the motors give them [N]
};
