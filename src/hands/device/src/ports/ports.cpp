// SPDX-License-Identifier: Apache-2.0
#include "trocar/device/ports.h"

#include <time.h>

#include <cerrno>
#include <cmath>

#include "trocar/host/clock.h"

namespace trocar::device {
namespace {

class MonotonicClock : public Clock {
 public:
  double Now() const noexcept override { return 1e-9 * static_cast<double>(host::NowNanoseconds()); }
  void Sleep(double seconds) noexcept override {
    if (!(seconds > 0.0)) return;
    timespec left{static_cast<time_t>(seconds), static_cast<long>(1e9 * (seconds - std::floor(seconds)))};
    while (::nanosleep(&left, &left) != 0 && errno == EINTR) {
    }
  }
};

}  // namespace

Clock& SystemClock() noexcept {
  static MonotonicClock clock;  // has no state
  return clock;
}

base::Status WriteAll(Transport& transport, Clock& clock, std::string_view bytes, double timeout) {
  const double end = clock.Now() + timeout;
  while (!bytes.empty()) {
    const IoResult sent = transport.Write(bytes);
    bytes.remove_prefix(sent.count);
    if (sent.is_lost || (sent.count == 0 && clock.Now() >= end)) {
      return base::Error{base::ErrorCode::kDeviceLost,
                         sent.is_lost ? "the device hung up while it was set up; check plug and power"
                                      : "the device takes no commands; check cable, speed and power"};
    }
    if (sent.count == 0) clock.Sleep(0.001);
  }
  return {};
}

}  // namespace trocar::device
