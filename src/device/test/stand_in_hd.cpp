// SPDX-License-Identifier: Apache-2.0
/// \file stand_in_hd.cpp  Takes the place of the maker's libHD in tests: two devices, one scheduler thread of about 1 kHz,
/// errors on demand. Built as a library of its own and loaded by name.
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <thread>

#include "stand_in_hd.h"

#define STAND_IN extern "C" __attribute__((visibility("default")))

namespace {

struct ErrorInfo {
  unsigned int code;
  int internal_code;
  unsigned int device;
};

/// In a file that the test reads, too, where the library lives in another process.
StandInState& FindState() {
  static StandInState own;
  const char* path = std::getenv(kStandInPage);
  if (path == nullptr) return own;
  const int file = ::open(path, O_RDWR | O_CLOEXEC);
  void* memory = ::mmap(nullptr, sizeof(StandInState), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  ::close(file);
  return memory == MAP_FAILED ? own : *static_cast<StandInState*>(memory);
}
StandInState& state = FindState();

std::atomic<int> open_frames{0}, callbacks{0}, drops{0};
auto& pending_error = state.pending_error;
auto& devices = state.devices;
auto& misuses = state.misuses;
auto& forces = state.forces;
std::array<std::atomic<bool>, 2> is_pushing;
std::atomic<unsigned int> current{0};
std::atomic<bool> is_running{false};
std::thread scheduler;
unsigned int (*callback)(void*) = nullptr;
void* callback_data = nullptr;

}  // namespace

// --- what the tests turn
STAND_IN void StandInRaise(unsigned int error) {
  pending_error = error;
}
STAND_IN void StandInForce(int device, double* force) {
  for (std::size_t i = 0; i < 3; ++i) force[i] = forces[static_cast<std::size_t>(device)][i];
}
STAND_IN int StandInMisuses() {
  return misuses;
}
STAND_IN int StandInCallbacks() {
  return callbacks;
}
/// Times that a force gave way to zero.
STAND_IN int StandInDrops() {
  return drops;
}
STAND_IN int StandInDevices() {
  return devices;
}

// --- the interface
STAND_IN unsigned int hdInitDevice(const char* name) {
  if (is_running) ++misuses;  // all devices come before the scheduler
  if (std::strcmp(name, "nobody") == 0) {
    pending_error = 0x0300;
    return 0xffffffff;
  }
  const int number = devices++;
  state.process = ::getpid();
  for (auto& part : forces[static_cast<std::size_t>(number)]) part = 0;
  return static_cast<unsigned int>(number);
}
STAND_IN void hdDisableDevice(unsigned int) {
  if (is_running) ++misuses;
  --devices;
}
STAND_IN void hdMakeCurrentDevice(unsigned int device) {
  current = device;
}
STAND_IN void hdBeginFrame(unsigned int device) {
  if (open_frames++ != 0) ++misuses;
  current = device;
}
STAND_IN void hdEndFrame(unsigned int) {
  if (--open_frames != 0) ++misuses;
}
STAND_IN void hdEnable(unsigned int what) {
  if (what == 0x4000) is_pushing[current] = true;
}
STAND_IN void hdGetDoublev(unsigned int what, double* values) {
  const double side = current == 0 ? -1 : 1;
  const bool is_led = state.is_led == 1;
  if (what == 0x2050) values[0] = is_led ? 0 : 40 * side, values[1] = is_led ? 0 : -10, values[2] = 5;
  if (what == 0x2051) values[0] = is_led ? 0 : 100, values[1] = values[2] = 0;
  if (what == 0x2052) {
    for (int i = 0; i < 16; ++i) values[i] = i % 5 == 0 ? 1 : 0;
  }
  if (what == 0x2551) {
    const double box[] = {-80, -60, -35, 80, 60, 35};
    std::memcpy(values, box, sizeof box);
  }
  if (what == 0x2602) *values = 1.02;
  if (what == 0x2603) *values = 3.3;
  if (what == 0x2604) *values = 0.88;
  if (what == 0x2605) values[0] = 0.2, values[1] = 0.4, values[2] = 0.1;
}
STAND_IN void hdGetIntegerv(unsigned int, int* value) {
  *value = state.is_led == 1 ? state.buttons[current].load() : current == 0 ? 1 : 0;
}
STAND_IN void hdSetDoublev(unsigned int what, const double* values) {
  if (what != 0x2700 || open_frames != 1 || !is_pushing[current]) ++misuses;
  auto& force = forces[current];
  if (force[0] != 0 && values[0] == 0) ++drops;
  for (std::size_t i = 0; i < 3; ++i) force[i] = values[i];
}
STAND_IN unsigned int hdCheckCalibration() {
  return 0x5000;
}
STAND_IN ErrorInfo hdGetError() {
  return {pending_error.exchange(0), 0, current};
}
STAND_IN const char* hdGetErrorString(unsigned int) {
  return "a stand-in's error";
}
STAND_IN unsigned long hdScheduleAsynchronous(unsigned int (*wanted)(void*), void* data, unsigned short) {
  callback = wanted;
  callback_data = data;
  return 1;
}
STAND_IN void hdUnschedule(unsigned long) {
  callback = nullptr;
}
STAND_IN void hdStartScheduler() {
  is_running = true;
  scheduler = std::thread([] {
    while (is_running) {
      if (callback != nullptr && callback(callback_data) == 0) break;
      ++callbacks;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  });
}
STAND_IN void hdStopScheduler() {
  is_running = false;
  if (scheduler.joinable()) scheduler.join();
}
