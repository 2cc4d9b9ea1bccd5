// SPDX-License-Identifier: Apache-2.0
/// \file library_guard.h  Guard by the supervisor of devices that a maker's library holds in a process of its own.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

namespace trocar::device {

/// Watches that process and its spare, as the simulator and the spare do. Ends what stands still; where both have failed, a
/// process is forked that opens the devices and sends zero.
class LibraryGuard {
 public:
  LibraryGuard();
  ~LibraryGuard();
  LibraryGuard(const LibraryGuard&) = delete;
  LibraryGuard& operator=(const LibraryGuard&) = delete;

  /// In place of what was watched before.
  ///
  /// \param request  how the devices are opened, of SupervisedLibrary
  /// \param files    of SupervisedLibrary, which stay the caller's
  void Take(std::string_view request, std::span<const int> files);
  void Forget() noexcept;
  bool IsOn() const noexcept;

  /// \param now  [ns]; look about every millisecond
  void Look(std::int64_t now) noexcept;
  /// The simulator is gone: returns when the devices have been given back, or zero has been sent to them.
  void SeeOut() noexcept;

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

}  // namespace trocar::device
