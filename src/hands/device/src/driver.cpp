// SPDX-License-Identifier: Apache-2.0
#include "trocar/device/driver.h"

namespace trocar::device {

std::string_view StateName(DriverState state) noexcept {
  switch (state) {
    case DriverState::kUnconfigured:
      return "unconfigured";
    case DriverState::kInactive:
      return "inactive";
    case DriverState::kActive:
      return "active";
    case DriverState::kFinalized:
      return "finalized";
  }
  return "unknown";
}

base::Status Driver::CheckTurn(DriverState needed, std::string_view wish) const {
  if (state_ == needed) return {};
  return base::Error{base::ErrorCode::kDeviceState, name_ + " is " + std::string(StateName(state_)) +
                                                        " and cannot " + std::string(wish) + ": it must be " +
                                                        std::string(StateName(needed)) + " first"};
}

base::Status Driver::Configure() {
  if (const base::Status turn = CheckTurn(DriverState::kUnconfigured, "be configured"); !turn) return turn;
  Release();
  if (base::Status done = DoConfigure(); !done) return done;
  if (base::Status good = CheckConfigured(); !good) {
    DoCleanup();
    return good;
  }
  state_ = DriverState::kInactive;
  return {};
}

base::Status Driver::Activate() {
  if (const base::Status turn = CheckTurn(DriverState::kInactive, "be activated"); !turn) return turn;
  if (base::Status done = DoActivate(); !done) return done;
  state_ = DriverState::kActive;
  return {};
}

base::Status Driver::Deactivate() {
  if (const base::Status turn = CheckTurn(DriverState::kActive, "be deactivated"); !turn) return turn;
  DoDeactivate();
  state_ = DriverState::kInactive;
  return {};
}

base::Status Driver::Cleanup() {
  if (const base::Status turn = CheckTurn(DriverState::kInactive, "be cleaned up"); !turn) return turn;
  DoCleanup();
  state_ = DriverState::kUnconfigured;
  return {};
}

void Driver::Lose() noexcept {
  state_ = DriverState::kUnconfigured;
  is_unreleased_ = true;
}

void Driver::Release() noexcept {
  if (!is_unreleased_) return;
  is_unreleased_ = false;
  DoDeactivate();
  DoCleanup();
}

void Driver::Finalize() noexcept {
  Release();
  if (state_ == DriverState::kActive) DoDeactivate();
  if (state_ == DriverState::kActive || state_ == DriverState::kInactive) DoCleanup();
  state_ = DriverState::kFinalized;
}

ReadStatus Driver::Read(std::span<HandSample> samples) noexcept {
  TROCAR_ASSERT(static_cast<int>(samples.size()) == channel_count_);
  const ReadStatus status = state_ == DriverState::kActive ? DoRead(samples) : ReadStatus::kNotActive;
  if (status == ReadStatus::kLost) {
    Lose();
    Release();
  }
  if (status == ReadStatus::kLost || status == ReadStatus::kNotActive) {
    for (HandSample& sample : samples) sample.is_valid = false;
  }
  return status;
}

}  // namespace trocar::device
