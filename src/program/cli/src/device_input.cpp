// SPDX-License-Identifier: Apache-2.0
#include "device_input.h"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include "command.h"
#include "trocar/device/device_spec.h"
#include "trocar/host/log.h"
#include "trocar/session/device_thread.h"

namespace trocar::cli {

void AddDeviceOption(CLI::App& command, std::string& spec) {
  command
      .add_option("--device", spec,
                  "Hands of a device in place of the script's; play:FILE repeats a recording bit for bit")
      ->type_name("DEVICE");
}

base::Result<std::unique_ptr<DeviceInput>> DeviceInput::Open(const std::string& spec,
                                                             const scene::Scene& scene) {
  std::unique_ptr<DeviceInput> input(new DeviceInput);
  input->clock_ = spec.starts_with("play:") ? &input->simulated_ : &device::SystemClock();
  const device::DeviceStore store = LoadStoreOrWarn();
  auto driver = device::MakeDriver(spec, store, *input->clock_);
  if (!driver) return driver.error();
  input->driver_ = std::move(*driver);
  input->buttons_ = device::HandButtons(device::FindButtons(spec, store));
  session::PlaceAtHome(scene, *input->driver_);
  if (const base::Status done = input->driver_->Configure(); !done) return done.error();
  if (const base::Status done = input->driver_->Activate(); !done) return done.error();
  input->start_ = input->clock_->Now();
  return input;
}

DeviceInput::~DeviceInput() {
  if (driver_ != nullptr) TellHeldBack();
}

/// Each reason once, though its counts go on.
void DeviceInput::TellHeldBack() {
  const std::vector<std::string> reasons = driver_->DescribeHeldBack();
  for (; told_ < reasons.size(); ++told_)
    host::Log(host::LogLevel::kWarning, driver_->GetName() + ": " + reasons[told_]);
}

void DeviceInput::Await(double time) {
  if (clock_ != &simulated_) clock_->Sleep(start_ + time - clock_->Now());
}

const session::DeviceReport& DeviceInput::Look(double time) {
  if (clock_ == &simulated_) simulated_.Set(time);
  if (time >= next_look_) {
    next_look_ = time + 1.0;
    TellHeldBack();
  }
  if (report_.losses == 0 && driver_->Read(report_.samples) == device::ReadStatus::kLost) {
    report_.losses = 1;
    TellHeldBack();
    buttons_.ReleaseAll();
    host::Log(host::LogLevel::kWarning, Check().error().Text());
  }
  if (report_.losses == 0) buttons_.See(report_.samples, time);
  report_.acts = buttons_.Acts();
  return report_;
}

base::Status DeviceInput::Check() const {
  if (report_.losses == 0) return {};
  return base::Error{base::ErrorCode::kDeviceLost,
                     driver_->GetName() + " was lost on the way; its hands stood still from there on"};
}

}  // namespace trocar::cli
