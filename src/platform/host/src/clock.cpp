// SPDX-License-Identifier: Apache-2.0
#include "trocar/host/clock.h"

#include <time.h>

namespace trocar::host {
namespace {

std::int64_t Read(clockid_t clock) noexcept {
  timespec now{};
  clock_gettime(clock, &now);
  return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

}  // namespace

std::int64_t NowNanoseconds() noexcept {
  return Read(CLOCK_MONOTONIC);
}
std::int64_t ThreadCpuNanoseconds() noexcept {
  return Read(CLOCK_THREAD_CPUTIME_ID);
}

}  // namespace trocar::host
