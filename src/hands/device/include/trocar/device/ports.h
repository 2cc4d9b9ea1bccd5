// SPDX-License-Identifier: Apache-2.0
/// \file ports.h  Clock and transport of a driver: interfaces, so that tests can put faults and their own time in their place.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string_view>

#include "trocar/base/result.h"

namespace trocar::device {

/// Monotonic time.
class Clock {
 public:
  virtual ~Clock() = default;
  /// Since an arbitrary start [s].
  /// \note Real-time safe.
  virtual double Now() const noexcept = 0;
  /// Lets at least `seconds` pass.
  virtual void Sleep(double seconds) noexcept = 0;
};

/// The machine's monotonic clock.
Clock& SystemClock() noexcept;

/// A clock that moves only when it is told to: for tests and for replays.
class ManualClock : public Clock {
 public:
  double Now() const noexcept override { return time_; }
  void Sleep(double seconds) noexcept override { time_ += seconds; }
  void Set(double time) noexcept { time_ = time; }

 private:
  double time_ = 0;
};

/// Result of a read or write.
struct IoResult {
  std::size_t count = 0;  ///< bytes; 0 means that there is nothing to read, or no room to write, just now
  bool is_lost = false;   ///< the other side is gone for good: hang-up, end of file or an I/O error alike
};

/// A line of bytes to a device. Neither side ever waits.
class Transport {
 public:
  virtual ~Transport() = default;
  /// \note Real-time safe: a system call that does not wait.
  virtual IoResult Read(std::span<char> buffer) noexcept = 0;
  /// May take only a part.
  /// \note Real-time safe: a system call that does not wait.
  virtual IoResult Write(std::string_view bytes) noexcept = 0;
  /// File descriptor for a supervisor to duplicate, or -1.
  virtual int GetFile() const noexcept { return -1; }
};

/// Opens the line anew; a driver calls it each time it is configured.
using TransportOpener = std::function<base::Result<std::unique_ptr<Transport>>()>;

/// Writes all of `bytes`, waiting up to `timeout` [s] for room.
/// \return kDeviceLost
/// \note Not real-time safe: sleeps.
base::Status WriteAll(Transport& transport, Clock& clock, std::string_view bytes, double timeout);

}  // namespace trocar::device
