// SPDX-License-Identifier: Apache-2.0
/// \file hand_rig.h  One device out of two: where the instruments are, and how far their jaws are open.
#pragma once

#include <array>
#include <memory>

#include "trocar/device/driver.h"
#include "trocar/device/mouse_keyboard.h"

namespace trocar::device {

/// Hands from one driver, jaws from another. Where the jaw sensor sees a tool no more, its jaws stay as they were; where
/// either part is lost, the whole is.
class HandRig : public Driver {
 public:
  /// \pre both have kChannelCount channels and are unconfigured (TROCAR_ASSERT)
  HandRig(std::unique_ptr<Driver> hands, std::unique_ptr<Driver> jaws);

  void PlaceHand(int channel, const HandSample& home) noexcept override { hands_->PlaceHand(channel, home); }
  std::vector<std::string> DescribeHeldBack() const override;
  std::string DescribeReceived() const override { return hands_->DescribeReceived(); }
  Driver& Hands() noexcept { return *hands_; }
  Driver& Jaws() noexcept { return *jaws_; }

 private:
  base::Status DoConfigure() override;
  base::Status DoActivate() override;
  void DoDeactivate() noexcept override;
  void DoCleanup() noexcept override;
  ReadStatus DoRead(std::span<HandSample> samples) noexcept override;

  std::unique_ptr<Driver> hands_, jaws_;
  std::array<HandSample, kChannelCount> jaw_samples_;
  std::array<double, kChannelCount> jaw_{};  // last seen [rad]
};

}  // namespace trocar::device
