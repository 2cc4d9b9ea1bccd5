// SPDX-License-Identifier: Apache-2.0
/// \file hd_devices.h  libHD in this process: devices, the one scheduler, and what its thread does a thousand times a second.
#pragma once

#include <array>
#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "hd_end.h"
#include "hd_library.h"
#include "trocar/device/force_check.h"

namespace trocar::device {

class HdDevices : public HdEnd {
 public:
  /// \param mailbox  outlives this; its other end may be in another process
  explicit HdDevices(ForceMailbox& mailbox) noexcept : mailbox_(mailbox) {}
  ~HdDevices() override { Close(); }
  HdDevices(const HdDevices&) = delete;
  HdDevices& operator=(const HdDevices&) = delete;

  base::Status Open(const OpenHapticsSettings& settings, std::vector<ForceLimits>& limits) override;
  base::Status Start() override;
  void Stop() noexcept override;
  void Close() noexcept override;
  ForceMailbox& Mailbox() noexcept override { return mailbox_; }

  // --- for the watchdog of the process; any thread

  /// The library has to call: it did so once, and nobody has stopped it.
  bool IsCalled() const noexcept { return is_called_.load(std::memory_order_acquire); }
  /// Of its calls so far; begun and ended ones both count.
  std::uint64_t CountCalls() const noexcept { return calls_.load(std::memory_order_acquire); }
  /// Zero to every device from a thread that is not the library's, where none of the library's calls is under way.
  void PushZero() noexcept;

 private:
  static hd::CallbackCode OnTick(void* self) { return static_cast<HdDevices*>(self)->Tick(); }
  hd::CallbackCode Tick() noexcept;
  void ReadDevice(std::size_t i) noexcept;
  bool TakeErrors(std::size_t i) noexcept;
  base::Result<ForceLimits> OpenDevice(const std::string& name);
  base::Error LibraryError(const std::string& what, unsigned int code) const;

  ForceMailbox& mailbox_;
  std::unique_ptr<hd::Library> libhd_;
  std::vector<hd::Handle> devices_;
  std::vector<ForceCheck> checks_;  // one a device
  hd::SchedulerHandle callback_ = 0;
  bool is_started_ = false;
  ForceMailbox::Reports newest_;  // of the library's thread
  std::array<bool, ForceMailbox::kMaxDevices> is_warm_{};
  std::atomic<bool> is_stopping_{false}, has_stopped_{false}, is_called_{false};
  std::atomic<std::uint64_t> calls_{0};  // odd while one is under way
};

}  // namespace trocar::device
