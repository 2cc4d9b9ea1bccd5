// SPDX-License-Identifier: Apache-2.0
#include "trocar/host/real_time.h"

#include <pthread.h>
#include <sched.h>
#include <time.h>

#include <cerrno>

namespace trocar::host {

bool AskForRealTime(RealTimePolicy policy, int above_lowest) noexcept {
  const int scheduler = policy == RealTimePolicy::kRoundRobin ? SCHED_RR : SCHED_FIFO;
  sched_param parameters{};
  parameters.sched_priority = sched_get_priority_min(scheduler) + above_lowest;
  return pthread_setschedparam(pthread_self(), scheduler, &parameters) == 0;
}

void LeaveRealTime() noexcept {
  const sched_param none{};
  pthread_setschedparam(pthread_self(), SCHED_OTHER, &none);
}

void TakeIdleTimeOnly() noexcept {
  const sched_param none{};
  pthread_setschedparam(pthread_self(), SCHED_IDLE, &none);
}

void SleepUntil(std::int64_t time) noexcept {
  timespec until{};
  until.tv_sec = time / 1'000'000'000;
  until.tv_nsec = time % 1'000'000'000;
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
  }
}

}  // namespace trocar::host
