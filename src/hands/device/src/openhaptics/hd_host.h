// SPDX-License-Identifier: Apache-2.0
/// \file hd_host.h  libHD in the supervisor's program: our end of it.
#pragma once

#include <atomic>
#include <optional>
#include <string>
#include <string_view>
#include <thread>

#include "hd_end.h"
#include "host_watch.h"
#include "trocar/device/companion.h"

namespace trocar::device {

base::Error HostError(const std::string& what);
/// The calling thread goes above the haptic loop and below the supervisor, where that is permitted. Threads that are started
/// afterwards inherit it.
void GoFirst() noexcept;

/// Forces and reports go through a mailbox in shared memory, which neither side waits for; opening, starting and stopping
/// through messages. A spare that already runs watches the process: when it dies, or its beat stops, it is ended at once, and the
/// spare opens the devices and sends them zero, whoever else is still there. A thread watches both for the simulator.
class HdHost : public HdEnd {
 public:
  ~HdHost() override;
  base::Status Open(const OpenHapticsSettings& settings, std::vector<ForceLimits>& limits) override;
  base::Status Start() override;
  void Stop() noexcept override;
  void Close() noexcept override;
  bool HasFailed() const noexcept override { return has_failed_.load(std::memory_order_acquire); }
  /// \pre open
  ForceMailbox& Mailbox() noexcept override { return Page(*active_).mailbox; }
  SupervisedLibrary Supervised() const override;

 private:
  static HdHostPage& Page(const Companion& process) noexcept {
    return *static_cast<HdHostPage*>(process.Page());
  }
  static base::Result<Companion> StartProcess(const OpenHapticsSettings& settings);
  bool TakeRescued(std::vector<ForceLimits>& limits);
  void StartSpare(const OpenHapticsSettings& settings);
  void Watch() noexcept;
  void EndWatch() noexcept;

  std::string request_;  // that opens the devices
  std::optional<Companion> active_, spare_;
  std::thread watch_;
  std::atomic<bool> is_ending_{false}, has_failed_{false};
  std::optional<HostWatch> spare_watch_;  // of the thread, while it runs
  bool is_rescued_ = false;               // the spare takes over
};

}  // namespace trocar::device
