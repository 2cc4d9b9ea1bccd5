// SPDX-License-Identifier: Apache-2.0
#include "stylus_hands.h"

#include <utility>

#include "trocar/base/assert.h"
#include "trocar/device/force_driver.h"
#include "trocar/device/mouse_keyboard.h"

namespace trocar::device {
namespace {

class StylusHands : public Driver {
 public:
  explicit StylusHands(std::unique_ptr<ForceDriver> device)
      : Driver(device->GetName(), kChannelCount), device_(std::move(device)) {
    TROCAR_ASSERT(device_->GetChannelCount() >= 1 && device_->GetChannelCount() <= 2);
  }

 private:
  base::Status DoConfigure() override { return device_->Configure(); }
  base::Status DoActivate() override { return device_->Activate(); }
  // a device that was lost has closed itself
  void DoDeactivate() noexcept override {
    if (device_->GetState() == DriverState::kActive) static_cast<void>(device_->Deactivate());
  }
  void DoCleanup() noexcept override {
    if (device_->GetState() == DriverState::kInactive) static_cast<void>(device_->Cleanup());
  }
  ReadStatus DoRead(std::span<HandSample> samples) noexcept override {
    const auto count = static_cast<std::size_t>(device_->GetChannelCount());
    // a single device is the right hand's
    const auto styluses = samples.subspan(count == 1 ? kRightHand : kLeftHand, count);
    for (HandSample& sample : samples) sample.is_valid = false;
    return device_->Read(styluses);
  }

  std::unique_ptr<ForceDriver> device_;
};

}  // namespace

std::unique_ptr<Driver> MakeStylusHands(std::unique_ptr<ForceDriver> device) {
  return std::make_unique<StylusHands>(std::move(device));
}

}  // namespace trocar::device
