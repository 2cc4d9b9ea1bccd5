// SPDX-License-Identifier: Apache-2.0
/// \file supervisor_link.h  A second process that sends zero force when this one dies or hangs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "trocar/base/result.h"
#include "trocar/device/force_driver.h"

namespace trocar::session {

/// Our end of the supervisor. The supervisor sees our end close when we die, and our heart beat stop when we hang; then
/// it writes the zero frame of every wire, again and again, until the beat comes back. It also ends processes of a maker's library that
/// stand still, and takes their force away where nobody else does (device::LibraryGuard).
class SupervisorLink {
 public:
  /// Silence after which the supervisor acts [s], as long as a force lives that nobody renews.
  static constexpr double kLongestSilence = 0.010;

  /// trocar-supervisor beside this program, or in ../libexec/trocar.
  static std::filesystem::path FindProgram();
  /// Starts the program.
  /// \return kHapticSupervisor
  static base::Result<SupervisorLink> Start(const std::filesystem::path& program);
  SupervisorLink(SupervisorLink&&) noexcept;
  SupervisorLink& operator=(SupervisorLink&&) noexcept;
  /// The supervisor sends zero and ends.
  ~SupervisorLink();

  /// Gives the supervisor a copy of a wire.
  /// \return kHapticSupervisor
  base::Status AddWire(const device::SupervisedWire& wire);
  /// Lets the supervisor watch the processes of a maker's library; instead of those that it watched before.
  /// \return kHapticSupervisor
  base::Status AddLibrary(const device::SupervisedLibrary& library);
  /// The supervisor closes its copies, and watches no library any more: the device is gone, or comes back on another wire.
  void ForgetWires() noexcept;

  /// We live. Watching begins with the first.
  /// \note Real-time safe.
  void Beat() noexcept;
  /// The supervisor has not ended, and its own beat is no older than 20 ms; call it about as often as Beat().
  /// \param now  [ns]
  /// \note Real-time safe.
  bool IsAlive(std::int64_t now) noexcept;
  /// Whether it had to act since the last call.
  /// \note Real-time safe.
  bool TakeTrip() noexcept;

 private:
  struct Content;
  explicit SupervisorLink(std::unique_ptr<Content> content);
  std::unique_ptr<Content> content_;
};

/// The supervisor's whole life: watches over `socket` and the shared `page` until the other end closes.
/// \return exit status
int RunSupervisor(int socket, int page);

}  // namespace trocar::session
