// SPDX-License-Identifier: Apache-2.0
/// \file device_console.h  Watching a device from a terminal.
#pragma once

#include <array>
#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/device/driver.h"
#include "trocar/device/mouse_keyboard.h"

namespace trocar::cli {

/// Turns Ctrl+C and a terminate signal into a request to end, so that nothing that was measured is lost.
class InterruptWatch {
 public:
  InterruptWatch();
  ~InterruptWatch();
  InterruptWatch(const InterruptWatch&) = delete;
  InterruptWatch& operator=(const InterruptWatch&) = delete;
  bool IsInterrupted() const noexcept;

 private:
  std::array<void (*)(int), 2> former_{};  // what SIGINT and SIGTERM did before
};

using HandSamples = std::array<device::HandSample, device::kChannelCount>;

/// Summary of watching a device.
struct WatchReport {
  double seconds = 0;
  std::array<int, device::kChannelCount> fresh{};   ///< samples of each hand
  std::array<int, device::kChannelCount> unseen{};  ///< times that a hand went out of sight
  bool is_lost = false;
  std::vector<std::string> held_back;  ///< Driver::DescribeHeldBack()
  std::string received;                ///< Driver::DescribeReceived()
};

/// Configures and activates a driver and reads it 500 times a second.
///
/// \param seconds    0 goes on until the person interrupts
/// \param on_sample  called with every fresh set of samples and the time since the start [s]
/// \param on_idle    called every 50 ms with the newest; for drawing; may be empty
/// \return the device's error; a device that is lost on the way is in the report
base::Result<WatchReport> WatchDevice(device::Driver& driver, double seconds,
                                      const std::function<void(const HandSamples&, double)>& on_sample,
                                      const std::function<void(const HandSamples&, double)>& on_idle = {});

/// Prints why samples that came did not count, a line for each reason; nothing where all did.
void PrintHeldBack(const WatchReport& report);

/// Three lines, one a hand: numbers and bars. Ends with a newline.
std::string FormatHands(const HandSamples& samples);

/// Draws FormatHands() over the last drawing; where standard output is no terminal, two lines a second below each other.
class HandPlot {
 public:
  HandPlot();
  void Show(const HandSamples& samples, double time);

 private:
  bool is_terminal_;
  bool is_drawn_ = false;
  double next_ = 0;  // [s]
};

}  // namespace trocar::cli
