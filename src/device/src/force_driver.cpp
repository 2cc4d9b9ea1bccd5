// SPDX-License-Identifier: Apache-2.0
#include "trocar/device/force_driver.h"

#include "trocar/core/assert.h"

namespace trocar::device {

ReadStatus ForceDriver::ReadForceSamples(std::span<ForceSample> samples) noexcept {
  TROCAR_ASSERT(static_cast<int>(samples.size()) == GetChannelCount());
  const ReadStatus status =
      GetState() == DriverState::kActive ? DoReadForceSamples(samples) : ReadStatus::kNotActive;
  if (status == ReadStatus::kLost) {
    // as in Read(): never back by itself; both are in turn here and cannot be refused
    static_cast<void>(Deactivate());
    static_cast<void>(Cleanup());
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

}  // namespace trocar::device
