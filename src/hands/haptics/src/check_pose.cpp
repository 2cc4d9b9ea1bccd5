// SPDX-License-Identifier: Apache-2.0
#include "trocar/haptics/check_pose.h"

#include "guards.h"
#include "trocar/base/assert.h"

namespace trocar::haptics {

void CheckPose::Begin() noexcept {
  state_ = CheckPoseState::kAsking;
  asked_ = 0;
  has_start_ = false;
}

void CheckPose::Step(std::span<const GuardedDevice> devices) noexcept {
  TROCAR_ASSERT(!devices.empty() && devices.size() <= kMaxChannels);
  // whatever comes back after a loss may be another device
  for (const GuardedDevice& device : devices) {
    if (device.fault == Fault::kDeviceLost) state_ = CheckPoseState::kUnconfirmed;
  }
  if (state_ != CheckPoseState::kAsking) return;
  if (!has_start_) {
    // the button of the one before is still held
    for (const GuardedDevice& device : devices) {
      if ((device.buttons & 1U) != 0) return;
    }
    for (std::size_t i = 0; i < devices.size(); ++i) start_[i] = devices[i].position;
    has_start_ = true;
  }
  for (std::size_t i = 0; i < devices.size(); ++i) {
    const bool has_moved = math::Distance(devices[i].position, start_[i]) > settings_.still_radius;
    const bool is_pressed = (devices[i].buttons & 1U) != 0;
    if (IsOn(Guard::kCheckPose) && i != asked_ && (has_moved || is_pressed)) {
      state_ = CheckPoseState::kWrongDevice;
      return;
    }
  }
  const GuardedDevice& asked = devices[asked_];
  const bool is_there = math::Distance(asked.position, settings_.p_device[asked_]) <= settings_.radius;
  const bool is_held =
      is_there && asked.is_calibrated && asked.fault == Fault::kNone && (asked.buttons & 1U) != 0;
  held_ticks_ = is_held ? held_ticks_ + 1 : 0;
  if (held_ticks_ < settings_.ticks) return;
  // the next one is asked for once every button is up, so it begins to count from none
  has_start_ = false;
  if (++asked_ == devices.size()) state_ = CheckPoseState::kConfirmed;
}

}  // namespace trocar::haptics
