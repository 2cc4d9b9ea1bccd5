// SPDX-License-Identifier: Apache-2.0
/// \file hd_host.h  libHD in the supervisor's program: our end of it.
#pragma once

#include <atomic>
#include <optional>
#include <string>
#include <string_view>
#include <thread>

#include "hd_end.h"
#include "hd_host_page.h"
#include "trocar/device/companion.h"

namespace trocar::device {

/// Forces and reports go through a mailbox in shared memory, which neither side waits for; opening, starting and stopping
/// through messages. A thread watches the process: when it dies, or its beat stops, it is ended at once, and a spare that
/// already runs opens the devices and sends them zero.
class HdHost : public HdEnd {
 public:
  ~HdHost() override;
  core::Status Open(const OpenHapticsSettings& settings, std::vector<ForceLimits>& limits) override;
  core::Status Start() override;
  void Stop() noexcept override;
  void Close() noexcept override;
  bool HasFailed() const noexcept override { return has_failed_.load(std::memory_order_acquire); }
  /// \pre open
  ForceMailbox& Mailbox() noexcept override { return Page(*active_).mailbox; }

 private:
  static HdHostPage& Page(const Companion& process) noexcept {
    return *static_cast<HdHostPage*>(process.Page());
  }
  static core::Result<Companion> StartProcess(const OpenHapticsSettings& settings);
  bool TakeRescued(std::vector<ForceLimits>& limits);
  void Watch() noexcept;
  void EndWatch() noexcept;

  std::string request_;  // that opens the devices
  std::optional<Companion> active_, spare_;
  std::thread watch_;
  std::atomic<bool> is_ending_{false}, has_failed_{false};
  bool is_rescued_ = false;  // the spare has been told to take over
};

}  // namespace trocar::device
