// SPDX-License-Identifier: Apache-2.0
/// \file force_mailbox.h  Mailbox between the haptic loop and a driver's own thread: newest wins, nobody waits.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>

#include "hands/stylus_hand.h"
#include "trocar/device/force_driver.h"
#include "trocar/host/clock.h"
#include "trocar/host/newest_slot.h"

namespace trocar::device {

class ForceMailbox {
 public:
  static constexpr std::size_t kMaxDevices = 2;
  using Reports = std::array<ForceSample, kMaxDevices>;
  using Forces = std::array<math::Vec3, kMaxDevices>;

  // --- the haptic loop

  ReadStatus Read(std::span<ForceSample> samples) noexcept {
    if (IsLost()) return ReadStatus::kLost;
    const bool is_fresh = reports_.Update();
    std::copy_n(reports_.Front().begin(), samples.size(), samples.begin());
    return is_fresh ? ReadStatus::kFresh : ReadStatus::kUnchanged;
  }
  /// Reads the reports as hands in a virtual trocar, device frame [m].
  ReadStatus Read(std::span<HandSample> samples, const math::Vec3& p_device_trocar) noexcept {
    if (IsLost()) return ReadStatus::kLost;
    const bool is_fresh = reports_.Update();
    for (std::size_t i = 0; i < samples.size(); ++i)
      SetHand(reports_.Front()[i], p_device_trocar, samples[i]);
    return is_fresh ? ReadStatus::kFresh : ReadStatus::kUnchanged;
  }
  void Send(int channel, const GatedForce& force) noexcept {
    const auto index = static_cast<std::size_t>(channel);
    if (index >= kMaxDevices) return;  // a negative channel, too
    command_[index] = {force.Get(), host::NowNanoseconds()};
    commands_.Back() = command_;
    commands_.Publish();
  }

  // --- the driver's thread

  /// The newest force of each device; zero for one that has not been renewed for kForceLife.
  Forces TakeForces() noexcept {
    commands_.Update();
    const std::int64_t now = host::NowNanoseconds();
    Forces forces;
    for (std::size_t i = 0; i < kMaxDevices; ++i) {
      const Command& command = commands_.Front()[i];
      const double age = 1e-9 * static_cast<double>(now - command.time);
      // one from the future would never end
      if (age >= 0.0 && age <= ForceDriver::kForceLife) forces[i] = command.force;
    }
    return forces;
  }
  void Report(const Reports& newest) noexcept {
    reports_.Back() = newest;
    reports_.Publish();
  }
  void SetLost() noexcept { is_lost_.store(true, std::memory_order_release); }

  // --- either

  bool IsLost() const noexcept { return is_lost_.load(std::memory_order_acquire); }
  /// No force, nothing lost, nothing reported yet: silence, which is no loss. Before the driver's thread starts.
  void Clear() noexcept {
    ForceSample silent;
    silent.status = ForceDeviceStatus::kOk;
    reports_.Back().fill(silent);
    reports_.Publish();
    static_cast<void>(reports_.Update());
    command_ = {};
    commands_.Back() = {};
    commands_.Publish();
    is_lost_.store(false, std::memory_order_release);
  }

 private:
  struct Command {
    math::Vec3 force;       // [N]
    std::int64_t time = 0;  // of SendForce [ns]
  };
  using Commands = std::array<Command, kMaxDevices>;

  host::NewestSlot<Reports> reports_;
  host::NewestSlot<Commands> commands_;
  Commands command_;  // of the haptic loop
  std::atomic<bool> is_lost_{false};
};

}  // namespace trocar::device
