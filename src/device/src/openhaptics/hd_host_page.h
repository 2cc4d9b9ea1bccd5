// SPDX-License-Identifier: Apache-2.0
/// \file hd_host_page.h  What the simulator and the process of the maker's library share, and how soon each calls the
/// other, or the library, dead.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>

#include "hands/force_mailbox.h"

namespace trocar::device {

/// In shared memory.
struct HdHostPage {
  ForceMailbox mailbox;
  /// Of the library's process, every millisecond while the library calls us in time.
  std::atomic<std::uint64_t> beats{0};
};

/// Between two looks at a beat [ns].
inline constexpr std::int64_t kBeatLook = 1'000'000;
/// Without a call of the library for so long its process ends itself, and the system closes the device [ns].
inline constexpr std::int64_t kLongestCallSilence = 12'000'000;
/// Without a beat for so long the process is ended from outside [ns]: it stands still as a whole.
inline constexpr std::int64_t kLongestBeatSilence = 15'000'000;

#ifdef TROCAR_WITHOUT_HOST_WATCH
inline constexpr bool kIsHostWatched = false;  // the negative control
#else
inline constexpr bool kIsHostWatched = true;
#endif

/// How long a counter has stood still, as seen by somebody who looks every kBeatLook. Time in which the machine did not let
/// the watcher itself run does not count: then nobody ran.
class BeatWatch {
 public:
  /// \return [ns] for which `count` has not changed
  std::int64_t Look(std::uint64_t count, std::int64_t now) noexcept {
    silence_ = count != last_count_ ? 0 : silence_ + std::min(now - last_look_, 2 * kBeatLook);
    last_count_ = count;
    last_look_ = now;
    return silence_;
  }
  void Forget(std::int64_t now) noexcept {
    silence_ = 0;
    last_look_ = now;
  }

 private:
  std::uint64_t last_count_ = 0;
  std::int64_t last_look_ = 0, silence_ = 0;
};

}  // namespace trocar::device
