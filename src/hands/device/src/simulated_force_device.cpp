// SPDX-License-Identifier: Apache-2.0
#include "trocar/device/simulated_force_device.h"

#include <unistd.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "trocar/base/assert.h"
#include "trocar/host/clock.h"

namespace trocar::device {

std::array<std::uint8_t, SimulatedForceFrame::kBytes> EncodeFrame(const SimulatedForceFrame& frame) noexcept {
  std::array<std::uint8_t, SimulatedForceFrame::kBytes> bytes{'T', 'R', 'F', 'C', frame.channel};
  std::memcpy(bytes.data() + 8, frame.force, sizeof frame.force);
  return bytes;
}

ForceLimits MakeTouchLimits() noexcept {
  ForceLimits touch;
  touch.max_force = 3.3;
  touch.max_continuous_force = 0.88;
  touch.max_stiffness = 400;
  touch.damping = 0.2;
  touch.friction = 0.26;
  touch.mass = 0.045;
  touch.position_step = 0.055e-3;
  touch.workspace_min = {-0.080, -0.060, -0.035};
  touch.workspace_max = {0.080, 0.060, 0.035};
  return touch;
}

SimulatedForceDevice::SimulatedForceDevice(SimulatedForceSettings settings)
    : ForceDriver("simulated haptic device", settings.channel_count), settings_(std::move(settings)) {
  TROCAR_ASSERT(settings_.path && settings_.channel_count >= 1 &&
                settings_.channel_count <= SimulatedForceSettings::kMaxChannels);
  if (settings_.limits.max_force == 0.0) settings_.limits = MakeTouchLimits();
}

ForceLimits SimulatedForceDevice::GetLimits(int /*channel*/) const noexcept {
  return settings_.limits;
}

SupervisedWire SimulatedForceDevice::GetSupervisedWire(int channel) const noexcept {
  SupervisedWire wire;
  wire.file = settings_.wire;
  const auto frame = EncodeFrame({static_cast<std::uint8_t>(channel), {}});
  wire.size = frame.size();
  std::memcpy(wire.zero_frame.data(), frame.data(), frame.size());
  return wire;
}

base::Status SimulatedForceDevice::DoConfigure() {
  if (fault_.load() == SimulatedFault::kUnplugged)
    return base::Error{base::ErrorCode::kDeviceLost, GetName() + " is unplugged; plug it in again"};
  return {};
}

base::Status SimulatedForceDevice::DoActivate() {
  start_ = host::NowNanoseconds();
  for (int channel = 0; channel < GetChannelCount(); ++channel) DoSendForce(channel, {});
  return {};
}

void SimulatedForceDevice::DoDeactivate() noexcept {
  for (int channel = 0; channel < GetChannelCount(); ++channel) DoSendForce(channel, {});
}

ReadStatus SimulatedForceDevice::DoRead(std::span<HandSample> samples) noexcept {
  // where its trocars are, only the session knows
  for (HandSample& sample : samples) sample.is_valid = false;
  return ReadStatus::kUnchanged;
}

ReadStatus SimulatedForceDevice::DoReadForceSamples(std::span<ForceSample> samples) noexcept {
  const SimulatedFault fault = fault_.load();
  if (fault == SimulatedFault::kUnplugged) return ReadStatus::kLost;
  if (fault == SimulatedFault::kSilent) return ReadStatus::kUnchanged;
  const double time = 1e-9 * static_cast<double>(host::NowNanoseconds() - start_);
  ++sequence_;
  for (std::size_t channel = 0; channel < samples.size(); ++channel) {
    ForceSample& sample = samples[channel];
    const double step = settings_.limits.position_step;
    sample.position = settings_.path(static_cast<int>(channel), time);
    if (step > 0.0) {
      for (int axis = 0; axis < 3; ++axis)
        sample.position[axis] = step * std::floor(sample.position[axis] / step);
    }
    if (fault == SimulatedFault::kNotFinite) sample.position.x = std::numeric_limits<double>::quiet_NaN();
    const bool has_jumped =
        fault == SimulatedFault::kJumped || (fault == SimulatedFault::kAlternating && sequence_ % 2 == 0);
    if (has_jumped) sample.position.z -= 0.05;
    sample.velocity = {};
    sample.orientation = {};
    sample.buttons = buttons_[channel].load(std::memory_order_relaxed);
    if (settings_.buttons) sample.buttons |= settings_.buttons(static_cast<int>(channel), time);
    sample.jaw = std::numeric_limits<double>::quiet_NaN();
    sample.temperature = std::numeric_limits<double>::quiet_NaN();
    sample.sequence = sequence_;
    sample.is_calibrated = fault != SimulatedFault::kUncalibrated;
    sample.status = fault == SimulatedFault::kWarm ? ForceDeviceStatus::kWarm : ForceDeviceStatus::kOk;
  }
  return ReadStatus::kFresh;
}

void SimulatedForceDevice::DoSendForce(int channel, const GatedForce& force) noexcept {
  force_[static_cast<std::size_t>(channel)].store(math::Norm(force.Get()), std::memory_order_relaxed);
  if (settings_.wire < 0) return;
  const math::Vec3& f = force.Get();
  const auto frame =
      EncodeFrame({static_cast<std::uint8_t>(channel),
                   {static_cast<float>(f.x), static_cast<float>(f.y), static_cast<float>(f.z)}});
  // a full wire drops the frame; the next one comes in a millisecond
  [[maybe_unused]] const ssize_t written = ::write(settings_.wire, frame.data(), frame.size());
}

}  // namespace trocar::device
