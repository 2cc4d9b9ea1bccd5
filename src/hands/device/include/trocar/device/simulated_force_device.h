// SPDX-License-Identifier: Apache-2.0
/// \file simulated_force_device.h  A haptic device that exists in memory: led along a path, with faults on demand. For
/// tests, benchmarks and demonstrations of the haptic loop without hardware.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>

#include "trocar/device/force_driver.h"

namespace trocar::device {

enum class SimulatedFault : std::uint8_t {
  kNone,
  kUnplugged,
  kSilent,
  kNotFinite,
  kJumped,
  kAlternating,  ///< jumped in every other report
  kWarm,
  kUncalibrated
};

/// One force on the wire of the simulated device.
struct SimulatedForceFrame {
  static constexpr std::size_t kBytes = 20;
  std::uint8_t channel = 0;
  float force[3] = {};  ///< [N]
};
/// "TRFC", channel, three zeros, three floats as the machine stores them.
std::array<std::uint8_t, SimulatedForceFrame::kBytes> EncodeFrame(const SimulatedForceFrame& frame) noexcept;

struct SimulatedForceSettings {
  static constexpr int kMaxChannels = 2;
  int channel_count = 1;  ///< 1 or 2
  ForceLimits limits;     ///< of every channel; a Touch by default (domain facts 3.4)
  /// Where the hand leads a channel at a time since activation [s]; device frame [m]. Called in every read.
  std::function<math::Vec3(int channel, double time)> path;
  /// Buttons that are held at that time, beside those of SetButtons(); may be empty.
  std::function<std::uint32_t(int channel, double time)> buttons;
  int wire = -1;  ///< file that every force is written to, or -1; stays the caller's
};
/// Limits of the Touch as in the domain facts, sections 0, 3.4 and 3.5.
ForceLimits MakeTouchLimits() noexcept;

class SimulatedForceDevice : public ForceDriver {
 public:
  /// \pre a path, 1 or 2 channels (TROCAR_ASSERT)
  explicit SimulatedForceDevice(SimulatedForceSettings settings);

  /// From the next read on; any thread. An unplugged device refuses to be configured.
  void SetFault(SimulatedFault fault) noexcept { fault_.store(fault); }
  /// Buttons that are held; none at first.
  void SetButtons(int channel, std::uint32_t buttons) noexcept {
    buttons_[static_cast<std::size_t>(channel)].store(buttons);
  }
  /// Size of the last force that was sent [N]; any thread.
  double GetForce(int channel) const noexcept { return force_[static_cast<std::size_t>(channel)].load(); }

  ForceLimits GetLimits(int channel) const noexcept override;
  SupervisedWire GetSupervisedWire(int channel) const noexcept override;

 private:
  base::Status DoConfigure() override;
  base::Status DoActivate() override;
  void DoDeactivate() noexcept override;
  void DoCleanup() noexcept override {}
  ReadStatus DoRead(std::span<HandSample> samples) noexcept override;
  ReadStatus DoReadForceSamples(std::span<ForceSample> samples) noexcept override;
  void DoSendForce(int channel, const GatedForce& force) noexcept override;

  SimulatedForceSettings settings_;
  std::atomic<SimulatedFault> fault_{SimulatedFault::kNone};
  std::array<std::atomic<std::uint32_t>, SimulatedForceSettings::kMaxChannels> buttons_{};
  std::array<std::atomic<double>, SimulatedForceSettings::kMaxChannels> force_{};  // [N]
  std::int64_t start_ = 0;                                                         // [ns]
  std::uint64_t sequence_ = 0;
};

}  // namespace trocar::device
