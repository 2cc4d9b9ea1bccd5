// SPDX-License-Identifier: Apache-2.0
#include "trocar/device/force_driver.h"

#include <cmath>
#include <cstdio>

#include "trocar/base/assert.h"

namespace trocar::device {
namespace {

/// One number of a device's limits and what is believed of it.
struct LimitRange {
  const char* name;
  const char* unit;
  double value, smallest, largest;
};

}  // namespace

base::Status CheckLimits(const ForceLimits& limits, const std::string& name) {
  constexpr double kFarthest = 3.0;  // edge of a workspace [m]
  const math::Vec3 &low = limits.workspace_min, &high = limits.workspace_max;
  // what is not known is 0, but for the nominal force
  const LimitRange ranges[] = {
      {"largest force", "N", limits.max_force, kSmallestForceLimit, kLargestForceLimit},
      {"continuous force", "N", limits.max_continuous_force, 0, kLargestForceLimit},
      {"stiffness", "N/m", limits.max_stiffness, 0, 100'000},
      {"damping", "N s/m", limits.damping, 0, 100},
      {"friction", "N", limits.friction, 0, 10},
      {"mass", "kg", limits.mass, 0, 10},
      {"step of the encoders", "m", limits.position_step, 0, 0.01},
      {"workspace", "m", low.x, -kFarthest, kFarthest},
      {"workspace", "m", low.y, -kFarthest, kFarthest},
      {"workspace", "m", low.z, -kFarthest, kFarthest},
      {"workspace", "m", high.x, low.x, kFarthest},
      {"workspace", "m", high.y, low.y, kFarthest},
      {"workspace", "m", high.z, low.z, kFarthest},
  };
  for (const LimitRange& range : ranges) {
    // false for what is no number
    if (range.value >= range.smallest && range.value <= range.largest) continue;
    char text[160];
    std::snprintf(text, sizeof text, "'s %s of %g %s is outside %g to %g %s", range.name, range.value,
                  range.unit, range.smallest, range.largest, range.unit);
    return base::Error{base::ErrorCode::kDeviceSettings,
                       name + text +
                           ", so no force can be sent to it safely; check its model and settings with its "
                           "maker's program, and renew its driver"};
  }
  return {};
}

base::Status ForceDriver::CheckConfigured() const {
  for (int channel = 0; channel < GetChannelCount(); ++channel) {
    if (base::Status good = CheckLimits(GetLimits(channel), GetName()); !good) return good;
  }
  return {};
}

ReadStatus ForceDriver::ReadForceSamples(std::span<ForceSample> samples) noexcept {
  TROCAR_ASSERT(static_cast<int>(samples.size()) == GetChannelCount());
  const ReadStatus status =
      GetState() == DriverState::kActive ? DoReadForceSamples(samples) : ReadStatus::kNotActive;
  if (status == ReadStatus::kLost) {
    for (int channel = 0; channel < GetChannelCount(); ++channel) DoSendForce(channel, {});
    Lose();
  }
  if (status == ReadStatus::kLost || status == ReadStatus::kNotActive) {
    for (ForceSample& sample : samples) sample.status = ForceDeviceStatus::kLost;
  }
  return status;
}

void ForceDriver::SendForce(int channel, const GatedForce& force) noexcept {
  TROCAR_ASSERT(channel >= 0 && channel < GetChannelCount());
  if (GetState() == DriverState::kActive) DoSendForce(channel, force);
}

SupervisedWire ForceDriver::GetSupervisedWire(int /*channel*/) const noexcept {
  return {};
}

SupervisedLibrary ForceDriver::GetSupervisedLibrary() const {
  return {};
}

}  // namespace trocar::device
