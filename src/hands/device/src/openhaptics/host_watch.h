// SPDX-License-Identifier: Apache-2.0
/// \file host_watch.h  A process of a maker's library as another process sees it, and ends it.
#pragma once

#include <cstdint>

#include "hd_host_page.h"
#include "trocar/host/beat_watch.h"

namespace trocar::device {

/// Every process that could take its place, or its force away, watches it with one of its own. A process has failed when it is
/// gone without having given its devices back, or when its beat stands; then it is killed, which works on a stopped one, too.
class HostWatch {
 public:
  enum class State { kRunning, kClosed, kFailed };

  /// \param page     its HdHostPage
  /// \param process  its pidfd; both are copied
  HostWatch(int page, int process) noexcept;
  HostWatch(HostWatch&& other) noexcept;
  HostWatch& operator=(HostWatch&& other) noexcept;
  ~HostWatch();

  /// \param now  [ns]; look about every millisecond
  /// \note Real-time safe.
  State Look(std::int64_t now) noexcept;
  /// Since its beat moved, as of the last look [ns].
  std::int64_t Silence() const noexcept { return silence_; }
  /// Ends it at once.
  void Kill() noexcept;
  /// Until the system has taken back what it had open, but no longer than so. \return whether it has
  bool WaitForEnd(int milliseconds) const noexcept;
  /// Readable when the process has ended.
  int Process() const noexcept { return process_; }

 private:
  const HdHostPage* page_ = nullptr;
  int process_ = -1;
  host::BeatWatch watch_{kLongestBeatLook};
  std::int64_t silence_ = 0;
  bool has_looked_ = false;
  State state_ = State::kRunning;
};

}  // namespace trocar::device
