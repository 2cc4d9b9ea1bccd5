// SPDX-License-Identifier: Apache-2.0
/// \file wait_for.h  What a test waits for, while threads and other processes get on with it.
#pragma once

#include <functional>

#include "trocar/device/ports.h"
#include "trocar/host/clock.h"

namespace trocar::device {

/// \param seconds  longest wait; a busy machine needs most of it
inline bool WaitFor(double seconds, const std::function<bool()>& is_reached) {
  const host::Stopwatch watch;
  while (watch.Seconds() < seconds) {
    if (is_reached()) return true;
    SystemClock().Sleep(0.0005);
  }
  return is_reached();
}
inline bool WaitFor(const std::function<bool()>& is_reached) {
  return WaitFor(10.0, is_reached);
}

}  // namespace trocar::device
