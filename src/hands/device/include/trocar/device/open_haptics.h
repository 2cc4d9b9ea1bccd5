// SPDX-License-Identifier: Apache-2.0
/// \file open_haptics.h  Touch, Omni and Phantom devices through the maker's OpenHaptics library, loaded when it is asked
/// for.
/// Source: OpenHaptics HD API, version 3; errors that pass and errors that do not: domain facts, section 6.3.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "trocar/device/force_driver.h"

namespace trocar::device {

struct OpenHapticsSettings {
  std::string hd_file = "libHD.so";  ///< proprietary; never linked
  /// Program trocar-supervisor, in whose process the library then lives: a crash or a hang of this one leaves the library's
  /// thread alive, which sends zero. Empty: the library is loaded into this process.
  std::filesystem::path host;
  /// Names that the maker's set-up program gave to the devices: left hand, right hand. One for a single device.
  std::vector<std::string> names{"Default Device"};
  /// Virtual trocar above the middle of the workspace, device frame [m].
  math::Vec3 p_device_trocar{0, 0.12, 0};
};

/// The host's whole life: opens what it is told to, and sends zero when the other end falls silent or closes; or watches another
/// host, and takes its place when it fails.
/// \return exit status
int RunOpenHapticsHost(int socket, int page);

/// One or two devices, one scheduler. The library's own 1 kHz thread reads and sends; a force that has not been renewed for
/// kForceLife becomes zero there, and a library that reports nothing for half a second is a lost device. There can be one at a time in a program, as the library has one scheduler.
class OpenHaptics : public ForceDriver {
 public:
  explicit OpenHaptics(const OpenHapticsSettings& settings);
  ~OpenHaptics() override;

  ForceLimits GetLimits(int channel) const noexcept override;
  SupervisedLibrary GetSupervisedLibrary() const override;

 private:
  base::Status DoConfigure() override;
  base::Status DoActivate() override;
  void DoDeactivate() noexcept override;
  void DoCleanup() noexcept override;
  ReadStatus DoRead(std::span<HandSample> samples) noexcept override;
  ReadStatus DoReadForceSamples(std::span<ForceSample> samples) noexcept override;
  void DoSendForce(int channel, const GatedForce& force) noexcept override;

  struct Content;
  std::unique_ptr<Content> content_;
};

}  // namespace trocar::device
