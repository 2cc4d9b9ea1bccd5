// SPDX-License-Identifier: Apache-2.0
/// \file stand_in_hd.cpp  Takes the place of the maker's libHD in tests: two devices, one scheduler thread of about 1 kHz,
/// errors on demand. Built as a library of its own and loaded by name.
#include <fcntl.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
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

/// As a driver of the system: the devices are one process's until it gives them back or is gone.
int device_file = -1;
bool TakeDevices() {
  const char* path = std::getenv(kStandInPage);
  if (path == nullptr || device_file >= 0) return true;
  const int file = ::open(path, O_RDWR | O_CLOEXEC);
  if (::flock(file, LOCK_EX | LOCK_NB) != 0) {
    ::close(file);
    return false;
  }
  device_file = file;
  return true;
}
void GiveDevicesBack() {
  if (device_file >= 0) ::close(device_file);
  device_file = -1;
}
/// Of the scheduler's thread.
void NoteCall() {
  const long long now = std::chrono::steady_clock::now().time_since_epoch().count();
  const long long last = state.last_call.exchange(now);
  if (last != 0 && now - last > state.longest_gap) state.longest_gap = now - last;
}

std::atomic<int> open_frames{0}, callbacks{0}, drops{0};
auto& pending_error = state.pending_error;
auto& devices = state.devices;
auto& misuses = state.misuses;
auto& forces = state.forces;
double SquaredSize(const std::array<std::atomic<double>, 3>& force) {
  return force[0] * force[0] + force[1] * force[1] + force[2] * force[2];
}
/// A light grip that presses a device of little friction down, along y; the motors hold a force for a millisecond.
struct HandOnDevice {
  static constexpr double kMass = 0.045 + 0.05;  // device and fingers [kg]
  static constexpr double kDamping = 0.2 + 0.2;  // device and fingers [N s/m]
  static constexpr double kFriction = 0.1;       // [N]
  static constexpr double kGrip = 30;            // [N/m]
  static constexpr double kTarget = -0.03;       // where the person wants to be [m]
  static constexpr double kStep = 0.055;         // of the encoders [mm]
  static constexpr int kSubsteps = 50;

  double position = 0.004, velocity = -0.05;  // [m], [m/s]

  double Measure() const { return kStep * std::floor(1e3 * position / kStep); }  // [mm]
  void Move(double force) {
    const double h = 0.001 / kSubsteps;
    for (int i = 0; i < kSubsteps; ++i) {
      const double pull = force - kGrip * (position - kTarget) - kDamping * velocity;
      if (std::fabs(velocity) < 1e-4 && std::fabs(pull) < kFriction) {
        velocity = 0;
        continue;
      }
      velocity += h * (pull - std::copysign(kFriction, velocity != 0 ? velocity : pull)) / kMass;
      position += h * velocity;
    }
  }
};
HandOnDevice hand;

bool HasFault(StandInFault fault) {
  return state.fault == fault && state.fault_process == ::getpid();
}
/// Every call begins with it.
void Suffer() {
  using namespace std::chrono_literals;
  while (HasFault(StandInFault::kHangingCall)) std::this_thread::sleep_for(1ms);
  if (HasFault(StandInFault::kSlowCalls)) std::this_thread::sleep_for(30ms);
}
std::array<std::atomic<bool>, 2> is_pushing;
std::atomic<unsigned int> current{0};
std::atomic<bool> is_running{false}, is_scheduled{false};
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
/// Largest force [N], continuous force [N] and stiffness [N/mm], as the devices say them.
STAND_IN void StandInLimits(const double* three) {
  for (std::size_t i = 0; i < 3; ++i) state.limits[i] = three[i];
}
/// Lets a StandInFault happen in this process.
STAND_IN void StandInFail(int fault) {
  state.fault = static_cast<StandInFault>(fault);
  state.fault_process = ::getpid();
}
STAND_IN void StandInTransform(int kind) {
  state.transform = kind;
}
STAND_IN void StandInTemperatures(const double* three) {
  for (std::size_t i = 0; i < 3; ++i) state.temperatures[i] = three[i];
}
STAND_IN void StandInStepped(int is_stepped) {
  state.is_stepped = is_stepped;
  hand = {};
}
/// Forces that no gate lets out: not finite, above the clamp, or with too fast a rise.
STAND_IN int StandInBadForces() {
  return state.bad_forces;
}
/// Times that a force gave way to zero.
STAND_IN int StandInDrops() {
  return drops;
}
STAND_IN int StandInDevices() {
  return devices;
}

/// A millisecond of the scheduler, and of the hand that holds the first device.
STAND_IN void StandInStep() {
  if (callback != nullptr) callback(callback_data);
  hand.Move(forces[0][1]);
}
/// \return where the hand has the device [m]
STAND_IN double StandInHand() {
  return hand.position;
}

// --- the interface
STAND_IN unsigned int hdInitDevice(const char* name) {
  if (is_running) ++misuses;  // all devices come before the scheduler
  if (std::strcmp(name, "nobody") == 0) {
    pending_error = 0x0300;
    return 0xffffffff;
  }
  if (!TakeDevices()) {
    pending_error = 0x0305;
    return 0xffffffff;
  }
  // the system has taken them from a process that is gone
  if (state.process.exchange(::getpid()) != ::getpid()) devices = 0;
  const int number = devices++;
  for (auto& part : forces[static_cast<std::size_t>(number)]) part = 0;
  return static_cast<unsigned int>(number);
}
STAND_IN void hdDisableDevice(unsigned int) {
  Suffer();
  if (is_running) ++misuses;
  if (--devices == 0) GiveDevicesBack();
}
STAND_IN void hdMakeCurrentDevice(unsigned int device) {
  Suffer();
  current = device;
}
STAND_IN void hdBeginFrame(unsigned int device) {
  Suffer();
  if (open_frames++ != 0) ++misuses;
  current = device;
}
STAND_IN void hdEndFrame(unsigned int) {
  Suffer();
  if (--open_frames != 0) ++misuses;
}
STAND_IN void hdEnable(unsigned int what) {
  if (what == 0x4000) is_pushing[current] = true;
}
STAND_IN void hdGetDoublev(unsigned int what, double* values) {
  Suffer();
  const double side = current == 0 ? -1 : 1;
  const bool is_led = state.is_led == 1;
  if (what == 0x2050) values[0] = is_led ? 0 : 40 * side, values[1] = is_led ? 0 : -10, values[2] = 5;
  if (what == 0x2051) values[0] = is_led ? 0 : 100, values[1] = values[2] = 0;
  if (what == 0x2052) {
    for (int i = 0; i < 16; ++i) values[i] = i % 5 == 0 ? 1 : 0;
    const int kind = state.transform;
    if (kind == 1) std::fill(values, values + 16, std::nan(""));
    if (kind == 2) std::fill(values, values + 16, 0.0);
    if (kind == 3) values[10] = -1;
    if (kind == 4) values[0] = values[5] = values[10] = 2;
    if (kind == 5) values[4] = 0.6, values[5] = 0.8;
    if (kind == 6) {
      const double n[3] = {2.0 / 3, -1.0 / 3, 2.0 / 3}, c = std::cos(0.6), s = std::sin(0.6);
      const double cross[9] = {0, n[2], -n[1], -n[2], 0, n[0], n[1], -n[0], 0};
      for (int column = 0; column < 3; ++column) {
        for (int row = 0; row < 3; ++row)
          values[4 * column + row] =
              (row == column ? c : 0) + (1 - c) * n[row] * n[column] + s * cross[3 * column + row];
      }
    }
    if (kind >= 7 && kind <= 9) values[5 * (kind - 7)] = 1.1;
    if (kind == 10) values[9] = std::sin(0.25), values[10] = std::cos(0.25);
    if (kind == 12) values[8] = 0.2;
    if (kind == 11) values[4] = std::sin(0.04), values[5] = std::cos(0.04);
  }
  if (what == 0x2551) {
    const double box[] = {-80, -60, -35, 80, 60, 35};
    std::memcpy(values, box, sizeof box);
  }
  if (what == 0x2602) *values = state.limits[2];
  if (what == 0x2603) *values = state.limits[0];
  if (what == 0x2604) *values = state.limits[1];
  if (what == 0x2605) {
    for (std::size_t i = 0; i < 3; ++i) values[i] = state.temperatures[i];
  }
  if (what == 0x2050 && state.is_stepped == 1)
    values[0] = values[2] = 0, values[1] = current == 0 ? hand.Measure() : 0;
}
STAND_IN void hdGetIntegerv(unsigned int, int* value) {
  *value = state.is_led == 1 ? state.buttons[current].load() : current == 0 ? 1 : 0;
}
STAND_IN void hdSetDoublev(unsigned int what, const double* values) {
  Suffer();
  if (what != 0x2700 || open_frames != 1 || !is_pushing[current]) ++misuses;
  auto& force = forces[current];
  if (force[0] != 0 && values[0] == 0) ++drops;
  double size = 0, rise = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    size += values[i] * values[i];
    rise += (values[i] - force[i]) * (values[i] - force[i]);
  }
  // the way from zero to the last force is free; the tests' forces keep their direction
  const bool is_rising = std::sqrt(size) > std::sqrt(SquaredSize(force)) && rise > 0.5001 * 0.5001;
  if (!(std::sqrt(size) <= state.limits[0] * 1.0001) || is_rising) ++state.bad_forces;
  for (std::size_t i = 0; i < 3; ++i) force[i] = values[i];
  if (std::sqrt(size) > state.largest) state.largest = std::sqrt(size);
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
  is_scheduled = state.is_stepped != 1;
  callback_data = data;
  return 1;
}
STAND_IN void hdUnschedule(unsigned long) {
  callback = nullptr;
}
STAND_IN void hdStartScheduler() {
  is_running = true;
  if (state.is_stepped == 1) return;
  state.last_call = 0;
  scheduler = std::thread([] {
    while (is_running) {
      if (HasFault(StandInFault::kCrash)) std::raise(SIGSEGV);
      const bool is_silent = HasFault(StandInFault::kSilentScheduler);
      if (!is_silent) NoteCall();
      if (!is_silent && callback != nullptr && callback(callback_data) == 0) {
        is_scheduled = false;
        break;
      }
      ++callbacks;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  });
}
STAND_IN void hdStopScheduler() {
  if (!is_running || is_scheduled) ++misuses;  // the callback has said that it is done
  is_running = false;
  if (scheduler.joinable()) scheduler.join();
}
