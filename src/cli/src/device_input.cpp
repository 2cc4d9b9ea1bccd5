// SPDX-License-Identifier: Apache-2.0
#include "device_input.h"

#include "command.h"
#include "trocar/core/log.h"
#include "trocar/device/device_spec.h"

namespace trocar::cli {

core::Result<std::unique_ptr<DeviceInput>> DeviceInput::Open(const std::string& spec,
                                                             const session::Scene& scene) {
  std::unique_ptr<DeviceInput> input(new DeviceInput);
  input->clock_ = spec.starts_with("play:") ? &input->simulated_ : &device::SystemClock();
  auto driver = device::MakeDriver(spec, LoadStoreOrWarn(), *input->clock_);
  if (!driver) return driver.error();
  input->driver_ = std::move(*driver);
  session::PlaceAtHome(scene, *input->driver_);
  if (const core::Status done = input->driver_->Configure(); !done) return done.error();
  if (const core::Status done = input->driver_->Activate(); !done) return done.error();
  input->start_ = input->clock_->Now();
  return input;
}

void DeviceInput::Apply(double time, session::Input& input) {
  if (clock_ == &simulated_) {
    simulated_.Set(time);
  } else {
    clock_->Sleep(start_ + time - clock_->Now());
  }
  if (!is_lost_ && driver_->Read(samples_) == device::ReadStatus::kLost) {
    is_lost_ = true;
    core::Log(core::LogLevel::kWarning, Check().error().Text());
  }
  if (has_held_) {
    input.hands = held_.hands;
    input.laparoscope = held_.laparoscope;
  }
  session::ApplyHands(samples_, input);
  held_ = input;
  has_held_ = true;
}

core::Status DeviceInput::Check() const {
  if (!is_lost_) return {};
  return core::Error{core::ErrorCode::kDeviceLost,
                     driver_->GetName() + " was lost on the way; its hands stood still from there on"};
}

}  // namespace trocar::cli
