// SPDX-License-Identifier: Apache-2.0
/// \file hd_library.h  The few functions of libHD that are used, found at run time. Types and numbers are those of its
/// binary interface.
#pragma once

#include <memory>
#include <string>
#include <type_traits>

#include "trocar/base/result.h"

namespace trocar::device::hd {

using Handle = unsigned int;
using Enum = unsigned int;
using SchedulerHandle = unsigned long;
using CallbackCode = unsigned int;
using Callback = CallbackCode (*)(void*);

struct ErrorInfo {
  unsigned int code;
  int internal_code;
  Handle device;
};

inline constexpr Handle kInvalidHandle = 0xffffffff;
inline constexpr CallbackCode kDone = 0, kContinue = 1;
inline constexpr unsigned short kMaxPriority = 0xffff;

// parameters
inline constexpr Enum kButtons = 0x2000, kPosition = 0x2050, kVelocity = 0x2051, kTransform = 0x2052;
inline constexpr Enum kUsableWorkspace = 0x2551, kMaxStiffness = 0x2602, kMaxForce = 0x2603;
inline constexpr Enum kMaxContinuousForce = 0x2604, kMotorTemperature = 0x2605, kForce = 0x2700;
inline constexpr Enum kForceOutput = 0x4000, kCalibrationGood = 0x5000;

// errors
inline constexpr unsigned int kSuccess = 0, kFirstForceError = 0x0200, kLastForceError = 0x0204;
/// Warm motors, too much force, impulse or speed, force error: they pass, and the force of that time is dropped.
inline bool IsPassing(unsigned int error) noexcept {
  return error >= kFirstForceError && error <= kLastForceError;
}

struct Library {
  ~Library();
  /// \return kDeviceUnsupported where the library or one of its functions is not there
  static base::Result<std::unique_ptr<Library>> Load(const std::string& name);

  void* file = nullptr;
  Handle (*init_device)(const char*) = nullptr;
  void (*disable_device)(Handle) = nullptr;
  void (*make_current)(Handle) = nullptr;
  void (*begin_frame)(Handle) = nullptr;
  void (*end_frame)(Handle) = nullptr;
  void (*enable)(Enum) = nullptr;
  void (*get_doubles)(Enum, double*) = nullptr;
  void (*get_integers)(Enum, int*) = nullptr;
  void (*set_doubles)(Enum, const double*) = nullptr;
  Enum (*check_calibration)() = nullptr;
  ErrorInfo (*get_error)() = nullptr;
  const char* (*get_error_string)(unsigned int) = nullptr;
  SchedulerHandle (*schedule)(Callback, void*, unsigned short) = nullptr;
  void (*unschedule)(SchedulerHandle) = nullptr;
  void (*start_scheduler)() = nullptr;
  void (*stop_scheduler)() = nullptr;
};

}  // namespace trocar::device::hd
