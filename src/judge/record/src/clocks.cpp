// SPDX-License-Identifier: Apache-2.0
#include "trocar/record/clocks.h"

#include <chrono>
#include <cmath>
#include <ctime>

#include "trocar/base/to_integer.h"

namespace trocar::record {
namespace {

constexpr double kLeastJump = 0.5;  // a leap second is one; the clocks' readings differ by far less [s]
constexpr double kPrecise = 0.01;   // between the two readings of the steady clock [s]
constexpr int kTries = 5;

template <typename Clock>
double Seconds() {
  return std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
}

}  // namespace

ClockReading ReadClocks() {
  ClockReading reading;
  // again where somebody else had the processor between the readings
  for (int i = 0; i < kTries; ++i) {
    const double before = Seconds<std::chrono::steady_clock>();
    reading.wall = Seconds<std::chrono::system_clock>();
    const double after = Seconds<std::chrono::steady_clock>();
    reading.steady = 0.5 * (before + after);
    if (after - before < kPrecise) break;
  }
  return reading;
}

std::string FormatWallClock(double wall) {
  const auto time = base::FloorTo<std::time_t>(wall);
  std::tm local{};
  ::localtime_r(&time, &local);
  char text[40];
  std::string formatted(text, std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%S%z", &local));
  formatted.insert(formatted.size() - 2, ":");  // RFC 3339: "+01:00"
  return formatted;
}

std::optional<double> ClockWatch::See(ClockReading now) {
  const double jump = (now.wall - last_.wall) - (now.steady - last_.steady);
  last_ = now;
  return std::fabs(jump) >= kLeastJump ? std::optional(jump) : std::nullopt;
}

}  // namespace trocar::record
