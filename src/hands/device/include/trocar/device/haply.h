// SPDX-License-Identifier: Apache-2.0
/// \file haply.h  Haply Inverse3 devices, through their maker's local service: JSON over WebSocket, port 10001.
/// Source: messages as in domain facts, section 6.4.
#pragma once

#include <memory>

#include "trocar/device/force_driver.h"
#include "trocar/device/ports.h"

namespace trocar::device {

struct HaplySettings {
  int devices = 1;  ///< 1 (right hand) or 2 (left, right: in the order in which the service lists them)
  double max_force = 2.0;  ///< the service does not say what a device bears; 2 N is what others use [N], > 0
  double answer_time = 2.0;   ///< within which the first message comes [s], > 0
  double lost_after = 0.500;  ///< without a message [s], > 0
  /// Virtual trocar above the middle of the workspace, device frame [m].
  math::Vec3 p_device_trocar{0, 0.30, 0};
};

/// A thread of its own answers every message of the service with the newest force, or with zero where none has come for
/// kForceLife. The service's axes are taken as x right, y away from the person, z up.
class Haply : public ForceDriver {
 public:
  /// \param opener  a TCP line to the service, normally localhost:10001
  Haply(const HaplySettings& settings, TransportOpener opener);
  ~Haply() override;

  ForceLimits GetLimits(int channel) const noexcept override;
  SupervisedWire GetSupervisedWire(int channel) const noexcept override;

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
